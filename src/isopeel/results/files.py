"""Write a file as a whole, and recognize the files that isopeel wrote."""

import errno
import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from isopeel.common.interrupts import cleared_up

#: Number of bytes at either end of a file in which its mark is searched; an mp4 has its comment at the end.
_ENDS = 1 << 16
#: Largest size of a summary.
_LARGEST_SUMMARY = 10_000_000
#: The maker of a file, for the kinds of file that have a place for it.
MAKER = "isopeel"
#: The mark in the files of a kind that isopeel writes.
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
    """Yield a temporary name to write a file under; the file replaces the old one when it is whole.

    If the process ends at any time, the file has its old content or its new content. With `durable` this is
    also true if the machine fails: the content is on the disk before the file gets its name. A link in place
    of the temporary file is removed; nothing is written to its target. Raises OSError, which names the file,
    also if the path is a link, or not a file.
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
        # the error of a full disk has no name, and the temporary name means nothing to a user
        if error.errno is not None and error.filename in (None, str(part), part):
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from error
        raise


def part_of(path: Path) -> Path:
    """Return the temporary name of a file; its suffix stays, as it selects the format of a figure."""
    return path.with_name(f".{path.stem}.part{path.suffix}")


def new_file(path: Path) -> int:
    """Make a new file, where not even a link exists, and open it for writing. Raises OSError."""
    return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0), 0o666)


def check_is_file(path: Path) -> None:
    """Raise OSError where a path exists and is not a file: a link, a folder, a pipe or a device."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    kind = kind_of(mode)
    if kind:
        raise OSError(errno.EEXIST, f"it is {kind}, and no file", str(path))


def check_readable(path: Path) -> None:
    """Raise OSError where a path is not a file, or does not exist; reading a pipe would wait for ever."""
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    try:
        kind = kind_of(os.fstat(number).st_mode)
    finally:
        os.close(number)
    if kind:
        raise OSError(errno.EINVAL, f"it is {kind}, and no file", str(path))


def kind_of(mode: int) -> str:
    """Return what a path with a mode is, in words, where it is not a file."""
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
    """Return whether a file has the mark of isopeel for its kind; links are not followed."""
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
    """Wait until a file, or the list of names of a folder, is on the disk."""
    if path.is_dir() and os.name == "nt":
        return  # Windows does not open folders
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
