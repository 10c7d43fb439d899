"""How the parameter of a drive enters the equations, and the reaction to it.

A constraint prescribes displacements, and its reaction is a force. Of a load the parameter is its size, and
the reaction a displacement; or the parameter is the displacement, and the size is an unknown, and the
reaction.
"""

from dataclasses import dataclass

import numpy as np

from isopeel.assembly.constraints import Constraints
from isopeel.assembly.load_term import LoadTerm
from isopeel.common.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Control:
    """A drive on spaces: the constraints, or the loads of the boundaries that it acts on."""

    constraints: Constraints
    loads: tuple[LoadTerm, ...]  # none of a constraint
    factors: tuple[float, ...]  # of the boundaries

    @property
    def raises_load(self) -> bool:
        """Whether the parameter is the size of a load, so that the reaction is a displacement."""
        return bool(self.loads) and not self.constraints.global_unknowns

    def load(self, unknown_values: FloatArray, parameter: float) -> float:
        """Size of the load, of unknowns y (count,) at a parameter; without a load it has no meaning."""
        return float(unknown_values[-1]) if self.constraints.global_unknowns else parameter

    def pattern(self) -> FloatArray:
        """Coefficients (size, 2) of the displacement on which the load works, in the base state's shape."""
        return self._total([load.pattern for load in self.loads])

    def displacement(self, displacement: FloatArray) -> float:
        """Displacement on which the load works: of each boundary the factor times its mean."""
        return sum((load.size * load.displacement(displacement) for load in self.loads), 0.0)

    def reaction(self, forces: FloatArray, displacement: FloatArray, load: float, parameter: float) -> float:
        """What works on the parameter: a force or moment, the load, or its displacement."""
        if self.raises_load:
            return self.displacement(displacement)
        if self.constraints.global_unknowns:
            return load
        return self.constraints.reaction(forces, parameter)

    def reactions(
        self, forces: FloatArray, displacement: FloatArray, load: float, parameter: float
    ) -> tuple[float, ...]:
        """The same of each boundary: without its factor; of a load that is found, the force on it."""
        if self.raises_load:
            return tuple(one.displacement(displacement) for one in self.loads)
        if self.constraints.global_unknowns:
            return tuple(one.size * load for one in self.loads)
        return tuple(one.reaction(forces, parameter) for one in self.constraints.motions)

    def potential(self, energy: float, load: float, reaction: float) -> tuple[float, float]:
        """Return the energy with that of the load, and its derivative by the parameter along a path."""
        return (energy - load * reaction, -reaction) if self.raises_load else (energy, reaction)

    def equation(self, displacement: FloatArray, parameter: float) -> tuple[float, FloatArray, FloatArray]:
        """Return the error of an unknown load's displacement, and the last column and row of the tangent."""
        missed = parameter - self.displacement(displacement)
        forces = self._total([load.forces(displacement) for load in self.loads])
        condense = self.constraints.condense
        return missed, -condense(forces), -condense(self.pattern())

    def _total(self, forces: list[FloatArray]) -> FloatArray:
        total: FloatArray = np.zeros(self.constraints.offset.shape)
        for load, pulls in zip(self.loads, forces, strict=True):
            total += load.size * pulls
        return total
