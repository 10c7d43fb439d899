"""What all tests need of the process that they run in."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from isopeel.solve.newton import NewtonSettings

#: What writes a figure of a run.
SAVE = "isopeel.running.stage_results.save"


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


@pytest.fixture(scope="module")
def without_figures() -> Iterator[None]:
    """Let the runs of a module leave files in place of their figures, which take most of a short run's time.

    The files are marked as the figures of isopeel are, or the next command would not replace them.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SAVE, lambda _, path: path.write_bytes(b"Creator\0isopeel"))
        yield


@pytest.fixture
def with_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the runs of one test draw their figures, in a module without."""
    from isopeel.post.figures import save

    monkeypatch.setattr(SAVE, save)


def let_it_be_interrupted() -> None:
    """Let Ctrl-C end this process and its children, even where a shell has it run in the background.

    Such a shell has SIGINT ignored, which is handed on from process to process.
    """
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
