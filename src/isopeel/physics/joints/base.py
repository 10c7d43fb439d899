"""Joint laws written as formulas at one point."""

from collections.abc import Callable
from dataclasses import fields
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeVar, dataclass_transform

import numpy as np

from isopeel.common.arrays import BoolArray, FloatArray
from isopeel.common.components import Component, named_dataclass
from isopeel.physics.batch import (
    ADHESION_SIGNATURE,
    JOINT_SIGNATURE,
    BatchFunction,
    compile_batch,
    joint_at,
)
from isopeel.physics.points import PointLoop, check_arguments, compile_points

Law = TypeVar("Law", bound="type[JointLaw]")


class HistoryVariable(NamedTuple):
    """A number that a joint stores at each point, committed with each accepted step."""

    name: str
    unit: str
    description: str


class JointLaw(Component):
    """The base of a law of the jump (d_n, d_t) between two faces, made by `joint_law` from its formulas.

    The opening d_n and the sliding d_t are zero where the faces were joined. `at_point` is compiled. Its
    arguments are what it needs of `opening`, `sliding` and the names of its history variables, and the
    numbers of `constants`, under names of their own. It returns, per reference area and zero at the joined
    faces,

        the stored and the dissipated energy; the derivatives of their sum E at a fixed history: E_n and E_t
        (attraction is positive); E_nn, E_nt and E_tt; and the history after a step to this jump.

    A joint law is also an adhesion law T(g): that of pure opening, d_t = 0, without damage.
    """

    table: ClassVar[str] = "adhesion"
    needed: ClassVar[tuple[tuple[str, ...], ...]] = (("work_of_adhesion",), ("at_point",))
    #: Its history; the assembly passes zeros where a law of pure opening is meant.
    history: ClassVar[tuple[HistoryVariable, ...]] = ()
    at_point: ClassVar[Callable[..., tuple[float, ...]]]

    if TYPE_CHECKING:

        @property
        def work_of_adhesion(self) -> float:
            """Energy per area to part the faces by opening alone."""

    def initial_history(self) -> tuple[float, ...]:
        """Return the history variables of the joined faces."""
        return (0.0,) * len(self.history)

    def softens(self, stiffness: FloatArray, _history: FloatArray) -> BoolArray:
        """Return whether (n,) points have passed their strength, of E_nn, E_nt, E_tt (3, n) and a history."""
        nn, nt, tt = stiffness
        softer: BoolArray = (nn + tt - np.hypot(nn - tt, 2 * nt)) < 0
        return softer

    @property
    def doubt(self) -> str:
        """Why results with these constants may be wrong; empty if nothing is known against them."""
        return ""

    @property
    def equilibrium_gap(self) -> float:
        """Opening of the joined faces: zero."""
        return 0.0

    def constants(self) -> tuple[float, ...]:
        """Numbers that the formulas need, in the order of their arguments: by default the fields."""
        return tuple(getattr(self, field.name) for field in fields(self))  # type: ignore[arg-type]

    @property
    def joint_parameters(self) -> FloatArray:
        """Numbers handed to the kernel of the joint law."""
        return np.array(self.constants(), dtype=np.float64)

    @property
    def joint_kernel(self) -> BatchFunction:
        """Batch function of `JOINT_SIGNATURE`."""
        kind: Any = type(self)
        names = tuple(variable.name for variable in self.history)
        loop = _loop(names)
        check_arguments(kind.at_point, loop.inputs, self.constants())
        return _joint_kernel(kind.at_point, names)

    @property
    def parameters(self) -> FloatArray:
        """Those of pure opening: the address of the kernel, which a float holds exactly, and more."""
        kernel, work = self.joint_kernel, self.work_of_adhesion
        return np.array([kernel.address, len(self.history), work, *self.constants()], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of `ADHESION_SIGNATURE` of pure opening: one for all laws."""
        return _opening_kernel()


@dataclass_transform(frozen_default=True)
def joint_law(law: Law) -> Law:
    """Make a subclass of `JointLaw` a law: a frozen dataclass with a name for case files."""
    return named_dataclass(law)


@cache
def _loop(history: tuple[str, ...]) -> PointLoop:
    return PointLoop(
        JOINT_SIGNATURE,
        "jump, history, parameters, count, energies, slopes, stiffness, later",
        {
            "opening": "jump[0, n]",
            "sliding": "jump[1, n]",
            **{name: f"history[{k}, n]" for k, name in enumerate(history)},
        },
        (
            *(f"energies[{k}, n]" for k in range(2)),
            *(f"slopes[{k}, n]" for k in range(2)),
            *(f"stiffness[{k}, n]" for k in range(3)),
            *(f"later[{k}, n]" for k in range(len(history))),
        ),
    )


@cache
def _joint_kernel(formulas: Callable[..., Any], history: tuple[str, ...]) -> BatchFunction:
    return compile_points(_loop(history), formulas)


@cache
def _opening_kernel() -> BatchFunction:
    return compile_batch(ADHESION_SIGNATURE, _of_pure_opening)


def _of_pure_opening(
    gap: FloatArray,
    _curvature: FloatArray,
    parameters: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    law, variables, work = joint_at(int(parameters[0])), int(parameters[1]), parameters[2]
    jump, history = np.zeros((2, count)), np.zeros((variables, count))
    energies, slopes, stiffness = np.empty((2, count)), np.empty((2, count)), np.empty((3, count))
    later = np.empty((variables, count))
    for n in range(count):
        jump[0, n] = gap[n]
    law(jump, history, parameters[3:], count, energies, slopes, stiffness, later)
    for n in range(count):
        potential[n] = energies[0, n] + energies[1, n] - work
        traction[n] = -slopes[0, n]
        derivative[n] = -stiffness[0, n]
