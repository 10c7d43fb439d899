"""A run as one JSON object: how it ended, the readings and notes of its stages, and their files."""

import json
from pathlib import Path
from typing import Any

from isopeel.running.folder import FILES, run_files
from isopeel.running.run import Result


def run_object(result: Result, folder: Path) -> dict[str, Any]:
    """Return the object of a run whose files are in a folder.

    Readings, notes and failures are those of `summary.json`; a stage that was interrupted may have no
    summary, and then has none of them. Raises OSError where a file cannot be read.
    """
    return {
        "ending": result.run.ending,
        "folder": str(folder),
        "stages": [_stage(path.parent) for path in run_files(folder) if _is_up_to(path, result.folder)],
    }


def _is_up_to(path: Path, last: Path) -> bool:
    """Return whether a stage is not after the last one, whose files may be those of an earlier run."""
    number = path.parent.name.partition("-")[0]
    newest = last.name.partition("-")[0]
    return path.parent == last or (number.isdigit() and newest.isdigit() and int(number) <= int(newest))


def _stage(folder: Path) -> dict[str, Any]:
    file = folder / "summary.json"
    summary = json.loads(file.read_text("utf-8")) if file.exists() else {}
    return {
        "stage": summary.get("case"),
        "completed": summary.get("completed", False),
        "failure": summary.get("failure"),
        "readings": summary.get("readings", []),
        "notes": summary.get("notes", []),
        "files": [str(folder / name) for name in FILES if (folder / name).exists()],
    }
