"""Read the reactions on a finer mesh from a stored summary, so that they are not computed again."""

import json
from math import isfinite
from pathlib import Path

from isopeel.common.errors import InputError
from isopeel.post.mesh_error import MeshChange
from isopeel.results.files import check_readable
from isopeel.results.run_file import StoredRun

#: Most bytes of a summary that is read: one with a long list of jumps has a tenth of them.
_LARGEST_SUMMARY = 10_000_000


def stored_changes(summary: Path, run: StoredRun) -> list[MeshChange] | None:
    """Return the reactions on a finer space in the summary of this very run; None where it has none.

    The file is not trusted: it must have the form that `summarize` writes.
    """
    parameter, reaction = run.curve.parameter_column.name, run.curve.reaction_column.name
    try:
        check_readable(summary)
        if run.ending == "interrupted" or summary.stat().st_size > _LARGEST_SUMMARY:
            return None
        summary_values = json.loads(summary.read_text("utf-8"))
        if summary_values["run"] != run.identity:
            return None
        changes = [
            MeshChange(one[parameter], one[reaction], one["on_finer_mesh"])
            for one in summary_values["finer_mesh"]
        ]
    except (OSError, InputError, ValueError, LookupError, TypeError, RecursionError):
        return None
    known = [value for change in changes for value in change if value is not None]
    of_stored = all(
        change.parameter in run.curve.parameter and change.reaction is not None for change in changes
    )
    numbers = all(isinstance(value, int | float) and isfinite(value) for value in known)
    return changes if numbers and of_stored else None
