"""The forces of an interface on its two bodies: equal, opposite, and without a moment."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import pi

import numpy as np
from matplotlib.figure import Figure

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import Exponential
from isopeel.physics.joints import MixedModeBilinear
from isopeel.physics.materials import NeoHooke
from isopeel.post.style import BLUE, VERMILION
from isopeel.problem import Body, Interface, MovedSide, Problem, Support
from isopeel.problem.place import placed
from isopeel.report.document import Picture
from isopeel.splines.nurbs import annulus_sector, rectangle
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row
from isopeel.validation.one_panel import one_panel

#: Sums of as many forces as there are functions, which cancel each other in part.
ROUND_OFF = 1e-11
_LAW = Exponential(0.3, 0.1)
_JOINT = MixedModeBilinear(0.3, 0.2, 0.1, 0.15, 0.3)
_LOWER = Body(placed(rectangle(10.0, 2.0), (0.0, -2.0), 0.0), NeoHooke(1.0, 0.3), "lower")
#: A sector of a ring, hollow downwards.
_BENT = placed(annulus_sector(12.0, 13.0, 0.5), (5.0, -11.6), pi / 2 - 0.25)
_UPPER = Body(_BENT, NeoHooke(1.0, 0.3), "upper")
_SIDES = _UPPER.side("bottom"), _LOWER.side("top")
_JOINTS = {
    "unbiased": Interface(_SIDES[0], _LAW, _SIDES[1]),
    "biased": Interface(_SIDES[0], _LAW, _SIDES[1], scheme="biased"),
    "fixed pairs": Interface(_SIDES[0], _JOINT, _SIDES[1]),
    "two-half-pass": Interface(_SIDES[0], _LAW, _SIDES[1], scheme="two-half-pass"),
}
_SIZE = 0.05  # of the displacement of each control point


@dataclass(frozen=True, eq=False)
class Forces:
    """Forces (n, 2) of an interface on control points x (n, 2), of the upper body and of the lower one."""

    joint: str
    position: tuple[FloatArray, FloatArray]
    forces: tuple[FloatArray, FloatArray]

    @property
    def sums(self) -> FloatArray:
        """Force along x and y, and moment about the origin, on both bodies (2, 3)."""
        sums = []
        for x, forces in zip(self.position, self.forces, strict=True):
            moment = np.sum(x[:, 0] * forces[:, 1] - x[:, 1] * forces[:, 0])
            sums.append([*forces.sum(axis=0), moment])
        return np.array(sums)


def forces_of(joint: str) -> Forces:
    """Compute the forces of an interface, which is chosen by its name."""
    held = (Support(_LOWER.side("bottom"), (0, 1)),)
    drive = MovedSide(_UPPER.side("top"), 1.0, "held")
    problem = Problem("momentum", (_UPPER, _LOWER), (_JOINTS[joint],), held, drive)
    spaces = {"upper": row_space("N2", (7, 2), 2, shape=_BENT), "lower": row_space("N2.1", (11, 2), 2)}
    system = System(problem, spaces)
    u = _SIZE * np.random.default_rng(0).standard_normal((system.spaces.size, 2))
    forces = system.equilibrium(u).forces - system.without_joint().equilibrium(u).forces
    x = system.spaces.control_points() + u
    above, below = (system.spaces.places[name] for name in ("upper", "lower"))
    return Forces(joint, (x[above], x[below]), (forces[above], forces[below]))


def judge(outcomes: Sequence[Forces]) -> Result:
    """Compare the force and the moment on the upper body with those on the lower one."""
    rows = []
    for found in outcomes:
        allowed = None if found.joint == "two-half-pass" else ROUND_OFF
        for name, upper, lower in zip(("force x", "force y", "moment"), *found.sums, strict=True):
            rows.append(Row(float(upper), -float(lower), allowed, (found.joint, name)))
    return Result(
        quantity="force / E0 L0 and moment about the origin / E0 L0^2",
        text=(
            "A bent body lies above a straight one, on a mesh that does not match, and all control points of"
            " both are displaced at random: {momentum-forces}. The force and the moment of the interface on"
            " the upper body must be opposite to those on the lower one, as its energy does not change if"
            " both bodies move together. This holds to round-off for both energies, and for the joint of"
            " fixed pairs of points. Two half passes have no energy: each side is loaded by its own"
            " integration points, and the forces differ by the quadrature error."
        ),
        settings=(
            ("bodies", "10 x 2 and a sector of a ring, radii 12 and 13, angle 0.5"),
            ("laws", "exponential; for fixed pairs mixed-mode-bilinear"),
            ("space", "N2, 7 x 2 elements, on N2.1, 11 x 2"),
            ("displacement", f"normal distribution of size {_SIZE:g}"),
        ),
        columns=("interface", "number"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "momentum-forces",
                "The forces of the energy `unbiased` on the control points of the upper body and of the"
                " lower one.",
                partial(_draw, outcomes[0]),
            ),
        ),
    )


def _draw(found: Forces) -> Figure:
    with one_panel("$x$ / $L_0$", "$y$ / $L_0$", 2.0) as (figure, axes):
        for k, (name, color) in enumerate((("upper", BLUE), ("lower", VERMILION))):
            loaded = np.abs(found.forces[k]).max(axis=1) > 0
            place, forces = found.position[k][loaded], found.forces[k][loaded]
            axes.quiver(*place.T, *forces.T, color=color, label=name, width=4e-3, scale=1.5)
        axes.set_ylim(-0.7, 1.3)
        axes.legend(loc="upper right")
    return figure


CHECK = Check("Momentum", tuple(_JOINTS), forces_of, judge)
