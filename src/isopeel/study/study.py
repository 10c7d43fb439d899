"""A study: a base case, and the values of its keys for each run."""

from dataclasses import dataclass

from isopeel.case import Case
from isopeel.study.design import Method, Point, points_of
from isopeel.study.factors import Factor


@dataclass(frozen=True)
class Study:
    """A base case, and the values of its keys for each run.

    `outputs` are the names of the readings in the table; all of them if it is empty.
    """

    name: str
    case: Case
    factors: tuple[Factor, ...]
    method: Method = "grid"
    count: int = 0
    seed: int = 0
    outputs: tuple[str, ...] = ()

    @property
    def points(self) -> list[Point]:
        """The values of each run, in their order."""
        return points_of(self.factors, self.method, self.count, self.seed)
