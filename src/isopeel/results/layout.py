"""The layout of the arrays of a run: the functions of each body, and the points of each interface."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from typing import Self

import h5py
import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.assembly.tables import side_points
from isopeel.common.arrays import FloatArray
from isopeel.physics.joints import HistoryVariable
from isopeel.problem import Problem
from isopeel.problem.interface import MAXIMUM_OPENING
from isopeel.results import untrusted
from isopeel.results.schema import check_values, write_described
from isopeel.results.spaces import write_space
from isopeel.results.untrusted import UntrustedError
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.rows import RowSpace

#: Interfaces that the file of a run may have.
_MOST = 1000
#: Variables that the history of one of them may have.
_MOST_VARIABLES = 100


@dataclass(frozen=True)
class Layout:
    """Spaces and shapes by the names of bodies, and elements and points of each interface by its name.

    The variables are those of the history of an interface; by default the maximum opening.
    """

    bodies: Mapping[str, tuple[RowSpace, NurbsSurface]] = field(default_factory=dict)
    interfaces: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    variables: Mapping[str, tuple[HistoryVariable, ...]] = field(default_factory=dict)

    @classmethod
    def of(cls, problem: Problem, space: SpaceOfBodies, contact_points: int | None = None) -> Self:
        """Return the layout of a problem on its spaces."""
        spaces = spaces_by_name(problem, space)
        boundaries = [interface.boundary for interface in problem.faces]
        shapes = [
            side_points(spaces[one.body], one.side, one.part, contact_points)[0].shape for one in boundaries
        ]
        return cls(
            {body.name: (spaces[body.name], body.shape) for body in problem.bodies},
            dict(zip(problem.interface_names, shapes, strict=True)),
            {
                name: interface.history_variables
                for name, interface in zip(problem.interface_names, problem.faces, strict=True)
            },
        )

    def write_spaces(self, file: h5py.File) -> None:
        """Write the groups `spaces/NAME`, each with the number of its first function among all."""
        first = 0
        for name, (space, shape) in self.bodies.items():
            write_space(file, name, space, shape)
            file[f"spaces/{name}"].attrs["first"] = first
            first += space.size

    def write_history(self, file: h5py.File, maximum_openings: Sequence[FloatArray]) -> None:
        """Write the history of states, `history/NAME/VARIABLE` (states, elements, points).

        The attribute `first` is the place of the first value among those of all interfaces and variables.
        """
        first, flat = 0, np.array([one.ravel() for one in maximum_openings])
        for name, shape in (self.interfaces or {"interface": maximum_openings[0].shape}).items():
            for variable in self.variables.get(name, (MAXIMUM_OPENING,)):
                values = flat[:, first : first + prod(shape)].reshape(-1, *shape)
                described = {"unit": variable.unit, "description": variable.description}
                write_described(file, f"history/{name}/{variable.name}", values, first=first, **described)
                first += prod(shape)


def read_history(file: h5py.File, states: int, shape: tuple[int, ...]) -> FloatArray | None:
    """Return the history (states, *shape) of all interfaces; None if the file has none.

    Raises UntrustedError if they have another number of states, or another shape than in the last state.
    """
    if "history" not in file:
        return None
    history = untrusted.group(file, "history")
    if len(history) > _MOST:
        raise UntrustedError(f"it has more than {_MOST} interfaces")
    found: dict[float, FloatArray] = {}
    for name in history:
        of_one = untrusted.group(history, name)
        if len(of_one) > _MOST_VARIABLES:
            raise UntrustedError(f"an interface has more than {_MOST_VARIABLES} variables")
        for variable in of_one:
            values = untrusted.floats(of_one, variable, 3)
            check_values(of_one[variable], values, finite=True)
            found[untrusted.number(of_one[variable], "first")] = values.reshape(len(values), -1)
    parts = [found[first] for first in sorted(found)]
    points = sum(part.shape[1] for part in parts)
    if {len(part) for part in parts} != {states} or points != prod(shape):
        raise UntrustedError("its history is of other states, or of other interfaces")
    joined: FloatArray = np.concatenate(parts, axis=1).reshape(states, *shape)
    return joined
