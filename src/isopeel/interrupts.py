"""Ctrl-C: once, and not in the middle of what must be whole."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType, TracebackType
from typing import Self


class Interrupts:
    """While the context is open, the first Ctrl-C raises KeyboardInterrupt, and others are ignored.

    What follows the first one takes a moment only. Where Ctrl-C does something else already, or nothing, that
    stays so.
    """

    def __init__(self) -> None:
        #: Whether one has come; where it was raised, something may have caught it, as a compiler does.
        self.came: bool = False
        self._held = False
        self._installed = False

    def __enter__(self) -> Self:
        """Watch for Ctrl-C."""
        usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if usual and current_thread() is main_thread():
            signal.signal(signal.SIGINT, self._take)
            self._installed = True
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Leave Ctrl-C as it was."""
        if self._installed:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    @contextmanager
    def held(self) -> Iterator[None]:
        """Let what is inside come to its end before KeyboardInterrupt is raised."""
        self._held = True
        try:
            yield
        finally:
            self._held = False
        if self.came:
            raise KeyboardInterrupt

    def _take(self, _number: int, _frame: FrameType | None) -> None:
        first, self.came = not self.came, True
        if first and not self._held:
            raise KeyboardInterrupt
