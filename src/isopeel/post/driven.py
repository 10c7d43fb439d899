"""Where the drive of a problem acts on a body."""

from isopeel.problem import Boundary, Problem


def driven_on(problem: Problem, body: str) -> tuple[Boundary, ...]:
    """Return the boundaries of a body that the drive moves or loads; none where it acts on others."""
    return tuple(one for one in driven_boundaries(problem) if one.body == body)


def tied_with(problem: Problem, body: str) -> set[str]:
    """Return the names of a body and of all that are tied to it, by one tie or several."""
    found = {body}
    for _ in problem.ties:
        for tie in problem.ties:
            pair = {tie.boundary.body, tie.to.body}
            found |= pair if pair & found else set()
    return found


def driven_boundaries(problem: Problem) -> tuple[Boundary, ...]:
    """Return the boundaries of all bodies that the drive moves or loads."""
    return tuple(one.boundary for one in problem.driven)
