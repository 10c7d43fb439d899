import re
import subprocess
from collections.abc import Callable
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest

import isopeel
from isopeel.results.provenance import Provenance, git_revision


def test_it_has_versions_time_and_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["isopeel", "run", "my case.toml"])
    found = Provenance.of_this_process()
    assert found.versions["numpy"] == version("numpy")
    assert set(found.versions) == {"isopeel", "python", "numpy", "scipy", "numba"}
    assert found.command_line == "isopeel run 'my case.toml'"
    age = datetime.now(UTC) - datetime.fromisoformat(found.started)
    assert 0 <= age.total_seconds() < 60  # a minute is plenty for one call of git


def checkout(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(isopeel, "__file__", str(folder / "src" / "isopeel" / "__init__.py"))


def test_the_revision_is_that_of_the_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def git(*arguments: str) -> str:
        identity = ("-c", "user.name=x", "-c", "user.email=x@example.org")
        command = ["git", "-C", str(tmp_path), *identity, *arguments]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()

    checkout(tmp_path, monkeypatch)
    assert git_revision() is None
    git("init")
    assert git_revision() is None  # no commit yet
    (tmp_path / "file").write_text("1")
    git("add", "file")
    git("commit", "-m", "first")
    git("tag", "-a", "v1", "-m", "a tag hides no commit")
    assert git_revision() == git("rev-parse", "HEAD")
    (tmp_path / "file").write_text("2")
    revision = git_revision()
    assert revision is not None
    assert re.fullmatch("[0-9a-f]{40}-dirty", revision)


@pytest.mark.parametrize("error", [FileNotFoundError(2, "git"), subprocess.TimeoutExpired("git", 5)])
def test_without_an_answer_there_is_no_revision(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any, **__: Any) -> Callable[[], None]:
        raise error

    checkout(tmp_path, monkeypatch)
    (tmp_path / ".git").mkdir()
    monkeypatch.setattr(subprocess, "run", fail)
    assert git_revision() is None
