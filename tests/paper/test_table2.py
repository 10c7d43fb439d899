"""The published table and our measurement of it."""

from typing import NamedTuple

import pytest

from isopeel import InputError, row_space
from isopeel.paper.study import MESHES, SPACES, Run, measure_all
from isopeel.paper.table2 import contact_row_only, published, show_table2


class Figures(NamedTuple):
    """dM, steepest rise and steepest fall, times 1e3."""

    amplitude: float
    rise: float
    fall: float


#: Measured before by two independent codes at m2, with another treatment of the drift, as noted down.
ALL_ROWS = {
    "L1": Figures(5.64, 8.16, -55.5),
    "N2": Figures(4.46, 7.3, -36.0),
    "N4": Figures(2.74, 5.3, -14.9),
    "N6": Figures(1.96, 4.2, -8.8),
    "N8": Figures(1.52, 3.5, -6.1),
    "L2": Figures(0.85, 2.2, -2.6),
}
CONTACT_ROW = {
    "N2": Figures(4.78, 7.1, -33.0),
    "N4": Figures(2.96, 5.14, -13.0),
    "N6": Figures(2.04, 4.02, -7.7),
    "N8": Figures(1.58, 3.31, -5.4),
    "L2": Figures(1.74, 3.65, -5.9),
    "L4": Figures(0.617, 1.53, -1.80),
    "N2.1": Figures(0.355, 0.85, -1.05),
    "N4.1": Figures(0.445, 1.09, -1.30),
}


def figures(run: Run) -> Figures:
    plateau = run.measure().plateau
    assert plateau is not None
    return Figures(1e3 * plateau.amplitude, 1e3 * plateau.steepest_rise, 1e3 * plateau.steepest_fall)


def test_all_rows_of_the_table_are_there() -> None:
    for mesh in MESHES:
        rows = published(mesh)
        assert set(SPACES) <= set(rows)
        missing = [name for name in SPACES if rows[name].amplitude is None]
        assert missing == (["L1", "N2"] if mesh == "m1" else [])
    assert published("m2")["N4.1"].fall == -0.3519


@pytest.mark.parametrize(
    ("mesh", "space", "dofs"),
    [("m1", "L1", 2898), ("m1", "N2", 2916), ("m2", "L2", 8822), ("m3", "N8", 6448), ("m3", "N4.1", 12584)],
)
def test_degrees_of_freedom(mesh: str, space: str, dofs: int) -> None:
    assert 2 * row_space(space, MESHES[mesh]).size == dofs


def test_contact_row_only() -> None:
    assert contact_row_only("L1") is None
    assert contact_row_only("N2.1") == "L1+N2.1"


def test_an_unknown_mesh_is_refused() -> None:
    from rich.console import Console

    with pytest.raises(InputError, match="m1, m2, m3"):
        show_table2("m4", Console())


@pytest.mark.parametrize(("run", "known"), [("L1", ALL_ROWS["L1"]), ("L1+L4", CONTACT_ROW["L4"])])
def test_a_cheap_entry(run: str, known: Figures) -> None:
    ours = figures(Run(run, "m2"))
    # to the digits noted down, and the drift of 0.02e-3 per degree that was or was not taken out
    assert ours.rise == pytest.approx(known.rise, rel=0.02)
    assert ours.fall == pytest.approx(known.fall, rel=0.03)
    assert ours.amplitude == pytest.approx(known.amplitude, rel=0.08)  # see below


@pytest.mark.long
def test_the_whole_table_at_m2() -> None:
    """Held against the figures that two other codes gave.

    Their window is ours, their treatment of the drift is not known; it moves small amplitudes most. We
    find amplitudes within 2 % with all rows, 7 to 12 % lower with the contact row alone; slopes within
    2.5 %, but the steepest falls of smooth spaces with all rows up to 5 % flatter.
    """
    runs = [Run(name, "m2") for name in ALL_ROWS] + [Run(f"L1+{name}", "m2") for name in CONTACT_ROW]
    measured = {m.run.space: m.plateau for m in measure_all(runs, workers=2)}
    for name, known in ALL_ROWS.items():
        ours = measured[name]
        assert ours is not None
        assert 1e3 * ours.amplitude == pytest.approx(known.amplitude, rel=0.02)
        assert 1e3 * ours.steepest_rise == pytest.approx(known.rise, rel=0.02)
        assert 1e3 * ours.steepest_fall == pytest.approx(known.fall, rel=0.05)
    for name, known in CONTACT_ROW.items():
        ours = measured[f"L1+{name}"]
        assert ours is not None
        assert 0.87 < 1e3 * ours.amplitude / known.amplitude < 0.94
        assert 1e3 * ours.steepest_rise == pytest.approx(known.rise, rel=0.025)
        assert 1e3 * ours.steepest_fall == pytest.approx(known.fall, rel=0.02)
