"""Check the folder of a run before it begins, so that no file of a user and no longer run is lost."""

import os
import shutil
import tomllib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from shlex import quote
from typing import Any, NamedTuple

import numpy as np

from isopeel.case import Case, Stage
from isopeel.case.load import LARGEST_FILE
from isopeel.common.errors import InputError
from isopeel.post.laboratory import short_unit
from isopeel.problem import Column
from isopeel.results.files import is_written_by_isopeel, kind_of
from isopeel.results.journal import journal_path
from isopeel.results.run_file import StoredRun, read_run
from isopeel.running.folder import (
    DRAWN,
    EARLIER,
    EXPORTED,
    FIGURES,
    FILES,
    PARAVIEW,
    REPORT,
    STAGE_FOLDER,
    first_names,
    is_leftover,
    stage_files,
)
from isopeel.solve.step import KINDS

#: Two ends are the same where they differ by less than this share of the parameter.
_SAME = 1e-9
_ANOTHER = "give another folder, or --force"
#: Tables of a case file that define the problem; the others define the computation and its end.
_PHYSICS = ("units", "body", "material", "adhesion", "substrate", "held", "interface", "support", "load")
#: Keys in them that do not: options of the command line change them, or they belong to the space.
_OTHERS = ("traction", "space", "mesh", "across_degree", "grading")


class _Length(NamedTuple):
    """The length of a run: number of requested values, and the last one, in the unit of its column."""

    column: Column
    steps: int
    end: float | None

    @property
    def words(self) -> str:
        end = "" if self.end is None else f", to {self.end:g} {short_unit(self.column)}"
        return f"{self.steps} {'step' if self.steps == 1 else 'steps'}{end}"


def check_foreign(out: Path) -> None:
    """Raise InputError where a folder holds files that are not of a run, or a link in place of a folder."""
    if not out.is_dir():
        return
    others = sorted(str(path.relative_to(out)) for path in _foreign(out, stages_too=True))
    if others:
        what = "which is not part of a run" if len(others) == 1 else "which are not part of a run"
        allowed = (
            f"it contains {first_names(others)}, {what}; {_ANOTHER}, which replaces the files of a run in it,"
            " and leaves all others"
        )
        raise InputError("--out", str(out), allowed)


def check_previous(case: Case, stages: Sequence[Stage], out: Path) -> str:
    """Return a message on the run of a case that is replaced in a folder; empty where there is none.

    Raises InputError where the run would be lost: it is of another case, cannot be read, is longer than the
    `stages` of the new one, or was interrupted.
    """
    name, own = case.name, _document(case.text)
    files = [path for path in (out / FILES[0], *stage_files(out)) if path.exists()]
    runs = []
    for file in files:
        try:
            runs.append(read_run(file))
        except InputError as error:
            allowed = f"{file.name} in it is not a run that this version can read; {_ANOTHER}"
            raise InputError("--out", str(file.parent), allowed) from error
        document = _document(runs[-1].case_text)
        other = document.get("name")
        if other != name:
            whose = (
                f"a run of the case {other!r}" if isinstance(other, str) else "a run of a case without a name"
            )
            raise InputError("--out", str(out), f"it contains {whose}; {_ANOTHER}, which replaces it")
        differing = [f"[{table}]" for table in _PHYSICS if _table(document, table) != _table(own, table)]
        if differing:
            whose = f"a run of another case {name!r}, with other values in {', '.join(differing)}"
            raise InputError("--out", str(out), f"it contains {whose}; {_ANOTHER}, which replaces it")
    if not any(len(run.curve) for run in runs):
        return ""
    there = [_reached(run) for run in runs]
    lengths = "; then ".join(length.words for length in there)
    if runs[-1].ending in ("running", "interrupted"):
        allowed = (
            f"it contains an interrupted run of {name!r}: {lengths}; `isopeel resume {quote(str(out))}`"
            " continues it, and --force starts a new run"
        )
        raise InputError("--out", str(out), allowed)
    new = [_planned(stage) for stage in stages]
    if _is_shorter(new, there):
        shorter = "; then ".join(length.words for length in new)
        allowed = f"it contains a longer run of {name!r}: {lengths}, and this one has {shorter}; {_ANOTHER}"
        raise InputError("--out", str(out), f"{allowed}, which replaces it")
    return f"replaces the run of {name} in {out}: {lengths}"


def keep_finished(out: Path) -> None:
    """Keep the files of a finished run in a folder under another name, beside those that replace them.

    Files that are kept already stay: the run in their place has not finished.
    """
    for file in (out / FILES[0], *stage_files(out)):
        aside = file.with_name(EARLIER)
        if aside.exists() or not _has_finished(file):
            continue
        try:
            os.link(file, aside)
        except OSError:  # a file system without links
            shutil.copy2(file, aside)


def _has_finished(file: Path) -> bool:
    try:
        return file.is_file() and read_run(file).ending == "completed"
    except InputError:  # with --force the file may be anything
        return False


def kept_runs(out: Path) -> list[Path]:
    """Return the files of a finished run that are kept in a folder."""
    return sorted(file for file in (out / EARLIER, *out.glob(f"*-*/{EARLIER}")) if file.is_file())


def remove_kept(out: Path, *, replaced: bool = True) -> None:
    """Remove the kept files in a folder that a finished run has replaced, or that were never replaced."""
    for file in kept_runs(out):
        run = file.with_name(FILES[0])
        if not replaced and not (run.exists() and run.samefile(file)):
            continue
        file.unlink()


def _foreign(folder: Path, *, stages_too: bool) -> Iterator[Path]:
    """Yield the files in the folder of a run, or of a stage, that are not of a run."""
    kept = {*FILES, journal_path(Path(FILES[0])).name, REPORT}
    has_run = (folder / FILES[0]).exists()
    for path in folder.iterdir():
        kind = kind_of(path.lstat().st_mode)
        if is_leftover(path):
            continue
        if kind == "a folder" and path.name == FIGURES:
            yield from _others(path, lambda name: name.partition(".")[0] in DRAWN)
        elif kind == "a folder" and path.name == PARAVIEW:
            yield from _others(path, lambda name: EXPORTED.fullmatch(name) is not None)
        elif kind == "a folder" and stages_too and STAGE_FOLDER.match(path.name):
            yield from _foreign(path, stages_too=False)
        elif path.name in (FILES[0], EARLIER) and not kind:
            pass  # a file of a run is read, or kept, before it is replaced
        elif kind or path.name not in kept or not (has_run or path.name == REPORT):
            yield path  # the page of a run of several stages lies in the folder above
        elif not is_written_by_isopeel(path):
            yield path


def _others(folder: Path, is_known: Callable[[str], bool]) -> Iterator[Path]:
    """Yield the files in a folder except those of known names that isopeel wrote."""
    for path in folder.iterdir():
        if not is_leftover(path) and not (is_known(path.name) and is_written_by_isopeel(path)):
            yield path


def _document(text: str) -> dict[str, Any]:
    """Return the tables of a case; empty where the text is not a case."""
    if len(text) > 2 * LARGEST_FILE:  # the stored text may be somewhat longer
        return {}
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError):
        return {}


def _table(document: dict[str, Any], name: str) -> Any:
    """Return a table, or a list of tables, without the keys that do not define the problem."""
    found = document.get(name) or {}
    if isinstance(found, list):
        return [_table({name: table}, name) for table in found]
    if not isinstance(found, dict):
        return found
    return {key: value for key, value in found.items() if key not in _OTHERS}


def _reached(run: StoredRun) -> _Length:
    curve = run.curve
    # a curve that turns back meets a parameter again
    requested = len(np.unique(curve.parameter[curve.kind == KINDS.index("requested")]))
    return _Length(curve.parameter_column, requested, float(curve.parameter[-1]) if len(curve) else None)


def _planned(stage: Stage) -> _Length:
    column = stage.problem.drive.parameter_column
    return _Length(column, len(stage.parameters), float(column.shown(stage.parameters[-1])))


def _is_shorter(new: Sequence[_Length], there: Sequence[_Length]) -> bool:
    """Return whether a run has fewer steps or stages than another one, or ends before it."""
    if len(new) < len(there) or sum(one.steps for one in new) < sum(other.steps for other in there):
        return True
    for one, other in zip(new, there, strict=False):
        if one.column != other.column or one.end is None or other.end is None:
            continue
        if abs(one.end) < abs(other.end) - _SAME * abs(other.end) or one.end * other.end < 0:
            return True
        if one.steps < other.steps:
            return True
    return False
