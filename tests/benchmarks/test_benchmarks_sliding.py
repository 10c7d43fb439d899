"""The benchmark of a cylinder that slides or rolls: its drive, and how little the force oscillates."""

from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from typer.testing import CliRunner

from isopeel.common.arrays import FloatArray

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def sliding(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("sliding")


def test_a_hub_rolls_without_slip(sliding: ModuleType) -> None:
    """As a rolling circle: the lowest point of the rim rests, and the centre moves along."""
    drive = sliding.Rolled("top", (0.3, 1.0))
    points = np.array([[0.3, 1.0], [0.3, 0.0], [0.3, 2.0]])
    rate: FloatArray = drive.rate(points, 0.0)
    np.testing.assert_allclose(rate, [[1.0, 0.0], [0.0, 0.0], [2.0, 0.0]], atol=1e-15)
    step = 1e-6
    slope = (drive.prescribed(points, 0.7 + step) - drive.prescribed(points, 0.7 - step)) / (2 * step)
    # central differences of sines
    np.testing.assert_allclose(drive.rate(points, 0.7), slope, atol=1e-9)
    moved = points + drive.prescribed(points, 0.7)
    np.testing.assert_allclose(np.linalg.norm(np.diff(moved, axis=0), axis=1), [1.0, 2.0], rtol=1e-14)


@pytest.mark.parametrize(("rolls", "allowed"), [(False, 1e-3), (True, 2e-3)])
def test_the_force_hardly_changes_from_step_to_step(sliding: ModuleType, rolls: bool, allowed: float) -> None:
    """On 10 elements, half as many as in the table; measured 5e-4 and 9e-4."""
    found = sliding.run(sliding.Setting(rolls, "N2", elements=10, widths=0.25))
    assert found.change < allowed
    assert found.resistance < 2e-3
    # a share of an element more or less
    assert found.width == pytest.approx(sliding.WIDTH, rel=0.15)


def test_the_command_prints_a_row_for_each_path(sliding: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    place = np.linspace(0.0, 1.0, 50)
    waves = 2.0 + 0.002 * np.sin(60 * place) + 0.1 * place**3

    def found(setting: object, _step: float) -> object:
        return sliding.Found(setting, place, waves, 0.001 * waves, 0.1, 60, 1.0)

    monkeypatch.setattr(sliding, "run", found)
    import typer

    app = typer.Typer()
    app.command()(sliding.main)
    printed = CliRunner().invoke(app, [])
    assert printed.exit_code == 0
    rows = [line for line in printed.output.splitlines() if line.strip().startswith(("slides", "rolls"))]
    assert len(rows) == 10
    # the wave less its trend, over the mean force of 2.025
    assert found(None, 0.37).oscillation == pytest.approx(0.002 / 2.025, rel=0.1)  # type: ignore[attr-defined]


@pytest.mark.long
@pytest.mark.parametrize("rolls", [False, True])
def test_the_force_oscillates_by_less_than_a_thousandth(sliding: ModuleType, rolls: bool) -> None:
    """On 20 elements, along two widths; of linear elements the smoothed side is the better one."""
    smooth, plain, smoothed = (
        sliding.run(sliding.Setting(rolls, space, smoothed, widths=2.0))
        for space, smoothed in (("N2", False), ("L1", False), ("L1", True))
    )
    assert smooth.oscillation < 1e-3
    assert smoothed.oscillation < plain.oscillation
