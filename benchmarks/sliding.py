"""A cylinder that slides, or rolls, along a strip: how the force oscillates as it passes the elements."""

import sys
from dataclasses import dataclass, field, replace
from math import cos, pi, sin
from time import process_time
from typing import Annotated, ClassVar

import numpy as np
import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

import isopeel
from isopeel import Body, Contact, Interface, MovedSide, NeoHooke, Problem, Step, Support, row_space, trace
from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import LENGTH, Dimension
from isopeel.problem import Drive, Scheme
from isopeel.problem.boundary import Place
from isopeel.problem.drives.base import DISPLACEMENT, FORCE, Column, Freedom
from isopeel.problem.place import placed
from isopeel.problem.shapes.curved_strip import CurvedStrip
from isopeel.solve.newton import NewtonSettings
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import RowSpace
from machine import description

#: Of the rigid hub with the soft layer, in L0, and of both layers; E0 is their modulus.
RADIUS, HEIGHT, MATERIAL = 1.0, 0.3, NeoHooke(1.0, 0.3)
#: The layer is pressed so far that the contact is one WIDTH wide, 1.00 to 1.05 measured.
PRESSED, WIDTH = 0.004, 0.1
#: Widths of the strip beyond both ends of the path, and half of those of the layer of a cylinder that slides.
_MARGIN = 3.0
#: Elements across, and the size of the last one over the first one, from the contact on.
_ACROSS, _GRADING = 5, 8.0
_SETTINGS = NewtonSettings(path_control="auto")
#: Degree of the polynomial that is subtracted from the forces: the strip has ends.
_TREND = 8


@dataclass(frozen=True)
class Rolled:
    """A hub that rolls: its centre moves along x, and it turns clockwise by the distance over the radius."""

    name: ClassVar[str] = "rolling"
    on: Place
    centre: tuple[float, float]
    parameter_dimension: Dimension = LENGTH
    parameter_column: Column = DISPLACEMENT
    reaction_column: Column = FORCE
    freedoms: tuple[Freedom, Freedom] = ("prescribed", "prescribed")

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """Return the displacement (n, 2) of points (n, 2) at a distance."""
        x, y = (points - self.centre).T
        angle = -parameter / RADIUS
        turned = np.stack([cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y], axis=1)
        moved: FloatArray = turned - np.stack([x, y], axis=1) + [parameter, 0.0]
        return moved

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:
        """Return its derivative by the distance."""
        x, y = (points - self.centre).T
        angle = -parameter / RADIUS
        slope = np.stack([-sin(angle) * x - cos(angle) * y, cos(angle) * x - sin(angle) * y], axis=1)
        rate: FloatArray = -slope / RADIUS + [1.0, 0.0]
        return rate


@dataclass(frozen=True)
class Setting:
    """A cylinder on a strip, whose elements have functions of a name, along a path of so many widths."""

    rolls: bool
    space: str
    smoothed: bool = False
    scheme: Scheme = "unbiased"
    elements: float = 20.0  # of the strip on one width; the layer of the cylinder has 0.9 as many
    widths: float = 10.0
    points: int | None = None  # Gauss points on an element
    law: Contact = field(default_factory=Contact)

    @property
    def label(self) -> str:
        """The row of a table."""
        master = f"{self.space}, smoothed" if self.smoothed else self.space
        return f"{'rolls' if self.rolls else 'slides'}, {master}"

    @property
    def start(self) -> float:
        """Place of the cylinder at the start; the path has its middle at zero."""
        return -self.widths * WIDTH / 2

    @property
    def lengths(self) -> tuple[float, float]:
        """Of the layer and of the strip."""
        strip = (self.widths + 2 * _MARGIN) * WIDTH
        return strip if self.rolls else 2 * _MARGIN * WIDTH, strip

    def spaces(self) -> dict[str, RowSpace]:
        """Return the spaces of both bodies; their elements are the smallest at the contact."""
        layer, strip = (round(length / WIDTH * self.elements) for length in self.lengths)
        return {
            "roller": row_space("N2", (round(0.9 * layer), _ACROSS), 2, (1.0, _GRADING)),
            "strip": row_space(self.space, (strip, _ACROSS), 2, (1.0, 1 / _GRADING)),
        }

    def problem(self, drive: str) -> Problem:
        """Return the problem, with the drive that presses, slides or rolls the cylinder."""
        arc, length = self.lengths
        # a cylinder that rolls has the middle of its layer at the contact in the middle of the path
        turned = -self.start / RADIUS if self.rolls else 0.0
        angle = turned - arc / RADIUS / 2
        layer = CurvedStrip(arc, HEIGHT, RADIUS, "up").surface()
        at = self.start + RADIUS * sin(angle), RADIUS - RADIUS * cos(angle)
        roller = Body(placed(layer, at, angle), MATERIAL, "roller")
        strip = Body(placed(rectangle(length, HEIGHT), (-length / 2, -HEIGHT), 0.0), MATERIAL, "strip")
        hub = roller.side("top")
        drives: dict[str, Drive] = {
            "press": MovedSide(hub, -pi / 2, "held"),
            "slide": MovedSide(hub, 0.0, "held"),
            "roll": Rolled(hub, (self.start, RADIUS - PRESSED)),
        }
        joint = Interface(
            roller.side("bottom"), self.law, strip.side("top"), scheme=self.scheme, smoothed=self.smoothed
        )
        held = (Support(strip.side("bottom"), (0, 1)),)
        return Problem("cylinder on a strip", (roller, strip), (joint,), held, drives[drive])


@dataclass(frozen=True, eq=False)
class Found:
    """The forces of a path, and how wide the contact is at its start."""

    setting: Setting
    place: FloatArray  # (n,) of the cylinder
    normal: FloatArray  # (n,) force that presses
    tangential: FloatArray  # (n,) force that moves
    width: float
    steps: int  # with those between
    seconds: float

    @property
    def oscillation(self) -> float:
        """The largest difference of the normal force from its trend, as a share of the mean force."""
        left = self.normal - np.polynomial.Polynomial.fit(self.place, self.normal, _TREND)(self.place)
        return float(np.abs(left).max() / self.normal.mean())

    @property
    def change(self) -> float:
        """The largest change of the normal force from step to step, as a share of the mean force."""
        return float(np.abs(np.diff(self.normal)).max() / self.normal.mean())

    @property
    def resistance(self) -> float:
        """The largest tangential force, as a share of the mean normal force; without friction it is zero."""
        return float(np.abs(self.tangential).max() / self.normal.mean())


def run(setting: Setting, step: float = 0.37) -> Found:
    """Press the cylinder and move it by steps that are a share of an element."""
    began = process_time()
    spaces = setting.spaces()
    press = setting.problem("press")
    path = np.linspace(0.0, PRESSED, 9)[1:]
    *_, last = trace(press, spaces, path, _SETTINGS, contact_points=setting.points)
    points = InterfacePoints.of_contact(press, spaces, setting.points, "roller.bottom")
    state = points.state(last.displacement, last.maximum_openings)
    wide = float(np.ptp(state.position[state.normal_traction > 0][:, 0]))
    count = round(setting.widths * setting.elements / step)
    place, forces, steps = [], [], 0
    # a stage for each width: the order of the unknowns follows the contact
    every = round(setting.elements / step)
    for first in range(0, count, every):
        here = first * step * WIDTH / setting.elements
        drive = setting.problem("roll" if setting.rolls else "slide")
        if isinstance(drive.drive, Rolled):
            drive = _further(drive, drive.drive, here)
        stage = step * WIDTH / setting.elements * np.arange(min(every, count - first) + 1)
        system = System(drive, spaces, setting.points, last.displacement)
        hub = system.spaces.boundary(drive.driven[0].boundary)
        found: list[Step] = []
        for one in trace(drive, spaces, stage, _SETTINGS, base=last.state, contact_points=setting.points):
            found.append(one)
            if one.kind == "requested" and one.parameter > 0:
                at = system.after(one.maximum_openings).equilibrium(one.displacement)
                forces.append(at.forces[hub].sum(axis=0))
                place.append(setting.start + here + one.parameter)
        last, steps = found[-1], steps + len(found)
    tangential, normal = np.array(forces).T
    return Found(setting, np.array(place), -normal, tangential, wide, steps, process_time() - began)


def _further(problem: Problem, drive: Rolled, distance: float) -> Problem:
    """Return the problem with a hub that has rolled by a distance."""
    x, y = drive.centre
    return replace(problem, drive=replace(drive, centre=(x + distance, y)))


def table(paths: list[Found]) -> Table:
    """Return the forces of paths."""
    result = Table(
        "", "contact width", "mean force", "oscillation", "change a step", "tangential", "steps", "seconds",
        box=SIMPLE_HEAD,
    )  # fmt: skip
    for column in result.columns[1:]:
        column.justify = "right"
    result.columns[0].no_wrap = True
    for found in paths:
        result.add_row(
            found.setting.label,
            f"{found.width:.4f}",
            f"{found.normal.mean():.6f}",
            f"{found.oscillation:.1e}",
            f"{found.change:.1e}",
            f"{found.resistance:.1e}",
            str(found.steps),
            f"{found.seconds:.0f}",
        )
    result.caption = "oscillation: largest difference from the trend; all but the mean force as shares of it"
    return result


def main(
    elements: Annotated[float, typer.Option(min=2, help="Elements of the strip on a contact width.")] = 20.0,
    widths: Annotated[float, typer.Option(min=0.5, help="Length of the path in contact widths.")] = 10.0,
    space: Annotated[list[str] | None, typer.Option(help="Only these functions of the strip.")] = None,
    step: Annotated[float, typer.Option(min=0.05, max=1, help="A step as a share of an element.")] = 0.37,
) -> None:
    """Compare strips of smooth and of Lagrange elements, the latter also smoothed."""
    console = Console(highlight=False, width=110)
    console.print(f"{elements:g} elements on a contact width, a path of {widths:g} widths")
    kinds = (("N2", False), ("L2", False), ("L2", True), ("L1", False), ("L1", True))
    paths = []
    for rolls in (False, True):
        for name, smoothed in kinds:
            if not space or name in space:
                setting = Setting(rolls, name, smoothed, elements=elements, widths=widths)
                paths.append(run(setting, step))
    console.print(table(paths))
    console.print(description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except (isopeel.InputError, ArithmeticError) as error:
        sys.exit(f"sliding: {error}")
