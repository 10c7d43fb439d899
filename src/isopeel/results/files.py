"""Writing a file as a whole, and telling files that isopeel wrote from others."""

import errno
import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from isopeel.common.interrupts import cleared_up

#: Bytes at either end of a file in which its mark stands; an mp4 has its comment at the end.
_ENDS = 1 << 16
#: More than any summary has.
_LARGEST_SUMMARY = 10_000_000
#: Who made a file, in words that its kind has a place for.
MAKER = "isopeel"
#: What files of a kind hold that isopeel wrote, as it writes it.
_MARKS = {
    ".png": (b"Creator\0isopeel",),
    ".svg": (b"<dc:title>isopeel</dc:title>",),
    ".pdf": (b"/Creator (isopeel)",),
    ".gif": (b"isopeel",),
    ".mp4": (b"isopeel",),
    ".html": (b'<meta name="generator" content="isopeel',),
    ".vtu": (b"<!-- isopeel -->",),
    ".pvd": (b"<!-- isopeel -->",),
    ".csv": (b"iterations", b"kind"),
    ".h5": (b"\x89HDF\r\n", b"isopeel "),
    ".journal": (b"isopeel journal",),
}


@contextmanager
def replacing(path: Path, *, durable: bool = False) -> Iterator[Path]:
    """Give another name to write a file under; it takes the place of the old file when it is whole.

    Whatever ends the process, the file has its old content or its new one; where it is `durable`, also what
    ends the machine: the content is on the disk before the file takes its name. The file of the other name
    is made here: a link that somebody has put in its place is removed, and never written through. Raises
    OSError, which names the file, also where the path is a link, or no file.
    """
    part = part_of(path)
    try:
        check_is_file(path)
        part.unlink(missing_ok=True)
        with cleared_up(lambda: part.unlink(missing_ok=True)):
            os.close(new_file(part))
            yield part
            if durable:
                _to_disk(part)
            part.replace(path)
            if durable:
                _to_disk(path.parent)
    except OSError as error:
        # a disk that is full does not say where, and the other name means nothing to a user
        if error.errno is not None and error.filename in (None, str(part), part):
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from error
        raise


def part_of(path: Path) -> Path:
    """The name that a file is written under; its suffix tells the format of a figure."""
    return path.with_name(f".{path.stem}.part{path.suffix}")


def new_file(path: Path) -> int:
    """Make a file where there is nothing, not even a link, and open it for writing. Raises OSError."""
    return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0), 0o666)


def check_is_file(path: Path) -> None:
    """Raise OSError where something else than a file has a name: a link, a folder, a pipe or a device."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    kind = kind_of(mode)
    if kind:
        raise OSError(errno.EEXIST, f"it is {kind}, and no file", str(path))


def check_readable(path: Path) -> None:
    """Raise OSError where a path leads to no file, as to a pipe, which would be waited for, or to nothing."""
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    try:
        kind = kind_of(os.fstat(number).st_mode)
    finally:
        os.close(number)
    if kind:
        raise OSError(errno.EINVAL, f"it is {kind}, and no file", str(path))


def kind_of(mode: int) -> str:
    """What something is by its mode, if it is no file."""
    kinds = {
        stat.S_ISLNK: "a symbolic link",
        stat.S_ISDIR: "a folder",
        stat.S_ISFIFO: "a pipe",
        stat.S_ISCHR: "a device",
        stat.S_ISBLK: "a device",
        stat.S_ISSOCK: "a socket",
    }
    return next((kind for test, kind in kinds.items() if test(mode)), "")


def is_written_by_isopeel(path: Path) -> bool:
    """Whether a file holds the mark of those that isopeel writes of its kind; nothing is followed."""
    try:
        if kind_of(path.lstat().st_mode):
            return False
        size = path.stat().st_size
        if path.suffix == ".json":
            return size < _LARGEST_SUMMARY and _is_summary(path.read_bytes())
        with path.open("rb") as file:
            ends = file.read(_ENDS)
            if size > len(ends):
                file.seek(max(size - _ENDS, len(ends)))
                ends += file.read(_ENDS)
    except OSError:
        return False
    marks = _MARKS.get(path.suffix.lower(), ())
    return bool(marks) and all(mark in ends for mark in marks)


def _is_summary(text: bytes) -> bool:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return False
    return isinstance(found, dict) and {"case", "space", "mesh"} <= set(found)


def _to_disk(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk."""
    if path.is_dir() and os.name == "nt":
        return  # which does not open folders
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
