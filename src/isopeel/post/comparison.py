"""Compare runs: the values read from each, and the differences of their curves."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.post.findings import Findings
from isopeel.post.plateau import onset_angle, plateau_mean, rising
from isopeel.results.curve import Curve
from isopeel.results.run_file import StoredRun

_SAME = 1e-9  # relative difference below which parameters are the same


@dataclass(frozen=True, eq=False)
class Compared:
    """A run with one step or more, its name, and its findings."""

    name: str
    run: StoredRun
    found: Findings


class Difference(NamedTuple):
    """Reaction of a run minus that of another one, at the parameters (n,) that both have."""

    parameter: FloatArray
    reaction: FloatArray


def difference(curve: Curve, first: Curve) -> Difference:
    """Return the difference of a curve and the first one; see `rising` for curves that turn back."""
    (at, values), (parameter, reaction) = rising(curve), rising(first)
    nearest = np.clip(np.searchsorted(parameter, at), 1, len(parameter) - 1) if len(parameter) > 1 else 0
    before = np.maximum(nearest - 1, 0)
    nearest = np.where(np.abs(parameter[before] - at) < np.abs(parameter[nearest] - at), before, nearest)
    same = np.abs(parameter[nearest] - at) <= _SAME * np.maximum(np.abs(at), np.ptp(parameter))
    return Difference(at[same], values[same] - reaction[nearest][same])


def comparison(runs: Sequence[Compared]) -> list[dict[str, Any]]:
    """Return a row for each run, by the names of columns; None where there is no such number.

    The reaction and its parameter are in the units of their columns, slopes per unit of the parameter. The
    plateau is that of the window of each run. The time of a step is the median of its run.
    """
    first = runs[0].run.curve
    rows = []
    for compared in runs:
        curve, window, plateau = compared.run.curve, compared.found.window, compared.found.plateau
        apart = difference(curve, first)
        largest = int(np.argmax(np.abs(apart.reaction))) if len(apart.parameter) else None
        rows.append(
            {
                "run": compared.name,
                **{name: compared.run.attributes[name] for name in ("space", "mesh", "dofs")},
                "steps": len(curve),
                "reached": float(curve.parameter[-1]),
                "plateau": window and plateau_mean(curve, window),
                "amplitude": plateau and plateau.amplitude,
                "steepest_rise": plateau and plateau.steepest_rise,
                "steepest_fall": plateau and plateau.steepest_fall,
                "onset": onset_angle(curve) if curve.parameter_column.unit == "degree" else None,
                "seconds_per_step": float(np.median(curve.seconds)),
                "largest_difference": None if largest is None else float(apart.reaction[largest]),
                "largest_difference_at": None if largest is None else float(apart.parameter[largest]),
            }
        )
    return rows
