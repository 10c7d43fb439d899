"""The forces of the supports in a step."""

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.problem import Problem
from isopeel.solve.step import State, Step


def support_reactions(
    problem: Problem,
    space: SpaceOfBodies,
    step: Step,
    *,
    base: State | None = None,
    contact_points: int | None = None,
) -> dict[str, FloatArray]:
    """Return the force (2,) per width of each support on its body, by names such as `body.left`.

    The arguments are those that the step was traced with. Where supports meet, each has the force of what
    they share. Along components that a support does not hold it is zero. Raises InputError as `trace`.
    """
    system = System(problem, space, contact_points, None if base is None else base.displacement)
    system = system.after(step.maximum_openings)
    u, load = system.state(step.unknown_values, step.parameter)
    return system.support_reactions(system.equilibrium(u, load))
