"""The steady part of a run: its window, the closed form for it, and the reading of its mean reaction."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.post.closed_form import Expected, laminate, t_peel, tape_on_body
from isopeel.post.closed_form.expected import Theory, invalid, theory
from isopeel.post.crack import Fronts, crack_length_at, joint_ends
from isopeel.post.laboratory import Laboratory, kind_of
from isopeel.post.plateau import PlateauReading, plateau_mean, read_plateau
from isopeel.post.readings import DRIFT, LAST, Reading, drift, drive_test, steady_window
from isopeel.problem import Load, Problem
from isopeel.results.curve import Curve
from isopeel.results.run_file import StoredRun
from isopeel.splines.rows import RowSpace


class SteadyPart(NamedTuple):
    """The window of the steady part, if there is one, and what is known of the reaction there.

    The `plateau` is that of the window of the case. The `period` of the oscillation by the mesh is also given
    if the closed form is not valid, for the reason `unproven`.
    """

    window: tuple[float, float] | None
    plateau: PlateauReading | None
    closed_form: Expected | None
    period: float | None = None
    unproven: str = ""

    def reading(self, curve: Curve) -> Reading | None:
        """Return the mean reaction, with drift and oscillation; steady where the drift is small."""
        window, plateau, form = self.window, self.plateau, self.closed_form
        mean = plateau_mean(curve, window) if window else None
        if window is None or mean is None:
            return None
        words, rise = "mean", 0.0
        if mean:
            # the oscillation does not change the fit of the plateau
            rise = plateau.drift * (window[1] - window[0]) / mean if plateau else drift(curve, window)
            words += f", drift {_drift_in_words(rise)}"
            if plateau:
                words += f", oscillation {100 * plateau.amplitude / abs(mean):.2g} %"
        # if a closed form is valid the state is steady, and the drift comes from the oscillation by the mesh
        column = curve.reaction_column
        name = f"{'steady' if form or abs(rise) <= DRIFT else 'mean'} {column.name}"
        expected, source = (form.reaction, form.source) if form else (None, "")
        return Reading(name, mean, kind_of(column), None, expected, source, words, window)


def theory_of_bodies(problem: Problem, space: SpaceOfBodies) -> Theory:
    """Return the closed form of several bodies that begin at rest, or why there is none."""
    for find in (laminate, t_peel, tape_on_body):
        found = find(problem, space)
        if found != Theory():
            return found
    return Theory()


def steady_part_of_bodies(
    problem: Problem,
    space: SpaceOfBodies,
    run: StoredRun,
    window: tuple[float, float] | None,
    found: Mapping[str, Fronts],
    laboratory: Laboratory,
) -> SteadyPart:
    """Return the steady part of a run of several bodies or interfaces, whose fronts have their names.

    Two bodies or tied layers that begin at rest may have a closed form; others have none.
    """
    curve = run.curve
    expected = theory_of_bodies(problem, space) if run.base is None else Theory()
    form, unproven = expected.form, expected.reason
    period = form.period if form else None
    plateau = read_plateau(curve, window, period) if window else None
    given = window if window and plateau_mean(curve, window) is not None else None
    if form is None:
        return SteadyPart(given or steady_window(curve), plateau, None, None, unproven)
    name, there = next(iter(found.items()))
    steady = given
    reason: str | None = None
    if given is not None:
        reason = _invalid(problem, curve, there, form, given, laboratory, name)
    else:
        steady, reason = _own_window(problem, curve, there, form, laboratory, name)
        if steady is None:
            reason = f"no part of the run has a steady {curve.reaction_column.name}"
    if reason:
        unproven, form = f"{form.source} is not shown: {reason}", None
    return SteadyPart(steady, plateau, form, period, unproven)


def steady_part(
    problem: Problem,
    space: RowSpace,
    run: StoredRun,
    window: tuple[float, float] | None,
    found: Fronts,
    laboratory: Laboratory,
) -> SteadyPart:
    """Return the steady part of a run of one body, with the closed form where that is valid."""
    curve = run.curve
    expected = theory(problem, space)
    form, unproven = expected.form, expected.reason
    if form is not None and run.base is not None:
        # a later stage reaches the same steady state by another path; but if the tape slides, the stage
        # before has stretched the part that lies on the substrate
        slides = problem.adhesion.sliding_length is None and isinstance(problem.drive, Load)
        form = None if slides else replace(form, onset=None)
    period = form.period if form else None
    plateau = read_plateau(curve, window, period) if window else None
    steady = window if window and plateau_mean(curve, window) is not None else None
    reason = None
    if steady is not None:
        reason = _invalid(problem, curve, found, form, steady, laboratory)
    elif drive_test(problem, curve) in ("moment", "tape"):
        steady, reason = _own_window(problem, curve, found, form, laboratory)
        if steady is None and window is None:
            reason = f"no part of the run has a steady {curve.reaction_column.name}"
    elif form is not None:
        reason = "the end was not lifted far enough: the free arm does not yet point along the force"
    if steady is None and run.base is not None:
        form = None
    if form is not None and reason:
        unproven, form = f"{form.source} is not shown: {reason}", None
    return SteadyPart(steady, plateau, form, period, unproven)


def _own_window(
    problem: Problem,
    curve: Curve,
    found: Fronts,
    form: Expected | None,
    laboratory: Laboratory,
    interface: str = "",
) -> tuple[tuple[float, float] | None, str | None]:
    """Return a window where the case names none, and why the closed form is not valid there, or None.

    The window is the first of the last parts of the curve that is steady, and in which the closed form is
    valid if there is one.
    """
    windows = [window for share in LAST if (window := steady_window(curve, share))]
    reasons = [_invalid(problem, curve, found, form, window, laboratory, interface) for window in windows]
    for window, reason in zip(windows, reasons, strict=True):
        if reason is None:
            return window, None
    return (windows[0], reasons[0]) if windows else (None, None)


def _invalid(
    problem: Problem,
    curve: Curve,
    found: Fronts,
    form: Expected | None,
    window: tuple[float, float],
    laboratory: Laboratory,
    interface: str = "",
) -> str | None:
    """Return why a closed form is not valid in a window; None where it is, or where there is none."""
    if form is None:
        return None
    lengths = [crack_length_at(problem, curve, found, at) for at in window]
    return invalid(form, lengths, joint_ends(problem, interface)[1], laboratory.length)


def _drift_in_words(rise: float) -> str:
    """Return a drift without digits that are round-off."""
    return f"{100 * rise:+.2g} %" if abs(rise) > 1e-4 else "below 0.01 %"
