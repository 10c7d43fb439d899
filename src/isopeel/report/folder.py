"""Check the folder of a report before the report is written, so that no file of a user is lost."""

from collections.abc import Callable, Iterator
from pathlib import Path

from isopeel.common.errors import InputError
from isopeel.results.files import is_written_by_isopeel, kind_of
from isopeel.running.folder import first_names, is_leftover, make_folder

#: The files of a report, and its folders: of pictures, of tables, and of its runs.
PAGES, PICTURES, TABLES, RUNS = ("report.md", "report.html", "records.h5"), "figures", "tables", "runs"
#: Kinds of files of tables.
_OF_TABLES = (".csv", ".parquet", ".h5", ".toml")
#: The text in each report that has a section with a command.
_MARK = "This section is made by\n\n```sh\nisopeel "


def take_folder(out: Path, part: str, is_part: Callable[[str], bool], *, force: bool = False) -> Path:
    """Make the folder of a report, or of the report on a `part` inside it, and return it.

    A report on a part has its own folder inside, whose name `is_part` accepts. Raises InputError for --out if
    the folder cannot be written, or, without `force`, if it contains files that are not of a report.
    """
    make_folder(out)
    others = sorted(str(path.relative_to(out)) for path in _foreign(out, is_part))
    if others and not force:
        what = "which is not of a report" if len(others) == 1 else "which are not of a report"
        allowed = (
            f"it contains {first_names(others)}, {what}; give another folder, or --force, which replaces only"
            " the files of a report in it"
        )
        raise InputError("--out", str(out), allowed)
    make_folder(out / part)
    return out / part


def replaced(folder: Path) -> str:
    """Return the message that the report in a folder is replaced; empty where there is none."""
    return f"replaces the report in {folder}" if (folder / PAGES[0]).exists() else ""


def _foreign(folder: Path, is_part: Callable[[str], bool]) -> Iterator[Path]:
    """Yield the files in the folder of a report that are not of a report; links are not followed."""
    report = _text(folder / PAGES[0])
    for path in folder.iterdir():
        is_folder = kind_of(path.lstat().st_mode) == "a folder"
        if is_leftover(path):
            continue
        if is_folder and path.name == PICTURES:
            # also pictures of old reports, which had no mark
            yield from _others(
                path,
                lambda file: f"({file.parent.name}/{file.stem}.png)" in report or is_written_by_isopeel(file),
            )
        elif is_folder and path.name == TABLES:
            yield from _others(path, lambda file: bool(report) and file.suffix in _OF_TABLES)
        elif is_folder and path.name == RUNS:
            yield from _others(path, is_written_by_isopeel)
        elif is_folder and is_part(path.name):
            yield from _foreign(path, lambda _: False)
        elif path.name not in PAGES or not (report if path.name == PAGES[0] else is_written_by_isopeel(path)):
            yield path


def _others(folder: Path, is_known: Callable[[Path], bool]) -> Iterator[Path]:
    for path in folder.iterdir():
        if not (is_leftover(path) or (not kind_of(path.lstat().st_mode) and is_known(path))):
            yield path


def _text(page: Path) -> str:
    """Return the text of a report; empty where the page is not a file."""
    try:
        text = "" if kind_of(page.lstat().st_mode) else page.read_text("utf-8")
    except (OSError, UnicodeDecodeError):
        return ""
    return text if _MARK in text else ""
