"""The peers: each an assembly and the solver for its tangent."""

from collections.abc import Callable

from pypardiso import spsolve

from scikit_fem_strip.blas import BlasAssembly
from scikit_fem_strip.forms import FormsAssembly
from scikit_fem_strip.plain import PlainAssembly
from scikit_fem_strip.solver import SymmetricSolver
from scikit_fem_strip.strip import Strip
from scikit_fem_strip.trace import Assembly, Solver

PEERS: dict[str, Callable[[Strip], tuple[Assembly, Solver]]] = {
    "plain": lambda strip: (PlainAssembly(strip), spsolve),
    "forms": lambda strip: (FormsAssembly(strip), SymmetricSolver()),
    "blas": lambda strip: (BlasAssembly(strip), SymmetricSolver()),
}
