"""The energy that a path gained without work of its drive.

Between two steps of a path the energies of body and joint grow by the work of the drive. The work is an
integral over the reaction, which is known at the steps only: the trapezoidal rule gives it, and `works`
estimates its error. If the energies grow by more than the work and this error, energy was gained without
work.
"""

from dataclasses import dataclass

import numpy as np

from isopeel.case import Case
from isopeel.common.arrays import FloatArray
from isopeel.problem import Problem, raises_load
from isopeel.results.run_file import StoredRun
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import KINDS, State, Step
from isopeel.solve.trace import trace

#: Allowed gain, as a share of the work of adhesion times the adhering length.
ALLOWED = 1e-6
#: Factor of safety of the error of a smooth curve.
_SAFETY = 4.0
#: Parts of a step whose gain is computed again: the error of the trapezoidal rule falls to a thousandth.
_PARTS = 32
#: Number of steps on either side in which the oscillation of a reaction is measured.
_AROUND = 3


@dataclass(frozen=True)
class Gain:
    """The largest gain of energy beyond the work in a step, over W times the adhering length."""

    share: float
    parameter: float
    step: int = 0  # number of the step that ends there

    @property
    def forbidden(self) -> bool:
        """Whether the gain is larger than allowed."""
        return self.share > ALLOWED


def largest_gain(run: StoredRun, problem: Problem) -> Gain:
    """Return the largest gain in a step of a stored run."""
    curve = run.curve
    if len(curve) < 2:
        return Gain(0.0, 0.0)
    parameter = curve.parameter / curve.parameter_column.factor
    reaction = curve.reaction / curve.reaction_column.factor
    # a dead load of a known size does work on its displacement, which is the reaction
    along, force = (reaction, parameter) if raises_load(problem.drive) else (parameter, reaction)
    energy = curve.stored_energy + curve.adhesive_energy + curve.dissipated_energy
    work, error = works(along, force, jumped=curve.kind == KINDS.index("jump"))
    gained = np.diff(energy) - work - error
    # differences of energies have the round-off of the energies
    rounding = 1e-13 * (np.abs(curve.stored_energy) + np.abs(curve.adhesive_energy)).max()
    at = int(np.argmax(gained))
    share = max(float(gained[at] - rounding), 0.0) / _worth(problem)
    return Gain(share, float(curve.parameter[at + 1]), at + 1)


def gain_in_parts(case: Case, stage_number: int, gain: Gain) -> Gain:
    """Return the gain of one step, by the work in many parts of it: the estimate of its error may be too low.

    The path is computed again up to the step, which gives the same bits.
    """
    space = case.spaces()
    base: State | None = None
    for number, stage in enumerate(case.stages()):
        settings = NewtonSettings(path_control=stage.path_control)
        points = case.discretization.contact_points
        before: Step | None = None
        for step in trace(stage.problem, space, stage.parameters, settings, base=base, contact_points=points):
            if number == stage_number and step.number == gain.step and before is not None:
                parts = np.linspace(before.parameter, step.parameter, _PARTS + 1)
                path = [before]
                path += trace(
                    stage.problem, space, parts[1:], settings, start=[before.state], contact_points=points
                )
                return Gain(_gained(path, stage.problem) / _worth(stage.problem), gain.parameter, gain.step)
            before = step
        base = None if before is None else before.state
    return gain


def _gained(path: list[Step], problem: Problem) -> float:
    """Return the growth of the energies in each step beyond the work and the error of the work."""
    parameter, reaction = (np.array([getattr(s, name) for s in path]) for name in ("parameter", "reaction"))
    along, force = (reaction, parameter) if raises_load(problem.drive) else (parameter, reaction)
    work, error = works(along, force, jumped=np.array([step.kind == "jump" for step in path]))
    energies = [step.stored_energy + step.adhesive_energy + step.dissipated_energy for step in path]
    gained = energies[-1] - energies[0] - float(np.sum(work + error)) - _round_off(problem)
    return max(gained, 0.0)


def _round_off(problem: Problem) -> float:
    """Round-off of the stored energy: the double precision of E times the area of each body."""
    xi, weights = np.polynomial.legendre.leggauss(20)
    places = [(x, y) for x in 0.5 + xi / 2 for y in 0.5 + xi / 2]
    total = 0.0
    for body in problem.bodies:
        areas = np.abs(np.linalg.det(body.shape.jacobian(*np.array(places).T)))
        area = float(np.outer(weights, weights).ravel() @ areas) / 4
        total += float(np.finfo(float).eps) * body.material.youngs_modulus * area
    return total


def _worth(problem: Problem) -> float:
    """Return the work of adhesion times the adhering length, of all interfaces."""
    total = 0.0
    for interface in problem.interfaces:
        side = problem.body_of(interface.boundary.body).shape.boundary(interface.side)
        total += interface.law.work_of_adhesion * side.length() * (interface.end - interface.start)
    return total


def works(along: FloatArray, force: FloatArray, *, jumped: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Return the work (n - 1,) of a force (n,) in each step of displacements (n,), and its estimated error.

    The error is the sum of two parts. One is a multiple of the error of a smooth curve, by the cubic through
    the neighbouring steps, or the oscillation of the force there if that is larger. The other one is the
    error of a curve with a kink between two steps, where the straight lines from before and after it meet. In
    a step that `jumped` (n,), the force fell at an unknown place: it may have had the larger value in the
    whole step.
    """
    steps = np.diff(along)
    work = 0.5 * steps * (force[1:] + force[:-1])
    smooth, kinked, swing = (
        np.array([estimate(along, force, k) for k in range(len(steps))])
        for estimate in (_smooth, _kinked, _swing)
    )
    error = np.maximum(_SAFETY * smooth, swing) + kinked
    larger = np.maximum(steps * force[1:], steps * force[:-1]) - work
    return work, np.where(jumped[1:], np.maximum(error, larger), error)


def _smooth(along: FloatArray, force: FloatArray, k: int) -> float:
    """Return the difference of the trapezoidal rule from the cubic through four steps, three at the ends."""
    start, step = max(k - 1, 0), abs(along[k + 1] - along[k])
    around = slice(start, min(k + 3, len(along)))
    x = along[around] - along[k]
    if step == 0 or len(np.unique(x)) < len(x):
        return 0.0
    # in units of the step, so that the matrix is well conditioned
    coefficients = np.polynomial.polynomial.polyfit(x / step, force[around], len(x) - 1)
    integral = np.polynomial.polynomial.polyint(coefficients)
    ends = np.polynomial.polynomial.polyval(np.array([0.0, (along[k + 1] - along[k]) / step]), integral)
    work = 0.5 * (along[k + 1] - along[k]) * (force[k] + force[k + 1])
    return float(abs(step * (ends[1] - ends[0]) - work))


def _swing(along: FloatArray, force: FloatArray, k: int) -> float:
    """Return half of the oscillation of the force about a straight line nearby, times the step.

    While a front passes elements, the reaction oscillates with a period of a few steps or less. So the steps
    sample the oscillation by chance, and the rule may miss half of it. On good meshes, with steps of a third
    of an element, this is up to 5e-5 of W times the adhering length; with steps of a twelfth, it is nothing.
    """
    around = slice(max(k - _AROUND, 0), k + 2 + _AROUND)
    x, values = along[around] - along[k], force[around]
    spread = float(np.ptp(x))
    if spread == 0:
        return 0.0
    line = np.polynomial.polynomial.polyfit(x / spread, values, 1)
    rest = values - np.polynomial.polynomial.polyval(x / spread, line)
    return float(0.5 * np.ptp(rest) * abs(along[k + 1] - along[k]))


def _kinked(along: FloatArray, force: FloatArray, k: int) -> float:
    """Return the area between the chord of a step and the lines through the steps before and after."""
    slopes = [
        (force[j + 1] - force[j]) / (along[j + 1] - along[j])
        if 0 <= j < len(along) - 1 and along[j + 1] != along[j]
        else None
        for j in (k - 1, k, k + 1)
    ]
    before, chord, after = slopes
    if chord is None:
        return 0.0
    rises = [abs(slope - chord) for slope in (before, after) if slope is not None]
    step = abs(along[k + 1] - along[k])
    if len(rises) < 2:
        # at the ends of the curve, the line may continue through the whole step
        return float(0.5 * step**2 * max(rises, default=0.0))
    # two lines that meet are this high above the chord; lines that do not meet get the same value
    return float(0.5 * step**2 * rises[0] * rises[1] / (rises[0] + rises[1] or 1.0))
