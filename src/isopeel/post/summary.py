"""The summary of a run: what was read from it, for a JSON file."""

from math import isfinite
from typing import Any

from isopeel.case import Case
from isopeel.post.closed_form import BeamPeeling
from isopeel.post.reading import PlateauReading, onset_angle, plateau_mean, unreadable
from isopeel.results.run_file import StoredRun


def summarize(
    case: Case,
    run: StoredRun,
    plateau: PlateauReading | None,
    closed_form: BeamPeeling | None,
    period: float | None,
    wall_time: float,
) -> dict[str, Any]:
    """Collect what a run says, as plain numbers and texts; `note` says why a value is None.

    Angles are in degrees, moments in E0 L0^3, slopes per degree, lengths in L0. `period` is that of the
    oscillation on the plateau, in degrees; `wall_time` (seconds) that of the whole run, with its compilation.
    """
    curve, attributes, failure = run.curve, run.attributes, run.failure
    iterations = int(curve.iterations.sum())
    onset = onset_angle(curve)
    window = case.reading.window if case.reading else None
    versions = {name: value for name, value in attributes.items() if name.startswith("version_")}
    return {
        "case": case.name,
        **{name: attributes[name] for name in ("space", "mesh", "dofs", "traction")},
        "units": {"angle": curve.parameter_column.unit, "moment": curve.reaction_column.unit, "length": "L0"},
        "angle": float(curve.parameter[-1]) if len(curve) else None,
        "plateau": window and plateau_mean(curve, window),
        "amplitude": plateau and plateau.amplitude,
        "slopes": plateau and {"rise": plateau.steepest_rise, "fall": plateau.steepest_fall},
        "drift": plateau and {"per_degree": plateau.drift, "of": plateau.drift_of},
        "window": plateau and list(plateau.window),
        "onset": onset,
        "closed_form": closed_form
        and {"moment": closed_form.moment, "onset": closed_form.onset_deg, "radius": closed_form.radius},
        "note": "; ".join(_notes(run, window, period, onset)) or None,
        "wall_time_s": wall_time,
        "newton_iterations": iterations,
        "newton_iterations_per_step": iterations / len(curve) if len(curve) else None,
        "completed": run.ending == "completed",
        "failure": failure
        and {
            "angle": failure.parameter,
            "reason": failure.reason,
            # JSON knows no inf
            "iterations": [measure if isfinite(measure) else None for measure in failure.iterations],
        },
        "versions": {name.removeprefix("version_"): value for name, value in versions.items()},
        "git_revision": attributes.get("git_revision"),
    }


def _notes(
    run: StoredRun, window: tuple[float, float] | None, period: float | None, onset: float | None
) -> list[str]:
    notes = []
    if window is None:
        notes.append("plateau, amplitude and slopes: the case names no window to read them in")
    elif reason := unreadable(run.curve, window, period):
        covered = plateau_mean(run.curve, window) is not None
        notes.append(f"{'' if covered else 'plateau, '}amplitude and slopes: {reason}")
    if onset is None:
        notes.append("onset: no peeling began")
    return notes
