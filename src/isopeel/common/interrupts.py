"""Ctrl-C: it ends a computation at the next safe point, not in the middle of an instruction.

Python's own handler raises KeyboardInterrupt between any two instructions. Inside compiled code, or in a
callback of a library, it becomes another error, or is lost. The handler here only sets a flag, and `check`,
which long loops call, raises KeyboardInterrupt.

A process of the command line must still end soon, and without a traceback. So a thread waits beside it: where
no safe point is reached in time, the thread ends the process. This loses no data: a run without a step has
none, and later each step is in the journal.
"""

# those of `signal` convert numbers to enumerations at each call, which would slow down a step of 0.6 ms
import _signal  # type: ignore[import-not-found]
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ContextDecorator, contextmanager, suppress
from threading import Lock, Thread, current_thread, main_thread
from time import perf_counter, sleep
from types import FrameType

_SIGINT = int(signal.SIGINT)
#: Exit code of a process that Ctrl-C has ended.
INTERRUPTED = 130
#: Seconds that a run with steps has until its next safe point: most take some milliseconds, a figure or the
#: step of a large mesh a second, on a busy machine a few seconds.
_PATIENCE = 4.0
#: The number of times Ctrl-C after which the process ends at once.
_MOST = 3
#: Seconds between two checks whether the process has ended.
_LOOK = 0.01
#: A process that ends at once leaves semaphores of its children. The resource tracker of `multiprocessing`
#: removes them, and warns programmers who forgot to do so.
_NO_WARNING = "ignore:resource_tracker:UserWarning"
#: Seconds to write a line.
_TO_WRITE = 0.2
#: Restores a terminal after a progress bar, which hides the cursor and begins a line.
_CLEARED = b"\r\x1b[2K\x1b[?25h"


class _State:
    """The state of Ctrl-C in this process."""

    def __init__(self) -> None:
        self.came = 0
        self.ends_process = False
        self.line_is_free = Lock()  # never released by the one that writes the message
        self.raised = False  # no threading.Event: an interrupt in the middle would leave its lock taken
        self.patience = 0.0
        self.message = self.message_later = "interrupted"
        self.left_over: list[Callable[[], object]] = []


_state = _State()


def check() -> None:
    """Raise KeyboardInterrupt once where Ctrl-C was pressed."""
    if _state.came and not _state.raised:
        _state.raised = True
        raise KeyboardInterrupt


class deferred(ContextDecorator):  # noqa: N801
    """While the context is open, Ctrl-C takes effect where `check` is called, and at the end.

    The third Ctrl-C takes effect at once. Where another handler of Ctrl-C is set, or none, it stays. Each
    step of a path opens this context: as a class it costs a tenth of what a generator would.
    """

    def __enter__(self) -> None:
        """Set the handler."""
        self._is_set = _is_usual()
        if self._is_set:
            _begin()
            _signal.signal(_SIGINT, _on_interrupt)

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Set Python's own handler again."""
        if not self._is_set:
            return
        if kind is not None:
            # an error that comes first is the one to report
            _state.came = 0
        _signal.signal(_SIGINT, signal.default_int_handler)
        if kind is None:
            check()

    def _recreate_cm(self) -> "deferred":
        # a decorated function may be called by several threads
        return deferred()


@contextmanager
def ending_this_process() -> Iterator[None]:
    """The same for a process of the command line, which Ctrl-C ends soon, with one line and INTERRUPTED.

    It ends at once until `leave_time` is called. After the context Ctrl-C is ignored.
    """
    if not _is_usual():
        yield
        return
    _begin()
    # the resource tracker is a process, and reads its filter of warnings from the environment
    chosen = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = f"{chosen},{_NO_WARNING}" if chosen else _NO_WARNING
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    Thread(target=_wait, args=(reader,), daemon=True, name="Ctrl-C").start()
    _state.ends_process = True
    before = signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, _on_interrupt)
    try:
        yield
    finally:
        # the interpreter takes a while to end
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.set_wakeup_fd(before)
        os.close(writer)
        _state.ends_process = False


@contextmanager
def reporting(message: str, message_later: str | None = None) -> Iterator[None]:
    """Set the message for Ctrl-C in the context, and another one for the time when there are steps."""
    _state.message, _state.message_later = message, message_later or message
    try:
        yield
    finally:
        _state.message = _state.message_later = "interrupted"
        _state.patience = 0.0


def may_report() -> bool:
    """Return whether the caller writes the message on Ctrl-C: the first caller, where it ends the process."""
    return not _state.ends_process or _state.line_is_free.acquire(blocking=False)


def leave_time() -> None:
    """Let Ctrl-C wait for the next safe point from now on, as there are data to write."""
    _state.patience, _state.message = _PATIENCE, _state.message_later


@contextmanager
def cleared_up(how: Callable[[], object]) -> Iterator[None]:
    """Clear up at the end of the context, also where Ctrl-C ends the process in it."""
    _state.left_over.append(how)
    try:
        yield
    finally:
        how()
        _state.left_over.remove(how)


def _is_usual() -> bool:
    """Return whether Ctrl-C raises KeyboardInterrupt, and this thread can change that."""
    usual = _signal.getsignal(_SIGINT) is signal.default_int_handler
    return usual and current_thread() is main_thread()


def _begin() -> None:
    _state.came, _state.raised = 0, False


def _on_interrupt(_number: int, _frame: FrameType | None) -> None:
    _state.came += 1
    if _state.came >= _MOST and not _state.ends_process:
        raise KeyboardInterrupt


def _wait(reader: int) -> None:
    """Wait for Ctrl-C, and see to it that the process ends."""
    came = 0
    while numbers := os.read(reader, 1):
        came += numbers[0] == signal.SIGINT
        if came == 1:
            Thread(target=_end_unless_left, daemon=True).start()
        elif came == _MOST:
            _end()
    os.close(reader)


def _end_unless_left() -> None:
    until = perf_counter() + _state.patience
    while not _state.raised:
        if perf_counter() >= until:
            _end()
        sleep(_LOOK)


def _end() -> None:
    """End this process, whatever its other threads do."""
    # the reader of its output may have stopped reading
    flush = Thread(target=sys.stdout.flush, daemon=True)
    flush.start()
    flush.join(1.0)
    with suppress(OSError):
        if os.isatty(1):
            os.write(1, _CLEARED)
        if may_report():
            os.write(2, f"isopeel: {_state.message}\n".encode(errors="backslashreplace"))
        else:
            sleep(_TO_WRITE)
    for how in reversed(_state.left_over):
        with suppress(OSError):
            how()
    os._exit(INTERRUPTED)
