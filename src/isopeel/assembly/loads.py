"""The load of a drive on a space: its force on every coefficient, and how that turns with the body."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from isopeel.assembly.constraints import HELD, Constraints
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import side_of
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.matrix.band import BandMatrix
from isopeel.problem import Boundary, Load
from isopeel.splines.nurbs import Side


@dataclass(frozen=True, eq=False)
class AssembledLoad:
    """Forces q(u) of a load of one per unit width; q . du is the mean displacement of the loaded part.

    A dead load has q = q0; one that follows has the traction Q dx/ds, with x the deformed side, s its
    reference length and Q the rotation from the side's tangent to the force. That is linear in u: q0 + B u.
    """

    load: Load
    pattern: FloatArray  # q0 (size, 2), which also weighs the coefficients of the mean displacement
    offset: float  # mean displacement in the base state, from where it counts
    functions: IntArray  # (E, m)
    blocks: FloatArray  # B by elements, (E, m, 2, m, 2); no elements for a dead load
    places: tuple[IntArray, IntArray]  # unknowns of the rows and columns of B, (E, m, 2, m, 2)

    @classmethod
    def of(
        cls,
        spaces: Spaces,
        constraints: Constraints,
        base: FloatArray | None = None,
    ) -> Self | None:
        """Integrate the load of a drive that begins with a base state (size, 2); None where it has none.

        Raises InputError where all that is loaded is held along a component of the load.
        """
        problem = spaces.problem
        drive, load = problem.drive, problem.drive.load
        if load is None:
            return None
        side = side_of(spaces, Boundary(problem.driven, drive.side, load.start, load.end))
        weights = side.weights / side.weights.sum()
        mean = np.zeros((spaces.size, 2))
        np.add.at(mean, side.functions, np.einsum("eq,eqa,i->eai", weights, side.values, load.direction))
        _check_free(drive.side, load, mean, constraints)
        elements = len(side.functions) if load.follows else 0
        # the boundary runs anticlockwise, with the outward normal to its right
        tangents = np.stack([-side.normals[..., 1], side.normals[..., 0]], axis=-1)
        cosine = np.einsum("eqi,i->eq", tangents, load.direction)
        sine = tangents[..., 0] * load.direction[1] - tangents[..., 1] * load.direction[0]
        rotation = np.moveaxis(np.array([[cosine, -sine], [sine, cosine]]), (0, 1), (2, 3))
        stretches = np.einsum("eqJ,eqJb->eqb", tangents, side.gradients)
        blocks = np.einsum("eq,eqa,eqik,eqb->eaibk", weights, side.values, rotation, stretches)[:elements]
        numbers = constraints.unknowns[side.functions[:elements]]
        rows, columns = np.broadcast_arrays(numbers[:, :, :, None, None], numbers[:, None, None])
        offset = 0.0 if base is None else float(np.sum(mean * base))
        return cls(load, mean, offset, side.functions[:elements], blocks, (rows, columns))

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
        """Mean displacement of the loaded part along the force, since the base state."""
        return float(np.sum(self.pattern * displacement)) - self.offset

    def add_stiffness(self, matrix: BandMatrix, size: float) -> None:
        """Add -size B to a matrix in the general storage."""
        rows, columns = self.places
        inside = (rows != HELD) & (columns != HELD)
        matrix.add(rows[inside], columns[inside], -size * self.blocks[inside])


def _check_free(side: Side, load: Load, pattern: FloatArray, constraints: Constraints) -> None:
    """Raise InputError where a component of a load, of a pattern (size, 2), would press on a support alone.

    Its displacement along that component is zero whatever the force, so that one does not follow from the
    other. Where a part of the side is held, such as a corner that it shares with another one, the rest moves.
    """
    for component, name in enumerate("xy"):
        loaded = pattern[:, component] != 0
        if load.direction[component] and (constraints.unknowns[loaded, component] == HELD).all():
            allowed = f"the drive loads the side {side} along {name}, and all of it is held along {name}"
            raise InputError("held", side, f"{allowed}; hold another side, or load this one across")
