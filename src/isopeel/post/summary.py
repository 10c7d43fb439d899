"""The summary of a run: what was read from it, for a JSON file."""

from dataclasses import asdict
from math import isfinite
from typing import Any

import numpy as np

from isopeel.arrays import IntArray
from isopeel.post.closed_form import Expected
from isopeel.post.reading import PlateauReading, onset_angle, plateau_mean, unreadable
from isopeel.results.curve import Curve
from isopeel.results.run_file import StoredRun
from isopeel.solve.step import KINDS


def summarize(
    title: str,
    run: StoredRun,
    window: tuple[float, float] | None,
    plateau: PlateauReading | None,
    closed_form: Expected | None,
    inside: float,
    wall_time: float,
) -> dict[str, Any]:
    """Collect what a run says, as plain numbers and texts; `note` says why a value is None.

    Parameter and reaction are in the units of their columns, which `units` names, slopes per unit of the
    parameter. The plateau is read in the `window`, if there is one. A jump is a step of that kind, or one
    that released more than a thousandth of what the energies varied by. `inside` is how deep (in L0) the
    body has come to lie in the substrate, `wall_time` (seconds) that of the whole run, with its compilation.
    """
    curve, attributes, failure = run.curve, run.attributes, run.failure
    iterations = int(curve.iterations.sum())
    parameter, reaction = curve.parameter_column, curve.reaction_column
    # a straight line that bends tells when peeling begins under a moment, not under a force
    onset = onset_angle(curve) if parameter.unit == "degree" else None
    strongest = int(np.argmax(np.abs(curve.reaction))) if len(curve) else None
    versions = {name: value for name, value in attributes.items() if name.startswith("version_")}
    return {
        "case": title,
        **{name: attributes[name] for name in ("space", "mesh", "dofs", "traction")},
        "units": {
            **{column.name: column.unit for column in (parameter, reaction)},
            **{name: attributes[name] for name in ("L0", "E0")},
        },
        parameter.name: float(curve.parameter[-1]) if len(curve) else None,
        "peak": None
        if strongest is None
        else {
            reaction.name: float(curve.reaction[strongest]),
            parameter.name: float(curve.parameter[strongest]),
        },
        "plateau": window and plateau_mean(curve, window),
        "amplitude": plateau and plateau.amplitude,
        "slopes": plateau and {"rise": plateau.steepest_rise, "fall": plateau.steepest_fall},
        "drift": plateau and {"per_unit": plateau.drift, "of": plateau.drift_of},
        "window": plateau and list(plateau.window),
        "onset": onset,
        "closed_form": closed_form and asdict(closed_form),
        "note": "; ".join(_notes(run, window, closed_form, onset, inside)) or None,
        "wall_time_s": wall_time,
        "corrections": iterations,
        "corrections_per_step": iterations / len(curve) if len(curve) else None,
        "jumps": [
            {parameter.name: float(curve.parameter[k]), "released_energy": float(curve.released_energy[k])}
            for k in _jumps(curve)
        ],
        "completed": run.ending == "completed",
        "failure": failure
        and {
            parameter.name: failure.parameter,
            "reason": failure.reason,
            "cause": failure.cause,
            "hint": failure.hint,
            # JSON knows no inf
            "iterations": [measure if isfinite(measure) else None for measure in failure.iterations],
        },
        "versions": {name.removeprefix("version_"): value for name, value in versions.items()},
        "git_revision": attributes.get("git_revision"),
    }


def _jumps(curve: Curve) -> IntArray:
    """Numbers of the steps that jumped."""
    if not len(curve):
        return np.empty(0, dtype=np.int64)
    varied = np.ptp(curve.stored_energy) + np.ptp(curve.adhesive_energy)
    jumped = curve.kind == KINDS.index("jump")
    return np.flatnonzero(jumped | (curve.released_energy > 1e-3 * varied))


def _notes(
    run: StoredRun,
    window: tuple[float, float] | None,
    closed_form: Expected | None,
    onset: float | None,
    inside: float,
) -> list[str]:
    notes = []
    if inside:
        notes.append(
            f"a part that does not adhere, and feels no substrate, lies up to {inside:.2g} L0 inside it"
        )
    if window is None:
        if closed_form is not None:
            notes.append("plateau, amplitude and slopes: the case names no window to read them in")
    elif reason := unreadable(run.curve, window, closed_form.period if closed_form else None):
        covered = plateau_mean(run.curve, window) is not None
        notes.append(f"{'' if covered else 'plateau, '}amplitude and slopes: {reason}")
    if onset is None and run.curve.parameter_column.unit == "degree":
        notes.append("onset: no peeling began")
    return notes
