"""Table 2 of the published study: oscillation amplitude and steepest slopes, theirs beside ours."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from importlib import resources
from os import cpu_count
from typing import NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.errors import InputError
from isopeel.paper.study import MESHES, SPACES, STEP, WINDOW, Measurement, Run, measure_all
from isopeel.splines.names import parse_space_name


class Figures(NamedTuple):
    """dM, steepest rise and steepest fall per degree, times 1e3, in E0 L0^3."""

    amplitude: float
    rise: float
    fall: float


class Reading(Enum):
    """Two ways to read the plateau, since the published one is not told."""

    MEAN = "drift of the mean over a period taken out"
    LINE = "a line fitted to the window taken out of dM, slopes as they are"

    @property
    def caption(self) -> str:
        """What was done, in words."""
        return f"read between {WINDOW[0]:g} and {WINDOW[1]:g} degrees, {self.value}"

    def figures(self, measurement: Measurement) -> Figures | None:
        """The figures of a run; None where it ended before the window."""
        plateau = measurement.plateau if self is Reading.MEAN else measurement.by_line
        if plateau is None:
            return None
        kept = plateau.drift if self is Reading.LINE else 0.0
        rise, fall = plateau.steepest_rise + kept, plateau.steepest_fall + kept
        return Figures(1e3 * plateau.amplitude, 1e3 * rise, 1e3 * fall)


@dataclass(frozen=True)
class Published:
    """A row of the published table, in 1e-3 E0 L0^3 (per degree); None where nothing is printed."""

    amplitude: float | None
    rise: float | None
    fall: float | None
    note: str


def published(mesh: str) -> dict[str, Published]:
    """The published rows of one mesh, by the name of their space."""
    text = resources.files("isopeel").joinpath("paper", "table2.csv").read_text("utf-8")

    def number(value: str) -> float | None:
        return float(value) if value else None

    return {
        row["discretization"]: Published(
            number(row["dM_e3"]),
            number(row["max_slope_e3_per_deg"]),
            number(row["min_slope_e3_per_deg"]),
            row["note"],
        )
        for row in csv.DictReader(text.splitlines())
        if row["mesh"] == mesh
    }


def contact_row_only(space: str) -> str | None:
    """The space with the contact row alone enriched over linear rows; None for the linear space itself."""
    return None if space == "L1" else f"L1+{space}"


def show_table2(mesh: str, console: Console) -> None:
    """Measure all discretizations on a mesh, all rows enriched and the contact row alone; print the table.

    Raises InputError for an unknown mesh.
    """
    if mesh not in MESHES:
        raise InputError("--mesh", mesh, f"the published meshes are {', '.join(MESHES)}")
    names = [name for space in SPACES for name in (space, contact_row_only(space)) if name]
    # the costliest first, so that the processes end together
    names.sort(key=lambda name: -_cost(name))
    measured: dict[str, Measurement] = {}
    with console.status("tracing") as status:
        for measurement in measure_all([Run(name, mesh) for name in names], cpu_count() or 1):
            measured[measurement.run.space] = measurement
            status.update(f"{len(measured)} of {len(names)} runs traced")
    console.print(
        f"dM / steepest rise / steepest fall per degree, times 1e3, in E0 L0^3; steps of {STEP:g} degree"
    )
    for reading in Reading:
        console.print(table2(mesh, measured, reading))
    for space, row in published(mesh).items():
        if row.note:
            console.print(f"published {space}: {row.note}")
    for name, measurement in measured.items():
        if measurement.ended:
            console.print(f"{name} ended after {measurement.reached:g} degrees: {measurement.ended}")


def _cost(name: str) -> int:
    """Rough cost of a run: functions of an element, squared, times columns per element."""
    parsed = parse_space_name(name)
    return parsed.bulk.degree**2 * (parsed.bulk.degree - parsed.bulk.continuity) + parsed.contact.degree


def table2(mesh: str, measured: Mapping[str, Measurement], reading: Reading) -> Table:
    """Lay out dM / steepest rise / steepest fall, times 1e3, of each discretization in three columns."""
    nx, ny = MESHES[mesh]
    table = Table(title=f"{mesh}: {nx} x {ny} elements; {reading.caption}", box=SIMPLE_HEAD)
    for heading in ("space", "DOFs", "plateau", "all rows", "contact row only", "published"):
        table.add_column(heading, justify="left" if heading == "space" else "right")
    theirs = published(mesh)
    for space in SPACES:
        ours, contact = measured[space], contact_row_only(space)
        row = theirs[space]
        table.add_row(
            space,
            str(ours.dofs),
            "-" if ours.plateau is None else f"{ours.plateau.mean:.6f}",
            _entry(ours, reading),
            "" if contact is None else _entry(measured[contact], reading),
            "not converging"
            if row.amplitude is None
            else f"{row.amplitude:.4f} / {row.rise:.4f} / {row.fall:.4f}",
        )
    return table


def _entry(measurement: Measurement, reading: Reading) -> str:
    values = reading.figures(measurement)
    if values is None:
        return f"ended at {measurement.reached:g} deg"
    return " / ".join(f"{value:#.4g}" for value in values)
