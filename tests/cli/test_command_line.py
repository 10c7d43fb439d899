"""The command line itself: version, help, unknown commands."""

import subprocess
import sys
from pathlib import Path

import pytest
from command_output import the_error

import isopeel
from isopeel.cli import main


def test_version_help_and_unknown_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"isopeel {isopeel.__version__}\n"
    assert main([]) == 0
    assert "spaces" in capsys.readouterr().out
    assert main(["peel"]) == 2
    assert "'peel'" in the_error(capsys)


def test_help_does_not_wait_for_a_compiler() -> None:
    script = (
        "import sys; from isopeel.cli import main; main(['run', '--help']); print('numba' in sys.modules)"
    )
    message = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    ).stdout
    assert "--traction" in message
    assert message.splitlines()[-1] == "False"


def test_a_run_imports_no_slow_package_that_it_does_not_need(tmp_path: Path) -> None:
    script = (
        "import sys; from isopeel.cli import main;"
        "assert main(['run', 'strip', '--to', '0.1', '--mesh', '40x2', '--out', sys.argv[1]]) == 0;"
        "print(sorted({'sympy', 'pyvista'} & set(sys.modules)))"
    )
    command = [sys.executable, "-c", script, str(tmp_path / "out")]
    message = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert message.splitlines()[-1] == "[]"
