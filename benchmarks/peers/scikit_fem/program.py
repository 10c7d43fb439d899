"""The program of all three: the strip and Newton's path, with any assembly and solver."""

from collections.abc import Callable, Iterator
from typing import TypeAlias

from scipy.sparse import csr_matrix

from peers.laws import FloatArray
from peers.newton import LoadStep, trace
from peers.scikit_fem.strip import Strip

#: From a displacement (2, nodes) to the residual (unknowns,) and the exact tangent, as the solver stores it.
Assembly: TypeAlias = Callable[[FloatArray], tuple[FloatArray, csr_matrix]]
#: From a tangent and a right-hand side to the solution (unknowns,).
Solver: TypeAlias = Callable[[csr_matrix, FloatArray], FloatArray]


class Program:
    """The strip with an assembly and a solver, with the interface that Newton's method needs."""

    def __init__(self, strip: Strip, assemble: Assembly, solve: Solver) -> None:
        self.unknowns = strip.unknowns
        self.displacement, self.moment = strip.displacement, strip.moment
        self.assemble, self.solve = assemble, solve


def starter(
    assembly: Callable[[Strip], Assembly], solver: Callable[[], Solver]
) -> Callable[[int, tuple[int, int], Iterator[float]], Iterator[LoadStep]]:
    """Return the function that returns the path of a program."""

    def start(degree: int, elements: tuple[int, int], angles: Iterator[float]) -> Iterator[LoadStep]:
        strip = Strip(degree, elements)
        return trace(Program(strip, assembly(strip), solver()), angles)

    return start
