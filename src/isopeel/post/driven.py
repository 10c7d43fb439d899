"""Where the drive of a problem acts on a body."""

from isopeel.problem import Boundary, Problem


def driven_on(problem: Problem, body: str) -> tuple[Boundary, ...]:
    """Return the boundaries of a body that the drive moves or loads; none where it acts on others."""
    if body != problem.driven:
        return ()
    load = problem.drive.load
    return (Boundary(body, problem.drive.side, *((0.0, 1.0) if load is None else (load.start, load.end))),)


def driven_boundaries(problem: Problem) -> tuple[Boundary, ...]:
    """Return the boundaries of all bodies that the drive moves or loads."""
    return tuple(one for body in problem.bodies for one in driven_on(problem, body.name))
