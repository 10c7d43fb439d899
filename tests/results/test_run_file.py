from dataclasses import replace
from itertools import islice
from pathlib import Path

import h5py
import numpy as np
import pytest

from isopeel.common.errors import InputError
from isopeel.physics.adhesion import Exponential
from isopeel.problem import RotatedSide, strip
from isopeel.results.curve import Curve
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import Failure, read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

PROBLEM = strip()
SPACE = row_space("L1+N2", (6, 2))
PROVENANCE = Provenance(
    {"isopeel": "0.1.0", "numpy": "2"}, "here", "0123abc-dirty", "2021-02-03T04:05:06+00:00", "isopeel run"
)


def steps(degrees: list[float]) -> list[Step]:
    random = np.random.default_rng(1)
    return [
        Step(
            number=k,
            parameter=float(np.radians(angle)),
            reaction=float(random.normal()),
            displacement=random.normal(size=(SPACE.size, 2)),
            stored_energy=float(random.normal()),
            adhesive_energy=float(random.normal()),
            dissipated_energy=float(random.normal()),
            maximum_openings=np.zeros((2, 3)),
            iterations=(1e-3, 1e-9, 1e-20)[: k + 1],
            seconds=0.1,
            unknown_values=random.normal(size=7),
        )
        for k, angle in enumerate(degrees)
    ]


def writer(path: Path) -> RunWriter:
    return RunWriter(path, PROBLEM.drive, 'name = "µ"\n', run_attributes(PROBLEM, SPACE, PROVENANCE))


def test_a_path_continues_from_its_file_bit_for_bit(tmp_path: Path) -> None:
    """With irreversible adhesion, whose openings are a part of the state."""
    # weaker than the strip's law, so that a coarse mesh resolves the front
    problem, space = strip(law=Exponential(0.03, 0.015), irreversible=True), row_space("N2.1", (100, 3))
    angles = np.radians(np.arange(0.0, 70.0, 1.0))
    steps = trace(problem, space, angles)
    whole = []
    with RunWriter(
        tmp_path / "run.h5", problem.drive, "", run_attributes(problem, space, PROVENANCE)
    ) as file:
        for step in islice(steps, 60):
            file.append(step)
            whole.append(step)
    whole += steps
    state = read_run(tmp_path / "run.h5").last
    assert state is not None
    assert whole[59].dissipated_energy > 0
    for one, other in zip(trace(problem, space, angles[60:], start=[state]), whole[60:], strict=True):
        assert (one.reaction, one.dissipated_energy) == (other.reaction, other.dissipated_energy)
        np.testing.assert_array_equal(one.displacement, other.displacement)


@pytest.mark.parametrize("closed", [0.0, -1.0])
def test_the_journal_of_a_killed_run_holds_the_openings(
    closed: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of each state that is kept, to the last bit; -1 where a point has not closed yet."""
    monkeypatch.setattr("isopeel.results.run_writer._SAVE_SECONDS", 1e9)
    random = np.random.default_rng(2)
    history = np.maximum.accumulate(random.normal(size=(4, 2, 3)), axis=0)
    history[:2] = closed
    taken = [
        replace(step, maximum_openings=maximum_openings)
        for step, maximum_openings in zip(steps([0, 10, 20, 25]), history, strict=True)
    ]
    file = writer(tmp_path / "run.h5")
    for step in taken:
        file.append(step)
    run = read_run(tmp_path / "run.h5")
    assert run.journaled == 3
    for state, maximum_openings in zip(run.states, history, strict=True):
        np.testing.assert_array_equal(state.maximum_openings, maximum_openings)
    file.end("completed")
    file.__exit__(None, None, None)
    whole = read_run(tmp_path / "run.h5")
    for state, maximum_openings in zip(whole.states, history, strict=True):
        np.testing.assert_array_equal(state.maximum_openings, maximum_openings)


def columns(curve: Curve) -> list[list[float]]:
    return [
        column.tolist()
        for column in (
            curve.parameter,
            curve.reaction,
            curve.iterations,
            curve.stored_energy,
            curve.adhesive_energy,
            curve.dissipated_energy,
            curve.released_energy,
            curve.seconds,
            curve.energy_residuals,
        )
    ]


def test_a_run_is_read_back_to_the_last_bit(tmp_path: Path) -> None:
    taken = steps([0, 4, 9.5, 12, 16, 20, 24, 27])
    failure = Failure(31.5, "the tangent is singular: pivot 3 vanishes", (1e-3, float("inf")))
    with writer(tmp_path / "run.h5") as run:
        for step in taken:
            run.append(step)
        run.end("not converged", failure)
    stored = read_run(tmp_path / "run.h5")
    assert columns(stored.curve) == columns(Curve.of(taken, PROBLEM.drive))
    assert tuple(stored.curve.residuals_of(3)) == taken[3].iterations
    assert stored.curve.parameter_column == PROBLEM.drive.parameter_column
    assert stored.curve.reaction_column == PROBLEM.drive.reaction_column
    # the first step at or beyond 0, 10 and 20 degrees, and the last one
    assert [state.parameter for state in stored.states] == [0, 12, 20, 27]
    for state, number in zip(stored.states, (0, 3, 5, 7), strict=True):
        assert state.step == number
        assert np.array_equal(state.displacement, taken[number].displacement)
    assert (stored.ending, stored.failure, stored.case_text) == ("not converged", failure, 'name = "µ"\n')
    assert stored.attributes == {
        "space": "L1+N2",
        "mesh": "6x2",
        "dofs": 2 * SPACE.size,
        "traction": "reference",
        "platform": "here",
        "started": "2021-02-03T04:05:06+00:00",
        "command_line": "isopeel run",
        "version_isopeel": "0.1.0",
        "version_numpy": "2",
        "git_revision": "0123abc-dirty",
    }
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


def test_columns_have_their_units(tmp_path: Path) -> None:
    with writer(tmp_path / "run.h5") as run:
        run.append(steps([0])[0])
    with h5py.File(tmp_path / "run.h5") as file:
        units = {name: column.attrs["unit"] for name, column in file["curve"].items()}
    assert units == {
        "parameter": "degree",
        "reaction": "E0 L0^3",
        "iterations": "1",
        "stored_energy": "E0 L0^3",
        "adhesive_energy": "E0 L0^3",
        "dissipated_energy": "E0 L0^3",
        "released_energy": "E0 L0^3",
        "energy_residuals": "E0 L0^3",
        "seconds": "s",
        "kind": "1",
        "negative_eigenvalues": "1",
    }


def test_reactions_of_boundaries_and_the_work_of_loads_are_read_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the file and from the journal of a killed run, under the names of the boundaries."""
    monkeypatch.setattr("isopeel.results.run_writer._SAVE_SECONDS", 1e9)
    body = PROBLEM.body
    drive = RotatedSide(((body.side("right"), 1.0), (body.side("top", 0.0, 0.2), -1.0)))
    taken = [replace(step, reactions=(k, -2.5), load_work=k / 3) for k, step in enumerate(steps([0, 10, 20]))]
    file = RunWriter(tmp_path / "run.h5", drive, "", run_attributes(PROBLEM, SPACE, PROVENANCE))
    for step in taken:
        file.append(step)
    run = read_run(tmp_path / "run.h5")
    assert run.journaled == 2
    file.end("completed")
    file.__exit__(None, None, None)
    for curve in (run.curve, read_run(tmp_path / "run.h5").curve):
        assert curve.reactions.tolist() == [[0, -2.5], [1, -2.5], [2, -2.5]]
        assert curve.load_work.tolist() == [0, 1 / 3, 2 / 3]
        names = [column.name for column, _ in curve.table()]
        assert names[:4] == ["theta_deg", "moment", "body.right", "body.top"]
        assert "load_work" in names
        assert columns(curve) == columns(Curve.of(taken, drive))
    with h5py.File(tmp_path / "run.h5", "r+") as stored:
        stored["curve/reactions"].attrs["names"] = "body.right, body"
    with pytest.raises(InputError, match="the names of its boundaries do not fit"):
        read_run(tmp_path / "run.h5")


def test_an_exception_leaves_all_steps_before_it(tmp_path: Path) -> None:
    taken = steps([0, 1, 2])

    def fail_after_three() -> None:
        with writer(tmp_path / "run.h5") as run:
            for step in taken:
                run.append(step)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_after_three()
    stored = read_run(tmp_path / "run.h5")
    assert columns(stored.curve) == columns(Curve.of(taken, PROBLEM.drive))
    assert (stored.ending, stored.failure) == ("running", None)
    assert [state.parameter for state in stored.states] == [0, 2]


def test_a_run_without_steps_is_read_back(tmp_path: Path) -> None:
    with writer(tmp_path / "run.h5"):
        pass
    assert list(tmp_path.iterdir()) == []
    with writer(tmp_path / "run.h5") as run:
        run.end("completed")
    stored = read_run(tmp_path / "run.h5")
    assert (len(stored.curve), stored.states) == (0, ())


def test_a_full_disk_leaves_what_was_saved_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fill_up(path: Path, image: bytes) -> int:
        with path.open("wb") as file:
            file.write(image[:100])
        raise OSError(28, "No space left on device")

    run = writer(tmp_path / "run.h5")
    with run:
        run.append(steps([0])[0])
    monkeypatch.setattr(Path, "write_bytes", fill_up)
    with pytest.raises(OSError, match="No space left"), run:
        pass
    assert len(read_run(tmp_path / "run.h5").curve) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


def test_other_files_are_refused(tmp_path: Path) -> None:
    text, foreign, old = (tmp_path / name for name in ("text.h5", "foreign.h5", "old.h5"))
    text.write_text("no HDF5")
    with h5py.File(foreign, "w") as file:
        file["curve"] = [1.0]
    with h5py.File(old, "w") as file:
        file.attrs["format"] = "isopeel run 1"
    for path in (text, foreign, old, tmp_path, tmp_path / "none.h5"):
        with pytest.raises(InputError) as caught:
            read_run(path)
        assert (caught.value.field, caught.value.value) == ("FILE", str(path))
