"""The folder of a run: the names of its files, and what may be written there."""

import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryFile
from typing import NamedTuple

from isopeel.common.errors import InputError
from isopeel.results.files import is_written_by_isopeel, kind_of, part_of
from isopeel.results.journal import journal_path

#: Files that a run leaves in its folder.
FILES = ("run.h5", "curve.csv", "summary.json", "curve.png", "shapes.png")
#: The file of a finished run, kept until the run that replaces it has finished too.
EARLIER = "run.earlier.h5"
#: The page that `isopeel report` writes.
REPORT = "report.html"

#: Folder inside that of a run for later figures, and the names of these, in any format.
FIGURES, DRAWN = "figures", ("curve", "plateau", "shapes", "front", "tractions", "animation", "sensitivities")
#: Folder inside that of a run for exported files, and the names of these.
PARAVIEW, EXPORTED = "paraview", re.compile(r"(body|adhesive-side)((-[\w.-]+)?-\d{4,}\.vtu|\.pvd)")
#: The file that a process locks while it writes to a folder, and the beginning of the names of stage folders.
LOCK, STAGE_FOLDER = ".lock", re.compile(r"\d{1,9}(?=-)")
#: Files that file managers leave everywhere, and temporary files of a killed process.
_OF_FILE_MANAGERS = (".DS_Store", "Thumbs.db", "desktop.ini")
_PART = re.compile(r"\.[^.].*\.part\.[a-z0-9]+")
_MOST_NAMES = 3  # in one line


class Place(NamedTuple):
    """The folder of a stage's files, its title, and the files that it makes outdated."""

    folder: Path
    title: str
    outdated: list[Path]

    @property
    def run_file(self) -> Path:
        """The file of the run."""
        return self.folder / FILES[0]


def places(name: str, stages: Sequence[str], out: Path) -> list[Place]:
    """Return the places of a case's stages: `out` itself for a single one, folders inside for several."""
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
            # files of later stages and of runs with other stages
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
    """Return the figures drawn from the run in a folder."""
    return [path for path in (folder / FIGURES).glob("*.*") if path.stem in DRAWN]


def stage_files(out: Path) -> list[Path]:
    """Return the files of runs in the folders of stages, in the order of the stages."""
    numbered = {path: STAGE_FOLDER.match(path.parent.name) for path in out.glob(f"*-*/{FILES[0]}")}
    return [path for _, path in sorted((int(number[0]), path) for path, number in numbered.items() if number)]


def run_files(folder: Path) -> list[Path]:
    """Return the files of the runs in a folder: a single one, or those of the stages so far.

    Raises InputError where there is none.
    """
    if not folder.is_dir():
        raise InputError("DIR", str(folder), "the folder of a run is needed, but it is not a folder")
    files = [folder / FILES[0]] if (folder / FILES[0]).exists() else stage_files(folder)
    if not files:
        allowed = f"the folder of a run is needed, but there is no {FILES[0]} in it"
        raise InputError("DIR", str(folder), allowed)
    return files


def part_of_name(name: str, names: Sequence[str]) -> str:
    """Return the name of a body or an interface as a part of a file's name, unlike that of all others."""

    def plain(text: str) -> str:
        return re.sub(r"[^\w.-]+", "-", text)

    same = [other for other in names if plain(other) == plain(name)]
    return plain(name) if len(same) == 1 else f"{plain(name)}-{same.index(name) + 1}"


def make_folder(out: Path, field: str = "--out") -> None:
    """Make a folder. Raises InputError for a field where no file could be written to it."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=out).close()
    except OSError as error:
        allowed = f"a folder that can be written is needed: {_obstacle(out) or error.strerror}"
        raise InputError(field, str(out), allowed) from error


def _obstacle(folder: Path) -> str:
    """Return what is where a folder, or one above it, should be, and is not one; else an empty string."""
    for path in (*reversed(folder.parents), folder):
        if os.path.lexists(path) and not path.is_dir():
            if path.is_symlink():
                return f"{path} is a link to {path.readlink()}, where there is no folder"
            return f"{path} is not a folder"
    return ""


def check_folder(out: Path) -> None:
    """Make the folder of a run. Raises InputError where it, or a file in it, could not be written.

    A link in place of a file is refused: its target is not a file of the run.
    """
    make_folder(out)
    for name in (*FILES, journal_path(out / FILES[0]).name, LOCK):
        check_is_no_other("--out", out, out / name)


def clear_parts(out: Path) -> None:
    """Remove the temporary files that a killed process left in the folder of a run."""
    for name in FILES:
        part_of(out / name).unlink(missing_ok=True)


def check_overwritten(
    field: str, files: Iterable[Path], force: bool = False, remedy: str = "give another place, or --force"
) -> None:
    """Raise InputError where one of the files to write exists and was not written by isopeel.

    A table (.csv, .md) counts as isopeel's where a page or a figure beside it does. With `force` only paths
    that are not files are refused. `remedy` is what a user can do.
    """
    others = []
    for path in files:
        try:
            kind = kind_of(path.lstat().st_mode)
        except OSError:
            continue  # it does not exist, or writing it raises the error
        if kind:
            raise InputError(field, str(path), f"it is {kind}, which is never replaced")
        if not force and not _is_ours(path):
            others.append(str(path))
    if others:
        allowed = f"isopeel did not write {first_names(others)}; {remedy}"
        raise InputError(field, others[0], allowed)


def _is_ours(path: Path) -> bool:
    if is_written_by_isopeel(path):
        return True
    if path.suffix not in (".csv", ".md"):
        return False
    beside = path.parent.parent if path.parent.name == "tables" else path.parent
    anchors = [beside / REPORT, *beside.glob("compare.[!c]*"), *beside.glob(f"{FIGURES}/*.*")]
    return any(is_written_by_isopeel(anchor) for anchor in anchors)


def is_leftover(path: Path) -> bool:
    """Return whether a file in the folder of a run may be there, whoever left it, and may be removed."""
    if path.name == LOCK:
        return not path.lstat().st_size
    return path.name in _OF_FILE_MANAGERS or _PART.fullmatch(path.name) is not None


def first_names(names: Sequence[str]) -> str:
    """Return the first of some names, and the number of the others, as words."""
    listed = ", ".join(names[:_MOST_NAMES])
    return listed + (f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else "")


def check_is_no_other(field: str, folder: Path, path: Path) -> None:
    """Raise InputError where a path in a folder exists and is not a file."""
    try:
        kind = kind_of(path.lstat().st_mode)
    except FileNotFoundError:
        return
    if kind:
        raise InputError(field, str(folder), f"{path.name} in it must be a file, but it is {kind}")
