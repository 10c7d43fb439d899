"""The steady load of a tape whose load is raised, along a path that goes on beyond its largest value."""

from dataclasses import replace

import numpy as np

from isopeel.post.closed_form.expected import theory
from isopeel.post.closed_form.strip import free_strip
from isopeel.post.crack import joint_ends, opened
from isopeel.post.laboratory import kind_of
from isopeel.post.readings import Reading
from isopeel.problem import Problem, PulledSide
from isopeel.results.curve import Curve
from isopeel.splines.rows import RowSpace

#: Steps whose mean is taken, at least.
_FEWEST = 4


def steady_load(problem: Problem, space: RowSpace, curve: Curve) -> Reading | None:
    """Mean load while the crack is as long as the closed form of a prescribed displacement asks for.

    A dead load has one parameter for all cracks, so that no window of it can be named: the crack's length
    follows from what the joint has opened by. None where few steps or no form are valid.
    """
    drive, strip = problem.drive, free_strip(problem)
    if not isinstance(drive, PulledSide) or drive.control != "force" or strip is None or not len(curve):
        return None
    form = theory(replace(problem, drive=replace(drive, control="displacement")), space).form
    if form is None:
        return None
    crack = strip.free_length + opened(problem, curve)
    inside = (crack >= form.arm) & (crack <= joint_ends(problem)[1] - form.behind)
    if np.count_nonzero(inside) < _FEWEST:
        return None
    value = float(curve.parameter[inside].mean())
    words = "mean while the closed form is valid"
    kind = kind_of(curve.parameter_column)
    return Reading("steady force", value, kind, None, form.reaction, form.source, words)
