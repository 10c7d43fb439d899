"""The lock of a folder, by which only one process writes to it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from isopeel.common.errors import InputError
from isopeel.running.folder import LOCK, STAGE_FOLDER, check_is_no_other

try:
    import fcntl
except ImportError:  # on Windows, where stages are locked by the lock of their run alone
    fcntl = None  # type: ignore[assignment]

# a pipe in place of a file would block
_NO_LINK = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


@contextmanager
def alone_in(folder: Path, field: str) -> Iterator[None]:
    """Lock a folder, and the folders of its stages, against other processes while the context is open.

    Raises InputError for a field where another process runs in it, in a folder above it, or in that of a
    stage. Each process takes its own lock first and then looks for others: of two that begin at the same
    time, at least one sees the other.
    """
    path = folder / LOCK
    check_is_no_other(field, folder, path)
    lock = FileLock(path)
    try:
        lock.acquire(blocking=False)
    except Timeout as error:
        raise InputError(field, str(folder), "another process runs in it; wait for it, or end it") from error
    try:
        whole = folder.resolve()
        above = [whole.parent / LOCK] if STAGE_FOLDER.match(whole.name) else []
        below = [other for other in folder.glob(f"*-*/{LOCK}") if STAGE_FOLDER.match(other.parent.name)]
        for other in (*above, *below):
            if _is_locked(other):
                allowed = f"another process runs in {other.parent}; wait for it, or end it"
                raise InputError(field, str(folder), allowed)
        yield
    finally:
        path.unlink(missing_ok=True)
        lock.release()


def _is_locked(path: Path) -> bool:
    """Return whether another process holds a lock; its file is not changed."""
    try:
        number = os.open(path, os.O_RDWR | _NO_LINK)
    except OSError:
        return False  # there is no lock, or its file cannot be read
    try:
        if fcntl is not None:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False  # on a file system without locks, only the lock of the folder itself is checked
    finally:
        os.close(number)
    return False
