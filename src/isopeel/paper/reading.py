"""Definitions of dM and the steepest slopes of a curve: several, as the published one is not known."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from math import log

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.paper.published import MISPRINTS, Figures, published
from isopeel.paper.record import Record
from isopeel.paper.study import MESHES, STEP, Run, default_points
from isopeel.post.closed_form import beam_peeling
from isopeel.post.plateau import read_window, running_mean
from isopeel.problem import Traction, strip

Window = tuple[float, float]
#: The default window of this report, in degrees.
WINDOW: Window = (98.0, 101.4)


class Reading(Enum):
    """How the drift of the plateau is removed before dM and the slopes are read."""

    MEAN = "drift of the running mean subtracted"
    LINE = "line in the window subtracted from dM"
    RAW = "nothing subtracted"


class Rows(Enum):
    """The rows of control points that have the space named by a row of the published table."""

    ALL = "all rows"
    CONTACT = "contact row only, over L1"
    ELEVATED = "elevated in the contact row only"

    def enriched(self, space: str) -> str:
        """Return the space that a published name stands for.

        L2 and L4 are elevations of L1, and Np.q is an elevation of Np: ELEVATED has them in the contact row,
        and the space that they elevate in the other rows. L1 and Np are no elevations.
        """
        if self is Rows.ALL or space == "L1":
            return space
        if self is Rows.CONTACT or space.startswith("L"):
            return f"L1+{space}"
        smooth, _, elevations = space.partition(".")
        return f"{smooth}+{space}" if elevations else space


class Points(Enum):
    """Gauss points of the adhesive force on an element, for functions of degree p."""

    DEFAULT = "p + 1"
    MORE = "p + 2"
    LESS = "p, at least 2"
    TWO = "2"
    THREE = "3"

    def count(self, space: str) -> int | None:
        """Return the number of points on a space; None for the default."""
        default = default_points(space)
        number = {
            Points.DEFAULT: default,
            Points.MORE: default + 1,
            Points.LESS: max(2, default - 1),
            Points.TWO: 2,
            Points.THREE: 3,
        }[self]
        return None if number == default else number


@cache
def period_deg(mesh: str) -> float:
    """Return the period of the oscillation on a mesh, in degrees: the passage of one element."""
    closed_form = beam_peeling(strip())
    assert closed_form is not None  # it is a strip
    return closed_form.period_deg(MESHES[mesh][0])


class Readable:
    """A record whose running mean is computed once for all windows."""

    def __init__(self, record: Record) -> None:
        self._angles, self._moments = record.angles_deg, record.moments
        self._period = period_deg(record.run.mesh)
        self._mean: FloatArray | None = None

    def read(self, window: Window, reading: Reading = Reading.MEAN) -> Figures | None:
        """Return the figures in a window, in 1e-3 E0 L0^3 (per degree); None where the run does not cover it.

        A run covers a window if it reached half a period beyond it, for all readings.
        """
        margin = self._period / 2
        if not len(self._angles) or self._angles[-1] < window[1] + margin - STEP / 2:
            return None
        if self._mean is None:
            self._mean = running_mean(self._angles, self._moments, self._period)
        mean = self._mean if reading is Reading.MEAN else None
        plateau = read_window(self._angles, self._moments, window, mean)
        drift, amplitude = plateau.drift, plateau.amplitude
        if reading is Reading.MEAN:
            drift = 0.0
        elif reading is Reading.RAW:
            inside = (self._angles > window[0] - STEP / 2) & (self._angles < window[1] + STEP / 2)
            amplitude = float(np.ptp(self._moments[inside]))
        values = (amplitude, plateau.steepest_rise + drift, plateau.steepest_fall + drift)
        return Figures(*(1e3 * value for value in values))


def plateau_mean(record: Record, window: Window = WINDOW) -> float | None:
    """Return the mean moment in a window, in E0 L0^3; None where the run does not cover it."""
    angles = record.angles_deg
    if not len(angles) or angles[-1] < window[1] - STEP / 2:
        return None
    inside = (angles > window[0] - STEP / 2) & (angles < window[1] + STEP / 2)
    return float(record.moments[inside].mean())


@dataclass(frozen=True)
class Recipe:
    """A definition of the figures of the published table, by which they are computed from our curves."""

    rows: Rows
    reading: Reading = Reading.MEAN
    window: Window = WINDOW
    traction: Traction = "reference"
    points: Points = Points.DEFAULT

    def run(self, space: str, mesh: str) -> Run:
        """Return the run of a published discretization."""
        enriched = self.rows.enriched(space)
        return Run(enriched, mesh, self.traction, self.points.count(enriched))


@dataclass(frozen=True)
class Fit:
    """How a recipe fits: for each published entry the ratio of ours to theirs."""

    recipe: Recipe
    ratios: Mapping[tuple[str, str, str], float]  # by mesh, space, and name of the figure
    unread: int  # entries that cannot be compared: the run ended early, or ours has another sign

    @property
    def deviation(self) -> float:
        """Mean magnitude of the logarithms of the ratios; with squares, one misfit could decide."""
        return sum(abs(log(ratio)) for ratio in self.ratios.values()) / len(self.ratios)


def fits(readables: Mapping[Run, Readable], meshes: Iterable[str], recipes: Iterable[Recipe]) -> list[Fit]:
    """Return the fits of recipes to the published table: first the most comparable entries, then the closest.

    Entries that are known to be misprinted do not count.
    """
    misprinted = {(m.mesh, m.space, m.quantity) for m in MISPRINTS if m.table == 2}
    theirs = [
        (mesh, space, name, value)
        for mesh in meshes
        for space, row in published(mesh).items()
        if row.figures is not None
        for name, value in row.figures._asdict().items()
        if (mesh, space, name) not in misprinted
    ]
    known: dict[tuple[Run, Reading, Window], Figures | None] = {}
    found = []
    for recipe in recipes:
        ratios = {}
        for mesh, space, name, value in theirs:
            run = recipe.run(space, mesh)
            key = run, recipe.reading, recipe.window
            if key not in known:
                readable = readables.get(run)  # None for a variant of a run that ended early
                known[key] = readable.read(recipe.window, recipe.reading) if readable else None
            figures = known[key]
            ratio = 0.0 if figures is None else getattr(figures, name) / value
            if ratio > 0:
                ratios[mesh, space, name] = ratio
        if ratios:
            found.append(Fit(recipe, ratios, len(theirs) - len(ratios)))
    return sorted(found, key=lambda fit: (fit.unread, fit.deviation))


def candidate_windows(lengths: Iterable[float]) -> list[Window]:
    """Return windows of given lengths that begin at 85 to 107 degrees, in steps of a half."""
    starts = np.round(np.arange(85.0, 107.01, 0.5), 10).tolist()
    return [(start, start + length) for length in lengths for start in starts]
