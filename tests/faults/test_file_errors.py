"""A full disk and too few open files are named, with the file, in one line; nothing else breaks."""

import errno
import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

import isopeel
from isopeel.cli import main
from isopeel.results.files import replacing

pytestmark = pytest.mark.posix

SMALL = ("run", "strip", "--mesh", "10x1", "--space", "L1", "--to", "2", "--step", "1", "--out", "out")


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.count("\n") == 1
    return error


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EMFILE, errno.EDQUOT, errno.EIO])
@pytest.mark.parametrize(
    "where", ["isopeel.case.load_case", "isopeel.running.run.run_case", "isopeel.running.stage_run.places"]
)
def test_an_error_that_comes_early_is_reported(
    code: int, where: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError(code, os.strerror(code), "some/file")

    monkeypatch.setattr(where, fail)
    assert main([*SMALL]) == 2
    error = the_error(capsys)
    assert "some/file" in error
    assert os.strerror(code) in error


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EMFILE, errno.EFBIG, errno.EIO])
@pytest.mark.parametrize("name", ["run.h5", "figure.png"])
def test_an_error_without_a_file_name_gets_one(code: int, name: str) -> None:
    def write() -> None:
        with replacing(Path(name)) as part:
            part.touch()
            raise OSError(code, os.strerror(code))

    with pytest.raises(OSError, match=f"'{name}'") as caught:
        write()
    assert caught.value.errno == code
    assert not list(Path().iterdir())


@pytest.mark.parametrize("most", [0, 2000, 20_000, 100_000])
def test_a_disk_that_fills_up_keeps_what_is_there(most: int, capsys: pytest.CaptureFixture[str]) -> None:
    """By a limit on the size of files, which ends a write where a full disk does."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, limits[1]))
    try:
        code = main([*SMALL])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    if most < 100_000:
        assert code == 2
        assert "out/run.h5 cannot be written: File too large" in the_error(capsys)
        assert not Path("out/run.h5").exists()
    else:
        assert code in (0, 2)
        assert len(isopeel.read_run(Path("out/run.h5")).curve) > 0


@pytest.mark.parametrize("count", [12, 24, 40])
def test_too_few_open_files_are_reported(count: int) -> None:
    limit = f"import resource; resource.setrlimit(resource.RLIMIT_NOFILE, ({count}, {count}));"
    script = f"{limit} import sys; from isopeel.cli import main; sys.exit(main())"
    done = subprocess.run([sys.executable, "-c", script, *SMALL], capture_output=True, text=True)
    assert "Traceback" not in done.stderr
    if done.returncode:
        assert done.returncode == 2
        assert "Too many open files" in done.stderr
        assert done.stderr.count("\n") == 1
