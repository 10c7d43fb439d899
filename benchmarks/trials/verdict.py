"""What a run is worth to one who does not know the answer."""

from collections.abc import Sequence
from enum import Enum
from math import isfinite

from trials.case import Trial
from trials.running import Outcome

#: Within which a value is right, and within which no warning was needed; closed forms hold within 1 %.
RIGHT, CLOSE = 0.03, 0.01


class Verdict(Enum):
    """The classes that trials are counted in."""

    RIGHT = "right"
    WARNED_CLOSE = "right within 1 %, but warned"
    WARNED = "right within 3 %, but warned"
    NOTED = "wrong, and noted"
    FAILED = "no value, with a cause"
    SLOW = "too slow"
    CRASHED = "crashed"
    SILENT = "wrong, and silent"


def deviation(trial: Trial, outcome: Outcome) -> float:
    """Relative deviation of the value from the answer."""
    return outcome.value / trial.drawn.answer.value - 1


def verdict(trial: Trial, outcome: Outcome) -> Verdict:
    """Judge a run; one that came to its end without a value and without a doubt is silent."""
    if outcome.ending in ("refused", "not converged"):
        return Verdict.FAILED
    if outcome.ending != "completed":
        return Verdict.SLOW if outcome.ending == "too slow" else Verdict.CRASHED
    off = abs(deviation(trial, outcome))
    if not isfinite(off) or off > RIGHT:
        return Verdict.NOTED if outcome.doubts else Verdict.SILENT
    # where the answer is the load at which stability is lost, the note that says so is no doubt
    buckles = trial.drawn.answer.reading == "buckling"
    if all(buckles and doubt.startswith("stability") for doubt in outcome.doubts):
        return Verdict.RIGHT
    return Verdict.WARNED_CLOSE if off <= CLOSE else Verdict.WARNED


def warned_by_default(found: Sequence[tuple[Trial, Outcome]], *, any_space: bool = True) -> tuple[int, int]:
    """Of the cases on the default mesh how many have a doubt, or failed, and how many there are.

    Of `any_space`, or of the default one only.
    """
    default = [
        outcome for trial, outcome in found if trial.default_mesh and (any_space or trial.default_space)
    ]
    return sum(bool(outcome.doubts) or outcome.ending != "completed" for outcome in default), len(default)
