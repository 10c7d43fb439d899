"""Files of runs that come from anywhere: refused with one line, and nothing else is read for them."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from isopeel.common.errors import InputError
from isopeel.problem import strip
from isopeel.results.journal import journal_path, read_journal
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.results.schema import checksum
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

PROBLEM, SPACE = strip(), row_space("L1", (20, 2))


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of a run of four steps, which was killed: the last three are in its journal."""
    monkeypatch.setattr("isopeel.results.run_writer._SAVE_SECONDS", 1e9)  # a step may take long to compile
    file, kept = tmp_path / "run.h5", tmp_path / "kept"
    attributes = run_attributes(PROBLEM, SPACE, Provenance({}, "", "", "", ""))
    with RunWriter(file, PROBLEM.drive, "", attributes) as writer:
        for step in trace(PROBLEM, SPACE, np.radians([0, 1, 2, 3])):
            writer.append(step)
        journal, saved = journal_path(file).read_bytes(), file.read_bytes()
        kept.write_bytes(saved)
    kept.replace(file)
    journal_path(file).write_bytes(journal)
    assert (read_run(file).journaled, len(read_run(file).curve)) == (3, 4)
    return file


Change = Callable[[h5py.File], object]


def sealed(file: h5py.File, name: str) -> None:
    """Give a data set the checksum of what it holds, as a liar would."""
    values = file[name][()]
    file[name].attrs["checksum"] = checksum(values if isinstance(values, bytes) else np.asarray(values))


def replaced(name: str, make: Callable[[h5py.File], object]) -> Change:
    def change(file: h5py.File) -> None:
        old = dict(file[name].attrs)
        made = make(file)
        del file[name]
        file[name] = made
        if isinstance(file.get(name, getlink=True), h5py.HardLink) and isinstance(file[name], h5py.Dataset):
            file[name].attrs.update(old)
            if file[name].dtype.kind in "fi":
                sealed(file, name)

    return change


def changed(name: str, value: float) -> Change:
    """The first number of a data set is another one."""

    def change(file: h5py.File) -> None:
        values = file[name][()]
        values.flat[0] = value
        file[name][...] = values
        sealed(file, name)

    return change


def huge(name: str) -> Change:
    """An array of 8 TB that nothing was written to."""

    def change(file: h5py.File) -> None:
        shape = {1: (2**40,), 2: (2**20, 2**20), 3: (1, 2**39, 2)}[file[name].ndim]
        del file[name]
        file.create_dataset(name, shape, dtype="f8")

    return change


def packed(file: h5py.File) -> None:
    """Zeros, a hundred thousand times as many as bytes."""
    del file["last/displacement"]
    file.create_dataset(
        "last/displacement", (2**20, 2), dtype="f8", chunks=(2**18, 2), compression="gzip", fillvalue=0.0
    )
    file["last/displacement"][:] = 0.0


def elsewhere(file: h5py.File) -> None:
    file.create_dataset("base", (8, 2), dtype="f8", external=[("/etc/passwd", 0, 128)])


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((4, 2), dtype="f8")
    layout[:] = h5py.VirtualSource("other.h5", "x", (4, 2))
    file.create_virtual_dataset("base", layout)


def drop(name: str) -> Change:
    def change(file: h5py.File) -> None:
        del file[name]

    return change


def attribute(name: str, value: object, of: str = "/") -> Change:
    def change(file: h5py.File) -> None:
        file[of].attrs[name] = value

    return change


def openings(value: float, *shape: int) -> Change:
    def change(file: h5py.File) -> None:
        name = "history/interface/maximum_openings"
        file[name] = np.full(shape or (1, *file["last/maximum_openings"].shape), value)
        file[name].attrs["first"] = 0
        sealed(file, name)

    return change


def wrong_bits(file: h5py.File) -> None:
    file["curve/reaction"][...] = file["curve/reaction"][()] + 1e-9


LIES: dict[str, Change] = {
    "a huge field": huge("fields/displacement"),
    "a huge curve": huge("curve/reaction"),
    "a huge memory": huge("last/solver/lbfgs_corrections"),
    "packed zeros": packed,
    "bytes of another file": elsewhere,
    "a virtual array": virtual,
    "an external link": replaced("last", lambda _: h5py.ExternalLink("other.h5", "/last")),
    "an external link to an array": replaced("curve/reaction", lambda _: h5py.ExternalLink("o.h5", "/x")),
    "a soft link": replaced("curve/reaction", lambda _: h5py.SoftLink("/curve/parameter")),
    "no curve": drop("curve"),
    "no fields": drop("fields"),
    "no case": drop("case"),
    "no unknowns": drop("last/solver/accepted_unknown_values"),
    "a group for an array": replaced("curve/reaction", lambda file: file.create_group("x")),
    "an array for a group": replaced("last", lambda _: 1.0),
    "texts for numbers": replaced("curve/reaction", lambda _: ["a"]),
    "single precision": replaced("curve/reaction", lambda _: np.zeros(1, dtype="f4")),
    "numbers for the case": replaced("case", lambda _: 3.0),
    "a short column": replaced("curve/reaction", lambda _: np.zeros(0)),
    "counts below zero": replaced("curve/iterations", lambda _: np.array([-1])),
    "counts of others": replaced("curve/iterations", lambda _: np.array([10**9])),
    "iterations in a table": replaced("curve/iterations", lambda _: np.array([[1]])),
    "fields of others": replaced("fields/displacement", lambda _: np.zeros((1, 3, 2))),
    "a field of no step": replaced("fields/step", lambda _: np.array([7])),
    "infinite openings": openings(np.inf),
    "openings of another side": openings(0.1, 1, 3, 3),
    "openings of more states": openings(0.1, 2, 1, 1),
    "three components": replaced("last/displacement", lambda _: np.zeros((63, 3))),
    "residuals without a value": changed("curve/energy_residuals", np.nan),
    "an infinite reaction": changed("curve/reaction", np.inf),
    "a field without a value": changed("fields/displacement", np.nan),
    "other bits": wrong_bits,
    "another ending": attribute("ending", "won"),
    "another format": attribute("format", 7),
    "no identity": attribute("identity", "xyz"),
    "an attribute that is an array": attribute("dofs", [1.0, 2.0]),
    "an interval of none": attribute("field_interval", 0.0),
    "a name in no encoding": attribute("name", np.bytes_(b"\xff\xfe"), "curve/reaction"),
}


# only a chord tangent has a solver state
MARKS = {"a huge memory": pytest.mark.chord_tangent}


@pytest.mark.parametrize("lie", [pytest.param(lie, marks=MARKS.get(lie, ())) for lie in LIES])
def test_a_file_that_lies_is_refused(lie: str, path: Path) -> None:
    with h5py.File(path, "r+") as file:
        LIES[lie](file)
    with pytest.raises(InputError, match="the file of a run is needed") as caught:
        read_run(path)
    assert str(caught.value).count("\n") == 0


@pytest.mark.parametrize(
    ("name", "written", "read"),
    [
        ("unit", "$\\frac{a}{b$", "fracab"),
        ("unit", "\x1b[2Jdegree", "2Jdegree"),
        ("words", "$\\undefined{$", "undefined"),
        ("words", "rotation $\\theta$", "rotation $\\theta$"),
        ("name", "../../etc\n", "../../etc"),
    ],
)
def test_labels_are_read_without_what_figures_and_terminals_take_for_more(
    name: str, written: str, read: str, path: Path
) -> None:
    with h5py.File(path, "r+") as file:
        file["curve/parameter"].attrs[name] = written
    assert getattr(read_run(path, journal=False).curve.parameter_column, name) == read


def test_the_file_of_another_version_is_refused_as_that(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs["format"] = "isopeel run 6"
    with pytest.raises(InputError, match=r"another version of isopeel \(isopeel run 6\): run its case again"):
        read_run(path)


def test_a_file_cut_anywhere_is_refused(path: Path) -> None:
    whole = path.read_bytes()
    for size in np.linspace(0, len(whole) - 1, 40).astype(int):
        path.write_bytes(whole[:size])
        with pytest.raises(InputError, match="the file of a run is needed"):
            read_run(path)


def test_a_journal_cut_anywhere_is_read_to_its_last_whole_record(path: Path) -> None:
    run, saved, journal = read_run(path), read_run(path, journal=False), journal_path(path).read_bytes()
    last = saved.states[-1]
    shapes = last.displacement.shape, last.maximum_openings.shape
    found: list[int] = []
    for size in range(len(journal) + 1):
        journal_path(path).write_bytes(journal[:size])
        # without the file, which stays as it is, and takes most of the time
        records = list(read_journal(path, run.identity, saved.curve, *shapes))
        read = saved.curve.followed_by([record.curve for record in records])
        assert read.reaction.tobytes() == run.curve.reaction[: len(read)].tobytes()
        if size in (0, len(journal)) or len(read) != found[-1]:
            assert read_run(path).curve.reaction.tobytes() == read.reaction.tobytes()
        found.append(len(read))
    assert found == sorted(found)
    assert set(found) == {1, 2, 3, 4}


def test_a_journal_with_wrong_bits_is_not_believed(path: Path) -> None:
    run, journal = read_run(path), journal_path(path).read_bytes()
    rng = np.random.default_rng(1)
    for place in rng.integers(0, len(journal), 200):
        changed = bytearray(journal)
        changed[place] ^= 1 << int(rng.integers(8))
        journal_path(path).write_bytes(changed)
        part = read_run(path)
        # displacements carry no checksum: what goes on is not made of them
        count = len(part.curve)
        assert part.curve.reaction.tobytes() == run.curve.reaction[:count].tobytes()


def test_the_journal_of_another_run_is_left_alone(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs["identity"] = "0" * 32
    assert len(read_run(path).curve) == 1
