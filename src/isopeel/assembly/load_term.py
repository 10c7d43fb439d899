"""A load on one boundary as a term of the system: its force on every coefficient, and how that turns."""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from isopeel.assembly.constraints import Constraints
from isopeel.assembly.load_kernel import LoadData, add_load
from isopeel.assembly.loops import Loops
from isopeel.assembly.packing import Packed, packed
from isopeel.assembly.spaces import HELD, Spaces
from isopeel.assembly.tables import side_of
from isopeel.assembly.terms import WithoutHistory
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.problem import Boundary, Load


class _Loaded(NamedTuple):
    """A load on one boundary, of the drive or held."""

    boundary: Boundary
    size: float
    of_drive: bool
    direction: FloatArray
    follows: bool


@dataclass(frozen=True, eq=False)
class LoadTerm(WithoutHistory):
    """Forces q(u) of a load of one per unit width; q . du is the mean displacement of its boundary.

    A dead load has q = q0; one that follows has the traction Q dx/ds, with x the deformed side, s its
    reference length and Q the rotation from the side's tangent to the force. That is linear in u: q0 + B u.
    """

    size: float  # of a load that is held; of a load of the drive, its factor on the size of that
    of_drive: bool
    pattern: FloatArray  # q0 (size, 2), which also weighs the coefficients of the mean displacement
    offset: float  # mean displacement in the base state, from where it counts
    functions: IntArray  # (E, m)
    blocks: FloatArray  # B by elements, (E, m, 2, m, 2); no elements for a dead load

    @classmethod
    def of(cls, load: _Loaded, spaces: Spaces, base: FloatArray | None) -> Self:
        """Integrate a load, which begins with a base state (size, 2)."""
        side, direction = side_of(spaces, load.boundary), load.direction
        weights = side.weights / side.weights.sum()
        mean = np.zeros((spaces.size, 2))
        np.add.at(mean, side.functions, np.einsum("eq,eqa,i->eai", weights, side.values, direction))
        elements = len(side.functions) if load.follows else 0
        # the boundary runs anticlockwise, with the outward normal to its right
        tangents = np.stack([-side.normals[..., 1], side.normals[..., 0]], axis=-1)
        cosine = np.einsum("eqi,i->eq", tangents, direction)
        sine = tangents[..., 0] * direction[1] - tangents[..., 1] * direction[0]
        rotation = np.moveaxis(np.array([[cosine, -sine], [sine, cosine]]), (0, 1), (2, 3))
        stretches = np.einsum("eqJ,eqJb->eqb", tangents, side.gradients)
        blocks = np.einsum("eq,eqa,eqik,eqb->eaibk", weights, side.values, rotation, stretches)[:elements]
        offset = 0.0 if base is None else float(np.sum(mean * base))
        return cls(load.size, load.of_drive, mean, offset, side.functions[:elements], blocks)

    @property
    def loops(self) -> Loops:
        """See `isopeel.assembly.terms`."""
        return add_load

    @property
    def has_potential(self) -> bool:
        """Only a dead load has."""
        return not len(self.functions)

    def couplings(self) -> tuple[IntArray, ...]:
        """See `isopeel.assembly.terms`."""
        return (self.functions,) if len(self.functions) else ()

    def data(self, unknowns: IntArray) -> Packed:
        """See `isopeel.assembly.terms`."""
        (loaded,) = np.nonzero(self.pattern.any(axis=1))
        numbers = unknowns[self.functions]
        return packed(
            LoadData(
                self.size, self.of_drive, loaded, self.pattern[loaded], self.functions, self.blocks, numbers
            )
        )

    def forces(self, displacement: FloatArray) -> FloatArray:
        """q(u), (size, 2), for coefficients u (size, 2)."""
        turned = self.pattern.copy()
        np.add.at(
            turned,
            self.functions,
            np.einsum("eaibk,ebk->eai", self.blocks, displacement[self.functions]),
        )
        return turned

    def displacement(self, displacement: FloatArray) -> float:
        """Mean displacement of the boundary along the force, since the base state."""
        return float(np.sum(self.pattern * displacement)) - self.offset


def load_terms(
    spaces: Spaces, constraints: Constraints, base: FloatArray | None = None
) -> tuple[LoadTerm, ...]:
    """Return the loads of a problem that begins with a base state (size, 2): of its drive, and held ones.

    Raises InputError where all that is loaded is held along a component of the load.
    """
    problem = spaces.problem
    drive, loads = problem.drive, []
    if isinstance(drive, Load):
        loads += [_Loaded(*one, True, drive.direction, drive.follows) for one in problem.driven]
    loads += [_Loaded(one.boundary, one.force, False, one.direction, False) for one in problem.loads]
    terms = tuple(LoadTerm.of(load, spaces, base) for load in loads)
    for load, term in zip(loads, terms, strict=True):
        _check_free(problem.side_name(load.boundary), load, term.pattern, constraints)
    return terms


def _check_free(side: str, load: _Loaded, pattern: FloatArray, constraints: Constraints) -> None:
    """Raise InputError where a component of a load, of a pattern (size, 2), would press on a support alone.

    Its displacement along that component is zero whatever the force, so that one does not follow from the
    other. Where a part of the side is held, such as a corner that it shares with another one, the rest moves.
    """
    for component, name in enumerate("xy"):
        loaded = pattern[:, component] != 0
        if load.direction[component] and (constraints.unknowns[loaded, component] == HELD).all():
            loads = "the drive loads" if load.of_drive else "a load that is held acts on"
            allowed = f"{loads} the side {side} along {name}, and all of it is held along {name}"
            raise InputError("held", side, f"{allowed}; hold another side, or load this one across")
