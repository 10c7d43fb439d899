"""What all tests need of the process that they run in."""

import signal
from pathlib import Path

import pytest

from isopeel.solve.newton import NewtonSettings


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let all tests be run with every shortcut off."""
    parser.addoption(
        "--plain",
        action="store_true",
        help="a new tangent for every correction, without tests of chord tangents",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Make this process what the tests need."""
    if config.getoption("--plain"):
        *others, _ = NewtonSettings.__init__.__defaults__ or ()
        NewtonSettings.__init__.__defaults__ = (*others, True)
    let_it_be_interrupted()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip tests of the chord tangent where there is none."""
    if item.config.getoption("--plain") and item.get_closest_marker("chord_tangent"):
        pytest.skip("it tests the chord tangent itself")


@pytest.fixture
def in_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the test write into a folder of its own."""
    monkeypatch.chdir(tmp_path)


def let_it_be_interrupted() -> None:
    """Let Ctrl-C end this process and its children, even where a shell has it run in the background.

    Such a shell has SIGINT ignored, which is handed on from process to process.
    """
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
