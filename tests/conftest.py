"""What all tests need of the process that they run in."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from isopeel.solve.newton import NewtonSettings

#: Where a run makes its figures and writes them.
FIGURES_OF_RUNS = "isopeel.running.stage_results"
MAKERS = ("reaction_figure", "shapes_figure")


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
    # the process that starts those of pytest-xdist, which have `workerinput`
    if config.getoption("numprocesses", None) and not hasattr(config, "workerinput"):
        from kernels import compile_kernels

        compile_kernels()


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
        for name in MAKERS:
            patch.setattr(f"{FIGURES_OF_RUNS}.{name}", lambda *_: None)
        patch.setattr(f"{FIGURES_OF_RUNS}.save", lambda _, path: path.write_bytes(b"Creator\0isopeel"))
        yield


@pytest.fixture
def with_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the runs of one test draw their figures, in a module without."""
    from isopeel.post import figures

    for name in (*MAKERS, "save"):
        monkeypatch.setattr(f"{FIGURES_OF_RUNS}.{name}", getattr(figures, name))


def let_it_be_interrupted() -> None:
    """Let Ctrl-C end this process and its children, even where a shell has it run in the background.

    Such a shell has SIGINT ignored, which is handed on from process to process.
    """
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
