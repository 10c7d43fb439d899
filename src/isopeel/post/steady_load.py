"""The steady load of a tape under load control, along a path that continues beyond the largest load."""

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

#: Least number of steps for a mean.
_FEWEST = 4


def steady_load(problem: Problem, space: RowSpace, curve: Curve) -> Reading | None:
    """Return the mean load while the crack length is in the range of the closed form; None otherwise.

    The closed form is that of a prescribed displacement. A dead load has the same value for all cracks, so
    that no window of the parameter can be named: the crack length follows from the opened part of the joint.
    Returns None where there is no valid form, or too few steps.
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
