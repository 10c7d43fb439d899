"""The command `isopeel fit`, with short runs."""

import re
from pathlib import Path

import numpy as np
import pytest

import isopeel
from isopeel.case import load_case
from isopeel.cli import main
from isopeel.running.in_memory import traced_stages

SETTINGS = {"discretization.mesh": "40x1", "drive.to": "2 nm", "drive.step": "0.5 nm", "reading": None}
CASE = load_case("tape-angle").with_values(SETTINGS)
#: Before the tape peels, the force is nearly proportional to the product of these.
TRUE = {"material.youngs_modulus": 2.3, "body.height": 3.8}  # GPa, nm


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A curve computed with other values and noise, as a laboratory writes it."""
    case = CASE.with_values({"material.youngs_modulus": "2.3 GPa", "body.height": "3.8 nm"})
    ((one, run),) = traced_stages(case)
    curve = one.laboratory.curve(run.curve)
    x = np.linspace(0.1, 2.0, 30)
    y = np.interp(x, curve.parameter, curve.reaction)
    y += 1e-3 * y.max() * np.random.default_rng(1).standard_normal(30)
    folder = tmp_path_factory.mktemp("measured")
    lines = [f"{a * 1e-3},{b}" for a, b in zip(x, y, strict=True)]
    (folder / "curve.csv").write_text("\n".join(["displacement [um],force [N/m]", *lines]))
    (folder / "case.toml").write_text(CASE.text)
    return folder / "curve.csv"


@pytest.mark.usefixtures("in_own_folder")
def test_a_fit_writes_values_figures_a_case_and_a_report(
    measured: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--parameter", "material.youngs_modulus=2 GPa:1 GPa:4 GPa", "--noise", "0.1 %"]
    command = ["fit", str(measured.with_name("case.toml")), str(measured), *words, "--out", "out"]
    assert main([*command, "--set", "body.height=3.8 nm"]) == 0
    printed = capsys.readouterr().out
    found = re.search(r"material.youngs_modulus = ([\d.]+) ± ([\d.]+) GPa", printed)
    assert found is not None
    # three standard errors: a noise of one seed
    assert float(found[1]) == pytest.approx(2.3, abs=3 * float(found[2]))
    assert Path("out/report.html").exists()
    assert Path("out/figures/curve-1.png").exists()
    assert Path("out/tables/curve-1.csv").read_text().startswith("displacement [um],force [N/m],fitted force")
    fitted = load_case("out/tables/fitted.toml")
    assert float(fitted.value("material.youngs_modulus").split()[0]) == pytest.approx(
        float(found[1]), rel=1e-5
    )
    assert fitted.value("body.height") == "3.8 nm"
    # the same command computes nothing again, and finds the same
    assert main([*command, "--set", "body.height=3.8 nm"]) == 0
    again = capsys.readouterr().out
    assert "replaces the report in out" in again
    assert found[0] in again
    assert "0 runs were computed" in Path("out/report.md").read_text()


def test_in_python_what_is_badly_separated_is_said(measured: Path) -> None:
    start = {"material.youngs_modulus": ("1.6 GPa", None, "9 GPa"), "body.height": "4.4 nm"}
    found = isopeel.fit(CASE, measured, start)  # type: ignore[arg-type]
    for one in found.parameters:
        assert one.value == pytest.approx(TRUE[one.key], abs=3 * one.standard_error)
        assert one.alone < 0.01 * one.standard_error
    assert found.correlation[0, 1] < -0.999
    assert "badly" in found.notes[0] or "combination" in found.notes[0]
    # the noise is estimated: with 28 degrees of freedom, to 13 % and three times that
    (curve,) = found.curves
    assert curve.deviations[0] / curve.data.measured.y.max() == pytest.approx(1e-3, rel=0.4)
    pandas = pytest.importorskip("pandas")
    table = found.to_dataframe()
    assert isinstance(table, pandas.DataFrame)
    assert table.loc["body.height", "unit"] == "nm"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "--parameter: at least one is needed; it is KEY=START"),
        (["--parameter", "body.height"], "--parameter: 'body.height' cannot be used; it is KEY=START"),
        (["--parameter", "body.height=4 nm:3 nm"], "--parameter: 'body.height=4 nm:3 nm' cannot be used"),
        (
            ["--parameter", "body.height=4 nm:5 nm:6 nm"],
            "parameter.1.start: '4 nm' cannot be used; it must lie",
        ),
        (["--parameter", "body.hight=4 nm"], "parameter.1, body.hight: "),
        (["--parameter", "body.height=4 nm", "--set", "drive.to=1 nm"], "curve.csv, displacement [um]: "),
        (["--parameter", "body.height=4 nm", "--noise", "much"], "measured.1.noise: 'much' cannot be used"),
    ],
)
@pytest.mark.usefixtures("in_own_folder")
def test_bad_input_is_one_line(
    measured: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert main(["fit", str(measured.with_name("case.toml")), str(measured), *words]) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
    assert not Path("out").exists()


def test_options_are_not_for_the_file_of_a_fit(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fit", "fit.toml", "--noise", "1 %"]) == 2
    assert capsys.readouterr().err.startswith("isopeel: --noise: options are for CASE and MEASURED")
    assert main(["fit", "none.toml"]) == 2
    assert capsys.readouterr().err.startswith("isopeel: FIT: 'none.toml' cannot be used; it does not exist")
