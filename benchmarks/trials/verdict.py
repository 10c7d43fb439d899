"""The verdict on a run: whether a user, who does not know the answer, can rely on it."""

from collections.abc import Sequence
from enum import Enum
from math import isfinite

from trials.case import Trial
from trials.running import Outcome

#: Deviation up to which a value is right, and up to which no warning is needed; closed forms hold within 1 %.
RIGHT, CLOSE = 0.03, 0.01


class Verdict(Enum):
    """The classes of trials."""

    RIGHT = "right"
    WARNED_CLOSE = "right within 1 %, but warned"
    WARNED = "right within 3 %, but warned"
    NOTED = "wrong, and noted"
    FAILED = "no value, with a cause"
    SLOW = "too slow"
    CRASHED = "crashed"
    SILENT = "wrong, and silent"


def deviation(trial: Trial, outcome: Outcome) -> float:
    """Return the relative deviation of the value from the answer."""
    return outcome.value / trial.drawn.answer.value - 1


def verdict(trial: Trial, outcome: Outcome) -> Verdict:
    """Return the verdict on a run; a complete run without a value and without a note is silent."""
    if outcome.ending in ("refused", "not converged"):
        return Verdict.FAILED
    if outcome.ending != "completed":
        return Verdict.SLOW if outcome.ending == "too slow" else Verdict.CRASHED
    off = abs(deviation(trial, outcome))
    if not isfinite(off) or off > RIGHT:
        return Verdict.NOTED if outcome.notes else Verdict.SILENT
    # if the answer is the load at which stability is lost, the note on the bifurcation is expected
    buckles = trial.drawn.answer.reading == "buckling"
    if all(buckles and note.startswith("stability") for note in outcome.notes):
        return Verdict.RIGHT
    return Verdict.WARNED_CLOSE if off <= CLOSE else Verdict.WARNED


def warned_by_default(found: Sequence[tuple[Trial, Outcome]], *, any_space: bool = True) -> tuple[int, int]:
    """Return how many cases on the default mesh have a note or failed, and the number of these cases.

    With `any_space`, or with the default space only.
    """
    default = [
        outcome for trial, outcome in found if trial.default_mesh and (any_space or trial.default_space)
    ]
    return sum(bool(outcome.notes) or outcome.ending != "completed" for outcome in default), len(default)
