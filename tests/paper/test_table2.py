"""The published table and our measurement of it."""

from io import StringIO

import pytest
from rich.console import Console

from isopeel import InputError, row_space
from isopeel.paper.study import MESHES, SPACES, Measurement, Run, measure_all
from isopeel.paper.table2 import Figures, Reading, contact_row_only, published, show_table2
from isopeel.post.reading import PlateauReading

# Figures noted down before, by two other codes at m2 in the same window. Theirs with all rows fit our reading
# with the drift of the mean taken out, those with the contact row alone the one by a line.
ALL_ROWS = {
    "L1": Figures(5.64, 8.16, -55.5),
    "N2": Figures(4.46, 7.3, -36.0),
    "N4": Figures(2.74, 5.3, -14.9),
    "N6": Figures(1.96, 4.2, -8.8),
    "N8": Figures(1.52, 3.5, -6.1),
    "L2": Figures(0.85, 2.2, -2.6),
}
SMALL = {"L4": 0.002, "N2.1": 0.08, "N4.1": 0.01}  # dM alone: one digit
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
ROUNDING = 0.02


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
    with pytest.raises(InputError, match="m1, m2, m3"):
        show_table2("m4", Console())


def test_both_readings_and_the_notes_are_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    """With made-up runs: a drift of 0.02e-3 per degree tells the readings apart, and one run ended early."""
    plateau = PlateauReading((98.0, 101.4), 1.63, 2e-5, "running mean", 1e-3, 3e-3, -5e-3)

    def made_up(runs: list[Run], workers: int) -> list[Measurement]:
        return [
            Measurement(run, 100, 69.0, "no equilibrium", None, None, 2.0, 1.0)
            if run.space == "L1"
            else Measurement(run, 100, 102.0, None, plateau, plateau, 2.0, 1.0)
            for run in runs
        ]

    monkeypatch.setattr("isopeel.paper.table2.measure_all", made_up)
    console = Console(width=140, record=True, file=StringIO())
    show_table2("m2", console)
    printed = console.export_text()
    assert printed.count("1.000 / 3.000 / -5.000") == 17 - 1
    assert printed.count("1.000 / 3.020 / -4.980") == 17 - 1
    assert printed.count("ended at 69 deg") == 2
    assert "L1 ended after 69 degrees: no equilibrium" in printed
    assert "published L2: printed DOFs is a misprint" in printed


def figures(measurement: Measurement, reading: Reading) -> Figures:
    found = reading.figures(measurement)
    assert found is not None
    return found


def test_a_cheap_entry_of_each_column() -> None:
    ours, known = figures(Run("L1", "m2").measure(), Reading.MEAN), ALL_ROWS["L1"]
    assert ours[:2] == pytest.approx(known[:2], rel=ROUNDING)
    assert ours.fall == pytest.approx(known.fall, rel=0.025)  # not explained, see below
    ours, known = figures(Run("L1+L4", "m2").measure(), Reading.LINE), CONTACT_ROW["L4"]
    assert ours == pytest.approx(known, rel=ROUNDING)


@pytest.mark.long
def test_the_whole_table_at_m2() -> None:
    """All figures that were noted down, each read as its column was.

    What remains unexplained has its own tolerance: with all rows the steepest falls, up to 5 % flatter than
    noted, and the smallest amplitude; with the contact row alone three amplitudes, 6 to 7 % lower.
    """
    names = [*ALL_ROWS, *SMALL, *(f"L1+{name}" for name in CONTACT_ROW)]
    measured = {m.run.space: m for m in measure_all([Run(name, "m2") for name in names], workers=2)}
    for name, known in ALL_ROWS.items():
        ours = figures(measured[name], Reading.MEAN)
        assert ours.amplitude == pytest.approx(known.amplitude, rel=ROUNDING)
        assert ours.rise == pytest.approx(known.rise, rel=ROUNDING)
        assert ours.fall == pytest.approx(known.fall, rel=0.05)
    for name, amplitude in SMALL.items():
        # half a unit of the digit that was noted; for L4 the curvature of the drift is as large as that
        rounding = 0.003 if name == "L4" else 0.005
        assert figures(measured[name], Reading.MEAN).amplitude == pytest.approx(amplitude, abs=rounding)
    for name, known in CONTACT_ROW.items():
        ours = figures(measured[f"L1+{name}"], Reading.LINE)
        tolerance = 0.07 if name in ("N4", "N6", "N8") else ROUNDING
        assert ours.amplitude == pytest.approx(known.amplitude, rel=tolerance)
        assert ours[1:] == pytest.approx(known[1:], rel=ROUNDING)
