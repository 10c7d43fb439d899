"""Runs beside each other: what was read from each, and how far their curves lie apart."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.post.findings import Findings
from isopeel.post.plateau import onset_angle, plateau_mean, rising
from isopeel.results.curve import Curve
from isopeel.results.run_file import StoredRun

_SAME = 1e-9  # parameters that differ by less, in their own size, differ by round-off only


@dataclass(frozen=True, eq=False)
class Compared:
    """A run with one step or more, what it is called, and what was read from it."""

    name: str
    run: StoredRun
    found: Findings


class Difference(NamedTuple):
    """Reaction of a run less that of another one, at the parameters (n,) that both have."""

    parameter: FloatArray
    reaction: FloatArray


def difference(curve: Curve, first: Curve) -> Difference:
    """How far a curve lies above the first one; of one that turns back, only what lies beyond all before."""
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
