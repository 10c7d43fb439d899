"""The report as a whole, and the stored one: its numbers are those of its runs, and of a run made now."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from isopeel.common.errors import InputError
from isopeel.paper.execution import Store, execute
from isopeel.paper.monitor import Monitor
from isopeel.paper.published import Figures
from isopeel.paper.reading import Reading, Rows, Window
from isopeel.paper.record import Record, read_records
from isopeel.paper.report import PARTS, chosen_meshes, chosen_parts, make_document, needed_runs
from isopeel.paper.results import Results
from isopeel.paper.study import MESHES, SPACES, Run
from isopeel.paper.wording import deviations
from isopeel.report.document import to_markdown

STORED = Path(__file__).parents[2] / "docs" / "paper"
WINDOW: Window = (98.0, 101.4)

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


@pytest.fixture(scope="module")
def stored() -> Results:
    return Results(read_records(STORED / "records.h5"), Store(Path("there are no fields")))


def figures(results: Results, run: Run, reading: Reading) -> Figures:
    found = results.figures(run, WINDOW, reading)
    assert found is not None
    return found


NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")


def test_the_stored_report_is_what_its_runs_give(stored: Results) -> None:
    """Word for word, and number for number: a change of any reading, table or text shows."""
    made = to_markdown(make_document(stored, list(PARTS), list(MESHES)))
    known = (STORED / "report.md").read_text("utf-8")
    assert blank(made) == blank(known)
    # another processor may round the last of four digits otherwise
    ours, theirs = ([float(found) for found in NUMBER.findall(text)] for text in (made, known))
    np.testing.assert_allclose(ours, theirs, rtol=2e-3, atol=1e-12)


def blank(text: str) -> str:
    """A text without its numbers, and without the width of its tables' columns."""
    return re.sub(r"(-| )+", " ", NUMBER.sub("#", text))


def test_all_runs_of_the_report_are_stored(stored: Results) -> None:
    needed = set(needed_runs(list(PARTS), list(MESHES)))
    missing = needed - set(stored.records)
    # a variant has nothing to start from where its base ended before
    assert all(run.base is not None and stored.records[run.base].failed_at_deg for run in missing)
    assert set(stored.records) <= needed


def test_the_rows_that_fail_in_print_fail_here(stored: Results) -> None:
    """Plain Newton finds no equilibrium of L1 and N2 on m1 beyond the first drop of the moment."""
    ended = {space for space in SPACES if stored.figures(Run(space, "m1")) is None}
    assert ended == {"L1", "N2"}
    plain = [stored.records[Run(space, "m1", plain=True)].failed_at_deg for space in ("L1", "N2")]
    assert plain == [69.0, 74.2]


def test_figures_equal_stored_ones(stored: Results) -> None:
    """All of them, each read as its column was.

    What remains unexplained has its own tolerance: with all rows the steepest falls, up to 5 % flatter than
    noted, and the smallest amplitude; with the contact row alone three amplitudes, 6 to 7 % lower.
    """
    for name, known in ALL_ROWS.items():
        ours = figures(stored, Run(name, "m2"), Reading.MEAN)
        assert ours.amplitude == pytest.approx(known.amplitude, rel=ROUNDING)
        assert ours.rise == pytest.approx(known.rise, rel=ROUNDING)
        assert ours.fall == pytest.approx(known.fall, rel=0.05)
    for name, amplitude in SMALL.items():
        # half a unit of the digit that was noted; for L4 the curvature of the drift is as large as that
        rounding = 0.003 if name == "L4" else 0.005
        ours = figures(stored, Run(name, "m2"), Reading.MEAN)
        assert ours.amplitude == pytest.approx(amplitude, abs=rounding)
    for name, known in CONTACT_ROW.items():
        ours = figures(stored, Run(Rows.CONTACT.enriched(name), "m2"), Reading.LINE)
        tolerance = 0.07 if name in ("N4", "N6", "N8") else ROUNDING
        assert ours.amplitude == pytest.approx(known.amplitude, rel=tolerance)
        assert ours[1:] == pytest.approx(known[1:], rel=ROUNDING)


def compare(runs: list[Run], stored: Results, folder: Path) -> None:
    """Compute runs from the start, and compare every moment of theirs with the stored ones."""
    store = Store(folder)
    with Monitor(Console(quiet=True), runs) as monitor:
        execute(runs, store, os.cpu_count() or 1, monitor)
    for run in runs:
        ours, theirs = Record.of(run, store.read(run)), stored.records[run]
        steps = len(theirs.moments)
        if run.plain or theirs.failed_at_deg is None:
            assert ours.failed_at_deg == theirs.failed_at_deg
        else:
            # beyond a limit point the last digits decide whether another equilibrium is found; they depend
            # on the processor: N2 on m2 ends at 142.8 degrees on one, and passes there on another
            steps = min(len(ours.moments), steps)
            assert steps > 0.9 * len(theirs.moments)
        # what Newton's tolerance leaves of moments near a limit point, where the tangent is almost singular
        np.testing.assert_allclose(ours.moments[:steps], theirs.moments[:steps], rtol=0, atol=1e-7)
        np.testing.assert_array_equal(ours.angles_deg[:steps], theirs.angles_deg[:steps])
        assert ours.dofs == theirs.dofs
        again = Results({run: ours}, store).figures(run)
        known = stored.figures(run)
        assert (again is None) == (known is None)
        if again is not None and known is not None:
            # thousandths, and thousandths per degree over a tenth of it: moments differ by some 1e-9, and by
            # 5e-8 where those of N4 fall most steeply
            assert again == pytest.approx(known, rel=1e-4, abs=1e-5)


def test_cheap_runs_give_the_stored_numbers(stored: Results, tmp_path: Path) -> None:
    """The two rows that fail, one of them by plain Newton too, and one that is read."""
    runs = [Run("L1", "m1"), Run("L1", "m1", plain=True), Run("N2", "m1"), Run("L1+L2", "m1")]
    compare(runs, stored, tmp_path)


@pytest.mark.long
def test_table_2_on_m2_gives_the_stored_numbers(stored: Results, tmp_path: Path) -> None:
    compare(needed_runs(["table2"], ["m2"]), stored, tmp_path)


def test_parts_and_meshes_are_taken_in_the_order_of_the_report() -> None:
    assert chosen_parts([]) == list(PARTS)
    assert chosen_parts(["reading", "table2"]) == ["table2", "reading"]
    assert chosen_meshes(["m3", "m1"]) == ["m1", "m3"]
    for wrong in (chosen_parts, chosen_meshes):
        with pytest.raises(InputError, match="m4"):
            wrong(["m4"])


@pytest.mark.parametrize("mesh", list(MESHES))
def test_every_part_can_be_made_of_one_mesh_alone(mesh: str, stored: Results) -> None:
    for part in PARTS:
        needed = {run: stored.records[run] for run in needed_runs([part], [mesh]) if run in stored.records}
        text = to_markdown(make_document(Results(needed, stored.store), [part], [mesh]))
        assert f"isopeel paper --only {part} --mesh {mesh}" in text


def test_figures_are_worded() -> None:
    assert deviations(Figures(1.1, 2.0, -3.0), Figures(1.0, 2.0, -4.0)) == "+10 / +0 / -25 %"
