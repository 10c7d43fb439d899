"""The programs by name."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Peer:
    """The module of a program, its name in the table, and the libraries whose versions it reports."""

    module: str
    label: str
    libraries: tuple[str, ...]


ISOPEEL = "isopeel"
# in the order of their turns: the slowest last, so that the turns of the others are close to isopeel's
PROGRAMS = {
    ISOPEEL: Peer("peers.isopeel_strip", "isopeel", ("isopeel", "numpy", "scipy", "numba")),
    "tuned": Peer("peers.scikit_fem.tuned", "skfem tuned", ("scikit-fem", "pypardiso", "mkl")),
    "felupe": Peer("peers.felupe_strip", "FElupe", ("felupe", "qdldl")),
    "ngsolve": Peer("peers.ngsolve_strip", "NGSolve", ("ngsolve",)),
    "dolfinx": Peer("peers.dolfinx_strip", "DOLFINx", ("fenics-dolfinx", "petsc4py")),
    "forms": Peer("peers.scikit_fem.forms", "skfem forms", ("scikit-fem", "pypardiso", "mkl")),
    "plain": Peer("peers.scikit_fem.plain", "skfem plain", ("scikit-fem", "pypardiso", "mkl")),
    "nutils": Peer("peers.nutils_strip", "Nutils", ("nutils", "pypardiso", "mkl")),
}
PEERS = [name for name in PROGRAMS if name != ISOPEEL]

#: Two arms that peel off each other.
ARMS = {
    "isopeel-arms": Peer("peers.isopeel_arms", "isopeel", PROGRAMS[ISOPEEL].libraries),
    "ngsolve-arms": Peer("peers.ngsolve_arms", "NGSolve", ("ngsolve",)),
}
PROGRAMS |= ARMS
