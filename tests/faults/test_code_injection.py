"""Nothing is imported from the folder that a process runs in, and nothing there steers the compiler."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from isopeel.common.processes import worker_pool

MODULES = ["numba", "numpy", "h5py", "scipy", "rich", "typing", "signal", "multiprocessing", "pickle", "yaml"]
HOSTILE = "import pathlib; (pathlib.Path(__file__).parent / 'ran').touch()\nraise SystemExit(77)\n"


@pytest.fixture(autouse=True)
def _in_a_hostile_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> object:
    monkeypatch.chdir(tmp_path)
    for name in MODULES:
        (tmp_path / f"{name}.py").write_text(HOSTILE)
    (tmp_path / "evil").mkdir()
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: evil\ncache_locator_classes: numba.Evil\n")
    yield
    assert not (tmp_path / "ran").exists()
    assert not list((tmp_path / "evil").iterdir())


def run(*command: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, *command],
        capture_output=True,
        text=True,
        env={name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"} | environment,
    )


@pytest.mark.parametrize(
    "command",
    [
        ("-m", "isopeel", "law", "exponential"),
        ("-P", "-m", "isopeel", "cases"),
        ("-m", "isopeel", "--version"),
        ("-P", "-c", "import sys; from isopeel.cli import main; sys.exit(main(['spaces', 'L1']))"),
    ],
)
def test_a_command_runs_no_module_that_lies_there(command: tuple[str, ...]) -> None:
    done = run(*command)
    assert done.returncode == 0, done.stderr


def test_the_warm_up_process_imports_nothing_from_the_folder() -> None:
    script = (
        "import subprocess, isopeel.running.warm_up as r, os\n"
        "r.is_cached = lambda _: False; r.cores = lambda: 2\n"
        "with r.warmed_up_beside():\n    import time; time.sleep(1.0)\n"
    )
    assert run("-P", "-c", script).returncode == 0


def test_worker_processes_import_nothing_from_the_folder() -> None:
    with worker_pool(1) as pool:
        assert pool.submit(os.getpid).result() != os.getpid()
    assert "PYTHONSAFEPATH" not in os.environ
