"""The folder of a run: what lies where, and that one process alone writes to it."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile
from typing import NamedTuple

from filelock import FileLock, Timeout

from isopeel.errors import InputError
from isopeel.results.journal import journal_path

#: Files that a run leaves in its folder.
FILES = ("run.h5", "curve.csv", "summary.json", "curve.png", "shapes.png")
#: What `isopeel report` makes of them.
REPORT = "report.html"

#: Folder inside that of a run for what is drawn from it later, and the names of that, whatever the format.
FIGURES, DRAWN = "figures", ("curve", "plateau", "shapes", "front", "tractions", "animation")


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
    numbered = {path: re.match(r"\d{1,9}(?=-)", path.parent.name) for path in out.glob(f"*-*/{FILES[0]}")}
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


def make_folder(out: Path) -> None:
    """Make a folder. Raises InputError where no file could be written to it."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=out).close()
    except OSError as error:
        allowed = f"a folder that can be written is needed: {error.strerror}"
        raise InputError("--out", str(out), allowed) from error


def check_folder(out: Path) -> None:
    """Make the folder of a run. Raises InputError where it, or a file in it, could not be written."""
    make_folder(out)
    for name in FILES:
        if (out / name).exists() and not (out / name).is_file():
            raise InputError("--out", str(out), f"{name} in it must be a file, where there is one")


@contextmanager
def alone_in(folder: Path, field: str) -> Iterator[None]:
    """Keep other processes out of a folder while the context is open.

    Raises InputError, of a field, where another process is in it.
    """
    path = folder / ".lock"
    lock = FileLock(path)
    try:
        lock.acquire(blocking=False)
    except Timeout as error:
        raise InputError(field, str(folder), "another process runs in it; wait for it, or end it") from error
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        lock.release()
