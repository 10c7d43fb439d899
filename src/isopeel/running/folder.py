"""The folder of a run: what lies where, and that one process alone writes to it."""

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile
from typing import NamedTuple

from filelock import FileLock, Timeout

from isopeel.common.errors import InputError
from isopeel.results.files import is_written_by_isopeel, kind_of, part_of
from isopeel.results.journal import journal_path

try:
    import fcntl
except ImportError:  # on Windows, where stages are locked by the lock of their run alone
    fcntl = None  # type: ignore[assignment]

#: Files that a run leaves in its folder.
FILES = ("run.h5", "curve.csv", "summary.json", "curve.png", "shapes.png")
#: The file of a finished run, until the one that replaces it has finished too.
EARLIER = "run.earlier.h5"
#: What `isopeel report` makes of them.
REPORT = "report.html"

#: Folder inside that of a run for what is drawn from it later, and the names of that, whatever the format.
FIGURES, DRAWN = "figures", ("curve", "plateau", "shapes", "front", "tractions", "animation")
#: Folder inside that of a run for what is exported from it, and the names of that.
PARAVIEW, EXPORTED = "paraview", re.compile(r"(body|adhesive-side)(-\d{4,}\.vtu|\.pvd)")
#: The file that a process holds while it writes to a folder, and what the names of stage folders begin with.
LOCK, STAGE_FOLDER = ".lock", re.compile(r"\d{1,9}(?=-)")
#: What file managers leave everywhere, and what was being written when its process was killed.
_OF_NOBODY = (".DS_Store", "Thumbs.db", "desktop.ini")
_PART = re.compile(r"\.[^.].*\.part\.[a-z0-9]+")
_MOST_NAMES = 3  # in one line
# a pipe in place of a file would wait for who writes to it
_NO_LINK = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


class Place(NamedTuple):
    """Where the files of a stage go, what it is called, and which files it makes outdated."""

    folder: Path
    title: str
    outdated: list[Path]

    @property
    def run_file(self) -> Path:
        """The file of the run."""
        return self.folder / FILES[0]


def places(name: str, stages: Sequence[str], out: Path) -> list[Place]:
    """The places of the stages of a case: `out` itself for the only one, folders inside for several."""
    folders = [out]
    titles = [name]
    if len(stages) > 1:
        folders = [out / f"{number}-{stage}" for number, stage in enumerate(stages, start=1)]
        titles = [f"{name}, stage {number}: {stage}" for number, stage in enumerate(stages, start=1)]
    earlier = {*(path.parent for path in stage_files(out)), out, *folders}
    kept = (*FILES, journal_path(out / FILES[0]).name, REPORT)
    return [
        Place(
            folder,
            title,
            # what later stages and runs with other stages have left
            [
                file
                for path in earlier - set(folders[: number + 1])
                for file in (*(path / name for name in kept), *_drawn(path))
            ]
            + [*(folder / file for file in (*FILES[1:], REPORT)), *_drawn(folder)],
        )
        for number, (folder, title) in enumerate(zip(folders, titles, strict=True))
    ]


def _drawn(folder: Path) -> list[Path]:
    """What has been drawn from the run in a folder."""
    return [path for path in (folder / FIGURES).glob("*.*") if path.stem in DRAWN]


def stage_files(out: Path) -> list[Path]:
    """The files of runs that lie in folders of stages, in the order of these."""
    numbered = {path: STAGE_FOLDER.match(path.parent.name) for path in out.glob(f"*-*/{FILES[0]}")}
    return [path for _, path in sorted((int(number[0]), path) for path, number in numbered.items() if number)]


def run_files(folder: Path) -> list[Path]:
    """The files of the runs in a folder: its only one, or those of the stages so far.

    Raises InputError where there is none.
    """
    if not folder.is_dir():
        raise InputError("DIR", str(folder), "the folder of a run is needed, and it is no folder")
    files = [folder / FILES[0]] if (folder / FILES[0]).exists() else stage_files(folder)
    if not files:
        allowed = f"the folder of a run is needed, and there is no {FILES[0]} in it"
        raise InputError("DIR", str(folder), allowed)
    return files


def make_folder(out: Path, field: str = "--out") -> None:
    """Make a folder. Raises InputError, of a field, where no file could be written to it."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=out).close()
    except OSError as error:
        allowed = f"a folder that can be written is needed: {_in_the_way(out) or error.strerror}"
        raise InputError(field, str(out), allowed) from error


def _in_the_way(folder: Path) -> str:
    """What has the name of a folder, or of one that it lies in, and is none; else nothing."""
    for path in (*reversed(folder.parents), folder):
        if os.path.lexists(path) and not path.is_dir():
            if path.is_symlink():
                return f"{path} is a link to {path.readlink()}, where there is no folder"
            return f"{path} is no folder"
    return ""


def check_folder(out: Path) -> None:
    """Make the folder of a run. Raises InputError where it, or a file in it, could not be written.

    A link in place of a file is refused: what it leads to is not of the run.
    """
    make_folder(out)
    for name in (*FILES, journal_path(out / FILES[0]).name, LOCK):
        _check_kind("--out", out, out / name)


def clear_parts(out: Path) -> None:
    """Remove what was being written in the folder of a run when its process was killed."""
    for name in FILES:
        part_of(out / name).unlink(missing_ok=True)


def check_overwritten(
    field: str, files: Iterable[Path], force: bool = False, way: str = "give another place, or --force"
) -> None:
    """Raise InputError where one of the files to write is there already, and isopeel did not write it.

    A table (.csv, .md) is taken for isopeel's where a page or a figure beside it is. With `force` only what
    is no file is refused. `way` says what a user can do.
    """
    others = []
    for path in files:
        try:
            kind = kind_of(path.lstat().st_mode)
        except OSError:
            continue  # there is none, or whoever writes it will tell
        if kind:
            raise InputError(field, str(path), f"it is {kind}, and no file that could be replaced")
        if not force and not _is_ours(path):
            others.append(str(path))
    if others:
        allowed = f"isopeel did not write {first_names(others)}; {way}"
        raise InputError(field, others[0], allowed)


def _is_ours(path: Path) -> bool:
    if is_written_by_isopeel(path):
        return True
    if path.suffix not in (".csv", ".md"):
        return False
    beside = path.parent.parent if path.parent.name == "tables" else path.parent
    anchors = [beside / REPORT, *beside.glob("compare.[!c]*"), *beside.glob(f"{FIGURES}/*.*")]
    return any(is_written_by_isopeel(anchor) for anchor in anchors)


def is_of_nobody(path: Path) -> bool:
    """Whether something in the folder of a run may be there, whoever left it, and may go."""
    if path.name == LOCK:
        return not path.lstat().st_size
    return path.name in _OF_NOBODY or _PART.fullmatch(path.name) is not None


def first_names(names: Sequence[str]) -> str:
    """The first of some names, and how many there are more."""
    listed = ", ".join(names[:_MOST_NAMES])
    return listed + (f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else "")


def _check_kind(field: str, folder: Path, path: Path) -> None:
    """Raise InputError where something else than a file has the name of one in a folder."""
    try:
        kind = kind_of(path.lstat().st_mode)
    except FileNotFoundError:
        return
    if kind:
        raise InputError(field, str(folder), f"{path.name} in it must be a file, and it is {kind}")


@contextmanager
def alone_in(folder: Path, field: str) -> Iterator[None]:
    """Keep other processes out of a folder, and of the folders of its stages, while the context is open.

    Raises InputError, of a field, where another process is in it, in a folder that it lies in, or in that of
    a stage. Each process takes its own lock first and then looks for others: of two that begin at once, one
    at least sees the other.
    """
    path = folder / LOCK
    _check_kind(field, folder, path)
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
    """Whether a process holds a lock, where there is one; its file is not touched."""
    try:
        number = os.open(path, os.O_RDWR | _NO_LINK)
    except OSError:
        return False  # there is none, or it is nobody's whose files could be read
    try:
        if fcntl is not None:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False  # where the file system has no locks, that of the folder itself is all there is
    finally:
        os.close(number)
    return False
