"""The runs of the published study, and further runs that show what its figures depend on."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from isopeel.case import Case, load_case
from isopeel.common.arrays import FloatArray
from isopeel.common.fingerprint import code_fingerprint
from isopeel.problem import Traction
from isopeel.splines.names import parse_space_name

#: Sizes of the strip, in L0 = 1 nm.
LENGTH = 200.0
#: Elements along x and y of the published meshes.
MESHES = {"m1": (160, 8), "m2": (200, 10), "m3": (240, 12)}
#: The published discretizations, in the order of the published table.
SPACES = ("L1", "L2", "L4", "N2", "N4", "N6", "N8", "N2.1", "N4.1")
#: The same spaces in the contact row only, over linear rows, as in enriched contact elements.
CONTACT_ROW = tuple(f"L1+{space}" for space in SPACES[1:])
#: The elevated spaces in the contact row only, over the space that they elevate.
ELEVATED_ROW = ("N2+N2.1", "N4+N4.1")
#: Further spaces of the literature: Hermite of degree 5 and 7, varying order, and hybrid with Lagrange.
LITERATURE = ("L1+N3.2", "L1+N4.3", "N2+N4", "N2+N4@2", "N2+N4@3", "L2+N2@2")
#: The mesh on which variants of the adhesive force are compared.
VARIANT_MESH = "m2"

STEP = 0.1  # degree, as published
_PUBLISHED_END, _PLATEAU_END = 150.0, 112.0  # degrees; the second one suffices to read the plateau
_VARIANT_RANGE = (90.0, 102.5)  # degrees
_TIMED_RANGE = (100.0, 102.0)  # degrees
_PLAIN_RANGE = (60.0, _PUBLISHED_END)  # degrees: the front moves from the first one on
#: The spaces of the variants: every interpretation of the published names.
VARIED_SPACES = (*SPACES, *CONTACT_ROW, *ELEVATED_ROW)


@dataclass(frozen=True)
class Run:
    """One path: the strip on a space and a mesh.

    The published discretizations are traced to the published end, others until the plateau can be read. A
    variant of the adhesive force, projected or with another number of Gauss points, starts on the plateau,
    from a state of the usual run. So does a timed run: it has few steps, and no other processes run. A plain
    run makes a new tangent for every correction, like the published study, and starts before the plateau.
    """

    space: str
    mesh: str
    traction: Traction = "reference"
    contact_points: int | None = None
    timed: bool = False
    plain: bool = False

    @property
    def name(self) -> str:
        """The name of the run, also in names of files."""
        points = None if self.contact_points is None else f"{self.contact_points}points"
        traction = None if self.traction == "reference" else self.traction
        timed = "timed" if self.timed else None
        plain = "plain" if self.plain else None
        return "-".join(part for part in (self.space, self.mesh, traction, points, timed, plain) if part)

    @property
    def base(self) -> "Run | None":
        """The run that a variant starts from; None if it is not a variant."""
        base = replace(self, traction="reference", contact_points=None, timed=False, plain=False)
        return None if base == self else base

    @property
    def range_deg(self) -> tuple[float, float]:
        """First and last angle."""
        if self.timed:
            return _TIMED_RANGE
        if self.plain:
            return _PLAIN_RANGE
        if self.base is not None:
            return _VARIANT_RANGE
        return 0.0, _PUBLISHED_END if self.space in SPACES else _PLATEAU_END

    @property
    def angles_deg(self) -> FloatArray:
        """Angles of all steps."""
        start, end = self.range_deg
        steps: FloatArray = np.round(np.arange(round(start / STEP), round(end / STEP) + 1) * STEP, 10)
        return steps

    @property
    def case(self) -> Case:
        """The shipped case of the strip, with the choices of this run."""
        return load_case("strip").with_values(
            {
                "discretization.space": self.space,
                "discretization.mesh": "{}x{}".format(*MESHES[self.mesh]),
                "discretization.contact_points": self.contact_points,
                "adhesion.traction": self.traction,
                "drive.to": f"{self.range_deg[1]!r} deg",
                "drive.step": f"{STEP!r} deg",
            }
        )

    @property
    def key(self) -> str:
        """Fingerprint of the case, the angles and the code, on which the result depends."""
        defined_by = [self.case.text, self.range_deg, self.plain, code_fingerprint("case", "solve")]
        return hashlib.sha256(json.dumps(defined_by).encode()).hexdigest()

    @property
    def cost(self) -> float:
        """Estimate of its time, in no unit: columns of functions x (functions of an element)^2 x steps."""
        name = parse_space_name(self.space)
        across = MESHES[self.mesh][1]
        bulk, contact = (
            (family.degree - family.continuity + 0.5) * (family.degree + 1) ** 1.5
            for family in (name.bulk, name.contact)
        )
        rows = np.prod(MESHES[self.mesh]) / (across + 1) * (bulk * (across + 1 - name.contact_rows) + contact)
        return float(rows * across * len(self.angles_deg))


def table_runs(meshes: Iterable[str]) -> list[Run]:
    """Return the published discretizations."""
    return [Run(space, mesh) for mesh in meshes for space in SPACES]


def contact_row_runs(meshes: Iterable[str]) -> list[Run]:
    """Return the published discretizations with only the contact row enriched or elevated."""
    return [Run(space, mesh) for mesh in meshes for space in (*CONTACT_ROW, *ELEVATED_ROW)]


def literature_runs(meshes: Iterable[str]) -> list[Run]:
    """Return further discretizations of the literature."""
    return [Run(space, mesh) for mesh in meshes for space in LITERATURE]


def traction_runs() -> list[Run]:
    """Return all published spaces, in all rows or the contact row, with the force on the projected area."""
    return [Run(space, VARIANT_MESH, "projected") for space in VARIED_SPACES]


def quadrature_runs() -> list[Run]:
    """Return the same with 2 to p + 2 Gauss points of the adhesive force; all other runs have p + 1."""
    runs = []
    for space in VARIED_SPACES:
        default = default_points(space)
        runs += [
            Run(space, VARIANT_MESH, contact_points=points)
            for points in range(2, default + 2)
            if points != default
        ]
    return runs


def timed_runs(runs: Iterable[Run]) -> list[Run]:
    """Return timed runs of the same discretizations."""
    return [replace(run, timed=True) for run in runs]


@cache
def default_points(space: str) -> int:
    """Return the default number of Gauss points of the adhesive force on an element: degree + 1."""
    name = parse_space_name(space)
    return max(name.bulk.degree, name.contact.degree) + 1


def with_bases(runs: Iterable[Run]) -> list[Run]:
    """Return each run once, after the run that it starts from; the costliest first."""
    found: dict[Run, None] = {}
    for run in runs:
        if run.base is not None:
            found[run.base] = None
        found[run] = None
    return sorted(found, key=lambda run: (run.base is not None, -run.cost))
