"""Whatever the file of a run holds, a command shows the run or refuses it with one line, in seconds."""

import io
import shutil
import tempfile
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from time import process_time
from typing import Any

import h5py
import pytest
from cases import AROUND, BODIES, LAWS, MATERIALS, TEXTS, documents, toml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from isopeel.cli import main
from isopeel.results.schema import checksum

LIMIT = 20.0  # seconds of this process, as the machine may have much to do; a page takes about one
COMMANDS = [
    ["plot", "--only", "curve"],
    ["plot", "--only", "shapes", "--at", "1"],
    ["report"],
    ["export"],
    ["resume"],
    ["resume", "--to", "3"],
    ["resume", "--control", "jump"],
]
#: Of the root, a curve and its columns.
ATTRIBUTES = [
    "L0",
    "E0",
    "stage",
    "space",
    "mesh",
    "dofs",
    "traction",
    "ending",
    "identity",
    "format",
    "started",
]
VALUES: list[Any] = [
    "", "\x1b[2J\x1b]0;owned\x07", "x" * 100_000, "\x7f", "\u202e", "1 nm", "0 nm", -1, 0, 2**62, 1e300,
    "é\n\nü", "running", "not converged", "peel", "N2", "9x9", "0x0", "projected",
]  # fmt: skip
SMALL = {
    "name": "small",
    "body": BODIES[0],
    "material": MATERIALS[0],
    "adhesion": LAWS[0],
    "discretization": {"space": "L1", "mesh": "8x2"},
    "drive": {"to": "2 deg", "step": "1 deg"},
    "output": {"fields_every": "1 deg"},
}

Change = Callable[[Path], None]


@pytest.fixture(scope="module")
def stored(without_figures: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of three steps."""
    folder = tmp_path_factory.mktemp("stored")
    (folder / "case.toml").write_text(toml(SMALL))
    assert main(["run", str(folder / "case.toml"), "--out", str(folder / "out")]) == 0
    return folder / "out"


def with_text(text: str) -> Change:
    def change(file: Path) -> None:
        with h5py.File(file, "r+") as opened:
            stored = text.encode("utf-8", "replace").replace(b"\0", b"?")
            del opened["case"]
            opened["case"] = stored.decode()
            opened["case"].attrs["checksum"] = checksum(stored)

    return change


def with_attribute(name: str, value: Any) -> Change:
    def change(file: Path) -> None:
        with h5py.File(file, "r+", libver="latest") as opened:
            opened.attrs[name] = value

    return change


def with_bytes(place: float, value: int, count: int) -> Change:
    def change(file: Path) -> None:
        content = bytearray(file.read_bytes())
        begin = int(place * (len(content) - 1))
        content[begin : begin + count] = bytes([value]) * len(content[begin : begin + count])
        file.write_bytes(content)

    return change


def cut(place: float) -> Change:
    def change(file: Path) -> None:
        content = file.read_bytes()
        file.write_bytes(content[: int(place * len(content))])

    return change


@st.composite
def texts(draw: st.DrawFn) -> str:
    """The text of a case: the run's own with a change, another one, or none."""
    if draw(st.booleans()):
        key = draw(st.sampled_from(["about", "name"]))
        return toml(SMALL | {key: draw(st.sampled_from(TEXTS))}).join(draw(st.sampled_from(AROUND)))
    return draw(st.one_of(documents().map(toml), st.text(max_size=200), st.just("a" * 200_000)))


CHANGES = st.one_of(
    texts().map(with_text),
    st.builds(with_attribute, st.sampled_from(ATTRIBUTES), st.sampled_from(VALUES)),
    st.builds(with_bytes, st.floats(0, 1), st.integers(0, 255), st.sampled_from([1, 1, 8, 100])),
    st.floats(0, 0.999).map(cut),
)


def check(stored: Path, change: Change, command: list[str]) -> None:
    """Either the run is shown, or one line reports why not, without control characters."""
    written, error = io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch, "out")
        shutil.copytree(stored, folder)
        change(folder / "run.h5")
        began = process_time()
        with redirect_stdout(written), redirect_stderr(error):
            code = main([command[0], str(folder), *command[1:]])
        assert process_time() - began < LIMIT
    assert code in (0, 2, 3)
    message = error.getvalue()
    assert (message == "") == (code == 0)
    if code == 2:
        assert message.startswith("isopeel: ")
        assert len(message.splitlines()) == 1
        assert len(message) < 3000
    for text in (message, written.getvalue()):
        assert all(one.isprintable() or one in "\n\xa0" for one in text)


def any_run(examples: int) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Draw so many changes, the same ones each time."""

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        limited = settings(
            max_examples=examples,
            deadline=None,
            derandomize=True,
            database=None,
            suppress_health_check=list(HealthCheck),
        )
        return limited(given(change=CHANGES, command=st.sampled_from(COMMANDS))(test))

    return decorate


@any_run(60)
def test_a_changed_run_is_shown_or_refused(stored: Path, change: Change, command: list[str]) -> None:
    check(stored, change, command)


@pytest.mark.long
@any_run(600)
def test_six_hundred_changed_runs(stored: Path, change: Change, command: list[str]) -> None:
    check(stored, change, command)
