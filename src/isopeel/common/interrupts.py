"""Ctrl-C: it ends what goes on at the next point where that can be left, and not in the middle.

Python's own handler raises KeyboardInterrupt between any two instructions. Inside compiled code, or where a
library calls back, that becomes another error, or is dropped. Here a handler takes a note only, and `check`,
which long loops call, raises KeyboardInterrupt.

A process of isopeel's own must end soon all the same, and not with a traceback. So a thread waits beside it:
where no such point is reached in time, it ends the process. That loses nothing: before a run has a step
there is nothing to lose, and then each step is in its journal.
"""

# these of `signal` turn numbers into enumerations at each call, which a step of 0.6 ms would notice
import _signal  # type: ignore[import-not-found]
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Lock, Thread, current_thread, main_thread
from time import perf_counter, sleep
from types import FrameType

_SIGINT = int(signal.SIGINT)
#: Exit code of a process that Ctrl-C has ended.
INTERRUPTED = 130
#: Seconds that a run with steps has until its next point to leave it: most take some milliseconds, a figure
#: or the step of a large mesh a second, on a machine with much to do a few.
_PATIENCE = 4.0
#: As many times Ctrl-C do not wait for anything.
_MOST = 3
#: Seconds between two looks at whether it has been left.
_LOOK = 0.01
#: Seconds that a line takes to be said.
_TO_TELL = 0.2
#: What a bar of progress has hidden or begun on a terminal: the cursor, and a line.
_CLEARED = b"\r\x1b[2K\x1b[?25h"


class _Noted:
    """What is known of Ctrl-C in this process."""

    def __init__(self) -> None:
        self.came = 0
        self.ends_process = False
        self.line_is_free = Lock()  # which whoever says the one line does not release
        self.raised = False  # no threading.Event: an interrupt in the middle would leave its lock taken
        self.patience = 0.0
        self.message = self.message_later = "interrupted"
        self.left_over: list[Callable[[], object]] = []


_noted = _Noted()


def check() -> None:
    """Raise KeyboardInterrupt where Ctrl-C has come; once, as what follows takes a moment only."""
    if _noted.came and not _noted.raised:
        _noted.raised = True
        raise KeyboardInterrupt


@contextmanager
def deferred() -> Iterator[None]:
    """While the context is open, Ctrl-C takes effect where `check` is called, and at the end.

    The third one does not wait for that. Where Ctrl-C does something else than usual already, or nothing,
    that stays so.
    """
    if not _is_usual():
        yield
        return
    _begin()
    _signal.signal(_SIGINT, _note)
    try:
        yield
    except BaseException:
        # an error that comes first is the one to tell of
        _noted.came = 0
        raise
    finally:
        _signal.signal(_SIGINT, signal.default_int_handler)
    check()


@contextmanager
def ending_this_process() -> Iterator[None]:
    """The same for a process of isopeel's own, which ends in any case: soon, with one line and INTERRUPTED.

    That is at once, until something asks to `leave_time`. Afterwards Ctrl-C has nothing left to end.
    """
    if not _is_usual():
        yield
        return
    _begin()
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    Thread(target=_wait, args=(reader,), daemon=True, name="Ctrl-C").start()
    _noted.ends_process = True
    before = signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, _note)
    try:
        yield
    finally:
        # the interpreter takes a while to go down
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.set_wakeup_fd(before)
        os.close(writer)
        _noted.ends_process = False


@contextmanager
def reporting(message: str, message_later: str | None = None) -> Iterator[None]:
    """Say something where Ctrl-C ends the process in the context; something else once there are steps."""
    _noted.message, _noted.message_later = message, message_later or message
    try:
        yield
    finally:
        _noted.message = _noted.message_later = "interrupted"
        _noted.patience = 0.0


def may_tell() -> bool:
    """Whether the caller is to say that Ctrl-C has come: the first who asks, where that ends the process."""
    return not _noted.ends_process or _noted.line_is_free.acquire(blocking=False)


def leave_time() -> None:
    """From now on there is something to write, or to end: Ctrl-C leaves some time for it."""
    _noted.patience, _noted.message = _PATIENCE, _noted.message_later


@contextmanager
def cleared_up(how: Callable[[], object]) -> Iterator[None]:
    """Clear up at the end of the context, also where Ctrl-C ends the process in it."""
    _noted.left_over.append(how)
    try:
        yield
    finally:
        how()
        _noted.left_over.remove(how)


def _is_usual() -> bool:
    """Return whether Ctrl-C raises KeyboardInterrupt, and this thread can change that."""
    usual = _signal.getsignal(_SIGINT) is signal.default_int_handler
    return usual and current_thread() is main_thread()


def _begin() -> None:
    _noted.came, _noted.raised = 0, False


def _note(_number: int, _frame: FrameType | None) -> None:
    _noted.came += 1
    if _noted.came >= _MOST and not _noted.ends_process:
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
    until = perf_counter() + _noted.patience
    while not _noted.raised:
        if perf_counter() >= until:
            _end()
        sleep(_LOOK)


def _end() -> None:
    """End this process, whatever its other threads do."""
    # whoever reads what it has said may have stopped to
    flush = Thread(target=sys.stdout.flush, daemon=True)
    flush.start()
    flush.join(1.0)
    with suppress(OSError):
        if os.isatty(1):
            os.write(1, _CLEARED)
        if may_tell():
            os.write(2, f"isopeel: {_noted.message}\n".encode(errors="backslashreplace"))
        else:
            sleep(_TO_TELL)
    for how in reversed(_noted.left_over):
        with suppress(OSError):
            how()
    os._exit(INTERRUPTED)
