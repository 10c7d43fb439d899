"""One process at a time writes to a folder, to those of its stages, and to the one that they lie in."""

from pathlib import Path

import pytest

from isopeel.cli import main
from isopeel.common.errors import InputError
from isopeel.running.folder import LOCK
from isopeel.running.lock import alone_in

SMALL = ("--mesh", "10x1", "--space", "L1", "--to", "1", "--step", "1")


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("out/1-press").mkdir(parents=True)
    Path("out/2-peel").mkdir()
    Path("other").mkdir()


@pytest.mark.parametrize(
    ("running", "refused"),
    [
        ("out", "out"),
        ("out", "out/1-press"),
        ("out", "out/2-peel"),
        ("out/1-press", "out"),
        ("out/2-peel", "out"),
    ],
)
def test_a_tree_of_stages_is_locked_as_one(
    running: str, refused: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with alone_in(Path(running), "--out"):
        assert main(["run", "strip", *SMALL, "--out", refused]) == 2
        error = capsys.readouterr().err
        assert f"'{refused}' cannot be used; another process runs in" in error
        assert error.count("\n") == 1
        assert Path(running, LOCK).exists()
    with alone_in(Path(refused), "--out"):
        pass
    assert not list(Path("out").rglob(LOCK))


@pytest.mark.parametrize(
    ("running", "free"), [("out", "other"), ("out/1-press", "out/2-peel"), ("other", "out")]
)
def test_others_are_free(running: str, free: str) -> None:
    with alone_in(Path(running), "--out"), alone_in(Path(free), "--out"):
        pass


def test_a_lock_that_nobody_holds_is_none() -> None:
    Path("out", LOCK).touch()
    Path("out/1-press", LOCK).touch()
    with alone_in(Path("out/1-press"), "--out"):
        pass
    with alone_in(Path("out"), "--out"):
        pass


def test_a_link_at_its_name_is_refused() -> None:
    Path("mine").write_text("mine")
    Path("out", LOCK).symlink_to(Path("mine").absolute())
    refused = pytest.raises(InputError, match=r"\.lock in it must be a file, but it is a symbolic link")
    with refused, alone_in(Path("out"), "--out"):
        pass
    assert Path("mine").read_text() == "mine"
    Path("other/1-press").mkdir()
    Path("other/1-press", LOCK).symlink_to(Path("mine").absolute())
    with alone_in(Path("other"), "--out"):
        pass
    assert Path("mine").read_text() == "mine"
