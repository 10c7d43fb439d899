"""A check and its result."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.errors import InputError
from isopeel.problem import Problem
from isopeel.report.document import Picture
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.solve.trace import trace

C = TypeVar("C")
O = TypeVar("O")  # noqa: E741 (an outcome)


@dataclass(frozen=True)
class Row:
    """A computed number, and the expected one.

    `allowed` is the largest relative deviation; it is None for a row that is for information, where the
    closed form is not valid. `details` are cells for the columns that the check adds. Raises InputError if
    `allowed` is not positive.
    """

    computed: float  # nan where there is no equilibrium
    expected: float
    allowed: float | None
    details: tuple[str, ...]

    def __post_init__(self) -> None:
        """Check the allowed deviation."""
        if self.allowed is not None and not self.allowed > 0:
            raise InputError("allowed", self.allowed, "it must be positive")

    @property
    def deviation(self) -> float:
        """Relative deviation."""
        return self.computed / self.expected - 1

    @property
    def passed(self) -> bool:
        """Whether the deviation is at most the allowed one; a missing number does not pass."""
        return self.share_of_allowed <= 1

    @property
    def share_of_allowed(self) -> float:
        """Deviation over the allowed one: zero for a row for information, infinite for a missing number."""
        if self.allowed is None:
            return 0.0
        return abs(self.deviation) / self.allowed if np.isfinite(self.computed) else np.inf


@dataclass(frozen=True)
class Result:
    """The result of a check: its rows, its settings, and its figures.

    `text` describes in Markdown what is compared and how it is computed; `settings` are names and values;
    `columns` are the titles of the details of the rows, the first `named_by` of which name the rows;
    `problems` are the reasons of missing numbers.
    """

    quantity: str
    text: str
    settings: tuple[tuple[str, str], ...]
    columns: tuple[str, ...]
    named_by: int
    rows: tuple[Row, ...]
    pictures: tuple[Picture, ...]
    problems: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether all rows pass."""
        return all(row.passed for row in self.rows)


@dataclass(frozen=True)
class Check(Generic[C, O]):
    """Cases that can be computed one by one, each in its own process, and the function that judges them."""

    title: str
    cases: tuple[C, ...]
    compute: Callable[[C], O]
    judge: Callable[[Sequence[O]], Result]


@dataclass(frozen=True, eq=False)
class EquilibriumPath:
    """Equilibria from the first parameter of a path to the last one that was found."""

    parameter: FloatArray
    reaction: FloatArray
    displacement: FloatArray | None  # coefficients of the last step, None where there is none
    failure: str  # the reason of an early end, empty if there is none
    reactions: FloatArray  # (steps, n) of n boundaries, of none where the drive acts on one only
    dissipated: FloatArray  # (steps,) energy


def traced(
    problem: Problem,
    space: SpaceOfBodies,
    parameters: Iterable[float],
    settings: NewtonSettings | None = None,
    until: Callable[[Sequence[Step]], bool] = lambda _: False,
    contact_points: int | None = None,
) -> EquilibriumPath:
    """Return a path, traced to its end or until a condition on its steps holds."""
    steps: list[Step] = []
    failure = ""
    try:
        for step in trace(problem, space, parameters, settings, contact_points=contact_points):
            steps.append(step)
            if until(steps):
                break
    except ConvergenceError as error:
        failure = str(error)
    return EquilibriumPath(
        frozen(np.array([step.parameter for step in steps])),
        frozen(np.array([step.reaction for step in steps])),
        steps[-1].displacement if steps else None,
        failure,
        frozen(np.array([step.reactions for step in steps])),
        frozen(np.array([step.dissipated_energy for step in steps])),
    )
