"""What all tests need of the process that they run in."""

import signal

import pytest

from isopeel.solve.newton import NewtonSettings


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let all tests be run with every shortcut off."""
    parser.addoption("--plain", action="store_true", help="a new tangent for every correction, unless told")


@pytest.fixture(autouse=True)
def plain_by_default(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """With --plain, make plain Newton's method the default, and leave out tests of the kept tangent itself."""
    if not request.config.getoption("--plain"):
        return
    if request.node.get_closest_marker("kept_tangent"):
        pytest.skip("it tests the kept tangent itself")
    *others, _ = NewtonSettings.__init__.__defaults__ or ()
    monkeypatch.setattr(NewtonSettings.__init__, "__defaults__", (*others, True))


def pytest_configure() -> None:
    """Let Ctrl-C end this process and its children, even where a shell has it run in the background.

    Such a shell has SIGINT ignored, which is handed on from process to process.
    """
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
