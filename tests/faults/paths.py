"""Paths of small cases, for tests of what the solver accepts."""

import numpy as np

from isopeel.case import Case, with_options
from isopeel.common.arrays import FloatArray
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.solve.trace import trace


def paths(text: str, path_control: str | None = None) -> list[list[Step]]:
    """The steps of each stage of a case; raises ConvergenceError."""
    case = Case.parse(text, "test")
    if path_control is not None:
        case = with_options(case, path_control=path_control)
    space, stages, base = case.space(), [], None
    for stage in case.stages():
        settings = NewtonSettings(path_control=stage.path_control)
        stages.append(list(trace(stage.problem, space, stage.parameters, settings, base=base)))
        base = stages[-1][-1].state
    return stages


def as_far_as_it_goes(
    text: str, path_control: str | None = None
) -> tuple[list[Step], ConvergenceError | None]:
    """The steps of the one stage of a case, and why there are no more."""
    case = with_options(Case.parse(text, "test"), path_control=path_control)
    (stage,) = case.stages()
    steps: list[Step] = []
    try:
        settings = NewtonSettings(path_control=stage.path_control)
        for step in trace(stage.problem, case.space(), stage.parameters, settings):
            steps.append(step)  # noqa: PERF402 (what came before the failure is wanted)
    except ConvergenceError as error:
        return steps, error
    return steps, None


def worth(text: str) -> float:
    """Work of adhesion times the adhering length."""
    adhesion = (stage := Case.parse(text, "test").stages()[0]).problem.adhesion
    length = float(np.ptp(stage.problem.body.shape.control_points.reshape(-1, 2)[:, 0]))
    return adhesion.law.work_of_adhesion * length * (adhesion.end - adhesion.start)


def energies(steps: list[Step]) -> FloatArray:
    """What is stored, in the joint and dissipated, of each step."""
    return np.array([s.stored_energy + s.adhesive_energy + s.dissipated_energy for s in steps])


def gained(steps: list[Step]) -> FloatArray:
    """Energy (n - 1,) that each step gained beyond the most that its drive can have done of work.

    The reaction may have been larger within the step than at both its ends, by some 2e-3 on these paths.
    """
    parameters, rates = (np.array([getattr(s, name) for s in steps]) for name in ("parameter", "reaction"))
    works = [rate * np.diff(parameters) for rate in (rates[:-1], rates[1:])]
    most = np.maximum(*np.abs(works))
    gains: FloatArray = np.diff(energies(steps)) - np.maximum(*works) - 2e-3 * most
    return gains
