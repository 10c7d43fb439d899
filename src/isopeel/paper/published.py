"""The tables of the published study as data, and their misprints."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import resources
from typing import Literal, NamedTuple, TypeAlias

from isopeel.common.errors import InputError

_FIGURES = ("dM_e3", "max_slope_e3_per_deg", "min_slope_e3_per_deg")
_PERCENTS = ("dM_percent", "max_slope_percent", "min_slope_percent")

Quantity: TypeAlias = Literal["DOFs", "amplitude", "rise", "fall"]


class Figures(NamedTuple):
    """Amplitude dM, steepest rise and steepest fall per degree, in 1e-3 E0 L0^3 as Table 2 prints them.

    Table 3 prints them in percent of those of L1.
    """

    amplitude: float
    rise: float
    fall: float


@dataclass(frozen=True)
class Published:
    """A row of the published Table 2, as printed; without figures if the study calls it not converging."""

    space: str
    mesh: str
    figures: Figures | None
    dofs_printed: int
    dofs_true: int  # with all rows in this space


@dataclass(frozen=True)
class Quoted:
    """An amplitude in 1e-3 E0 L0^3 quoted by the study, and the degrees of freedom of its space."""

    space: str
    mesh: str
    amplitude: float
    dofs: int


@dataclass(frozen=True)
class Misprint:
    """A wrong entry of Table 2 or 3, in units of that table, and the evidence that it is wrong."""

    table: int
    space: str
    mesh: str
    quantity: Quantity
    printed: float
    meant: float
    reason: str


def published(mesh: str) -> dict[str, Published]:
    """Table 2 on one of its meshes, by the name of the space, as printed; InputError for another mesh."""
    rows = [row for row in _rows("table2.csv") if row["dofs_printed"]]
    meshes = sorted({row["mesh"] for row in rows})
    if mesh not in meshes:
        raise InputError("mesh", mesh, f"the published meshes are {', '.join(meshes)}")
    return {
        row["discretization"]: Published(
            row["discretization"],
            mesh,
            _figures(row, _FIGURES) if row["dM_e3"] else None,
            int(row["dofs_printed"]),
            int(row["dofs_true"]),
        )
        for row in rows
        if row["mesh"] == mesh
    }


def quoted() -> tuple[Quoted, ...]:
    """Return the best amplitudes of the enriched contact element of Corbett and Sauer (2014), as quoted."""
    return tuple(
        Quoted(row["discretization"], row["mesh"], float(row["dM_e3"]), int(row["dofs_true"]))
        for row in _rows("table2.csv")
        if not row["dofs_printed"]
    )


def published_relative() -> dict[str, Figures]:
    """Table 3: Table 2 on m2 in percent of its L1, by the name of the space, as printed."""
    return {row["discretization"]: _figures(row, _PERCENTS) for row in _rows("table3.csv")}


def _figures(row: dict[str, str], columns: Iterable[str]) -> Figures:
    return Figures(*(float(row[column]) for column in columns))


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files("isopeel").joinpath("paper", name).read_text("utf-8")
    return list(csv.DictReader(text.splitlines()))


def _last_digit(space: str, quantity: Quantity, printed: float, meant: float, quotient: str) -> Misprint:
    reason = f"Table 2 gives {quotient}, which includes its own rounding"
    return Misprint(3, space, "m2", quantity, printed, meant, reason)


_DOFS = "it must be 2 (n_y + 1) ((n_x - 1)(p - c) + p + 1)"
#: Misprints that follow from the tables alone, for n_x by n_y elements, degree p and continuity c.
MISPRINTS = (
    Misprint(2, "N2", "m1", "DOFs", 2900, 2916, f"{_DOFS} = 2 x 9 x 162, and 2900 is no multiple of 18"),
    Misprint(
        2,
        "L2",
        "m2",
        "DOFs",
        6722,
        8822,
        f"{_DOFS} = 2 x 11 x 401, and 6722 is no multiple of 22. N8 would have 32 % less than 6722; it has "
        "48 % less than 8822, as on m1 and m3",
    ),
    Misprint(
        2,
        "N4.1",
        "m1",
        "fall",
        -0.0992,
        -0.992,
        "its decimal point is probably misplaced. All other values become smaller on finer meshes, but "
        "this one would grow to -0.3519 on m2. And if the moment rises by dM = 0.2944 at 0.3188 per degree "
        "at most, it must fall by 0.69 per degree or more in the rest of the period of 1.35 degrees",
    ),
    # five of them are truncated, not rounded
    _last_digit("L2", "amplitude", 26.74, 26.75, "26.7489 +- 0.0011"),
    _last_digit("L4", "fall", 3.23, 3.24, "3.2370 +- 0.0001"),
    _last_digit("N2", "amplitude", 76.79, 76.80, "76.7982 +- 0.0016"),
    _last_digit("N2.1", "fall", 1.97, 1.98, "1.9769 +- 0.0001"),
    _last_digit("N4.1", "amplitude", 1.79, 1.80, "1.7969 +- 0.0009"),
    _last_digit("N8", "fall", 10.05, 10.04, "10.0447 +- 0.0001"),
)


def meant(row: Published) -> Figures | None:
    """Return the values of a row with its misprints corrected."""
    if row.figures is None:
        return None
    corrected = {
        m.quantity: m.meant
        for m in MISPRINTS
        if m.table == 2 and (m.space, m.mesh) == (row.space, row.mesh) and m.quantity != "DOFs"
    }
    return row.figures._replace(**corrected)
