"""Every law, material, substrate and shape that is registered, by four checks that none of them was made for.

The tangent against central differences, Newton's convergence, the energy balance and going on from a file.
One component at a time is varied around a common problem: a short strip, lifted at its end until about a
tenth to a half of the work has gone into tearing. Drives have the same checks in `test_drives.py`.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from runpy import run_path
from typing import Any

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.registry import discover
from isopeel.matrix.factorize import factorize
from isopeel.physics.adhesion import AdhesionLaw, Exponential, VanDerWaals
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials import Material, NeoHooke
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.physics.substrates import Circle, Flat, Substrate, Wavy
from isopeel.physics.substrates.formula import FormulaSubstrate
from isopeel.problem import Body, Interface, MovedSide, Problem, Support
from isopeel.problem.shapes import (
    CurvedStrip,
    HalfCylinder,
    Patch,
    QuarterCylinder,
    Shape,
    Strip,
    TaperedStrip,
)
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.rows import RowSpace, row_space

PACKAGES = ("physics.adhesion", "physics.materials", "physics.substrates", "problem.shapes", "problem.drives")
LAWS, MATERIALS, *_ = FOUND = [discover(f"isopeel.{package}") for package in PACKAGES]

# Strength, work and gap: weak and soft, so that many elements lie in the front, and no law snaps.
ALIKE = (0.002, 0.003, 0.6)
LAW = Exponential(*ALIKE)
STRIP = Strip(60.0, 4.0)
MESH = (60, 2)


@dataclass(frozen=True)
class Peeling:
    """A problem, how far its drive goes, whether it returns by half of that, and its mesh."""

    problem: Problem
    to: float
    back: bool
    mesh: tuple[int, int]

    @property
    def space(self) -> RowSpace:
        """The space of the displacement."""
        return fitting(self.problem.body.shape, self.mesh)


def fitting(shape: NurbsSurface, mesh: tuple[int, int]) -> RowSpace:
    """Quadratic functions along the body, and across it the degree that turns its shape rigidly."""
    return row_space("N2", mesh, shape.spaces[1].degree)


def peeling(
    *,
    shape: Shape = STRIP,
    material: Material | None = None,
    law: AdhesionLaw = LAW,
    substrate: Substrate | None = None,
    irreversible: bool = False,
    sliding_length: float | None = None,
    drive: MovedSide | None = None,
    to: float = 8.0,
    length: float = 40.0,
    mesh: tuple[int, int] = MESH,
    held: bool = True,
) -> Peeling:
    start, end = shape.adhering_part(length)
    body = Body(shape.surface(), material or NeoHooke(1.0, 0.2))
    adhesion = Interface(
        body.side("bottom", start, end),
        law=law,
        against=(substrate or Flat()).receded(law.equilibrium_gap),
        irreversible=irreversible,
        sliding_length=sliding_length,
    )
    problem = Problem(
        name="part",
        bodies=(body,),
        interfaces=(adhesion,),
        supports=(Support(body.side("left"), (0,)),) if held else (),
        drive=drive or MovedSide("right", np.pi / 2),
    )
    return Peeling(problem, to, irreversible, mesh)


@cache
def alike(law: Any) -> AdhesionLaw:
    """The law of a class, made once: formulas take a second."""
    made: AdhesionLaw = law.like(*ALIKE)
    return made


VARIANTS: dict[str, Callable[[AdhesionLaw], Peeling]] = {
    "reversible": lambda law: peeling(law=law),
    "irreversible": lambda law: peeling(law=law, irreversible=True),
    "holding": lambda law: peeling(law=law, sliding_length=0.5),
    "mirrored": lambda law: peeling(law=Mirrored(law), to=4.0),
}


def with_law(variant: str, law: Any, _: Path) -> Peeling:
    return VARIANTS[variant](alike(law))


def with_material(stretch: float | None, kind: Any, _: Path) -> Peeling:
    material: Material = kind.like(1.0, 0.2)
    return peeling(material=material if stretch is None else Prestretched(material, stretch))


# Of each substrate, by name, a body that fits it.
ON_A_CYLINDER, IN_A_HOLE = CurvedStrip(60.0, 4.0, 100.0, "down"), CurvedStrip(60.0, 4.0, 100.0, "up")
SUBSTRATES: dict[str, dict[str, tuple[Shape, Callable[[], Substrate]]]] = {
    "flat": {"": (STRIP, Flat)},
    "circle": {
        "inside": (ON_A_CYLINDER, lambda: Circle(100.0)),
        "outside": (IN_A_HOLE, lambda: Circle(100.0, "outside")),
    },
    "wavy": {"": (STRIP, lambda: Wavy(0.2, 25.0))},
    "formula": {"": (STRIP, lambda: FormulaSubstrate("-a*(1 - cos(x/6))**2", {"a": 0.1}))},
}


def on_substrate(name: str, which: str, law: Any, _: Path) -> Peeling:
    """With van der Waals adhesion too, the only law that uses the curvature of a circle."""
    shape, substrate = SUBSTRATES[name][which]
    return peeling(shape=shape, substrate=substrate(), law=alike(law))


def patch(folder: Path) -> Patch:
    """A strip of one quadratic patch, thicker in the middle."""
    spline = {
        "SplineType": "Bezier",
        "para_dim": 2,
        "dim": 2,
        "degrees": [2, 1],
        "control_points": [[0, 0], [30, 0], [60, 0], [0, 4], [30, 5], [60, 3]],
    }
    (folder / "patch.json").write_text(json.dumps({"SplineList": [spline]}))
    return Patch(folder / "patch.json")


UP = MovedSide("top", np.pi / 2, "held")
SHAPES: dict[str, Callable[[Path], Peeling]] = {
    "strip": lambda _: peeling(),
    "tapered-strip": lambda _: peeling(shape=TaperedStrip(60.0, 4.0, 3.0)),
    "curved-strip": lambda _: peeling(shape=ON_A_CYLINDER, substrate=Circle(100.0)),
    "patch": lambda folder: peeling(shape=patch(folder)),
    "half-cylinder": lambda _: peeling(
        shape=HalfCylinder(20.0), drive=UP, to=0.6, length=31.4, mesh=(40, 8), held=False
    ),
    "quarter-cylinder": lambda _: peeling(
        shape=QuarterCylinder(20.0), drive=UP, to=0.6, length=15.7, mesh=(24, 8)
    ),
}

CASES: dict[str, Callable[[Path], Peeling]] = {
    **{
        f"law {name}, {variant}": partial(with_law, variant, law)
        for name, law in LAWS.items()
        if name != "contact"  # which holds nothing: `tests/assembly/test_contact.py`
        for variant in VARIANTS
    },
    **{
        f"material {name}{', prestretched' if stretch else ''}": partial(with_material, stretch, material)
        for name, material in MATERIALS.items()
        for stretch in (None, 1.01)
    },
    **{
        f"substrate {name} {which}, {law.name}": partial(on_substrate, name, which, law)
        for name, several in SUBSTRATES.items()
        for which in several
        for law in (Exponential, VanDerWaals)
    },
    **{f"shape {name}": make for name, make in SHAPES.items()},
}

# Panels of the path between which the work is integrated, with so many Gauss points in each.
PANELS = 24
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Peeled:
    """The path of a peeling: at the ends of panels, and at the Gauss points between them."""

    peeling: Peeling
    ends: FloatArray
    steps: list[Step]


@pytest.fixture(scope="module", params=CASES)
def peeled(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Peeled:
    made = CASES[request.param](tmp_path_factory.mktemp("part"))
    ends = np.linspace(0.0, made.to, PANELS + 1)
    if made.back:
        ends = np.concatenate([ends, ends[-2 : PANELS // 2 - 1 : -1]])
    places = [0.0]
    for start, end in pairwise(ends):
        places += [*(start + (end - start) * (NODES + 1) / 2), end]
    return Peeled(made, ends, list(trace(made.problem, made.space, places)))


def test_work_of_the_drive_is_what_the_energies_take(peeled: Peeled) -> None:
    """External work = stored + adhesive + dissipated energy, from the first step to the end of each panel."""
    count = len(NODES) + 1
    energies = np.array([s.stored_energy + s.adhesive_energy + s.dissipated_energy for s in peeled.steps])
    reactions = np.array([s.reaction for s in peeled.steps[1:]]).reshape(-1, count)[:, :-1]
    work = np.cumsum(np.diff(peeled.ends) / 2 * (reactions @ WEIGHTS))
    # Gauss points meet smooth paths to 1e-9; jumps of T' or T'' at some points in the front leave 1e-7
    np.testing.assert_allclose(energies[count::count] - energies[0], work, rtol=0, atol=1e-6 * work.max())
    dissipated = np.array([s.dissipated_energy for s in peeled.steps])
    if peeled.peeling.back:
        assert dissipated[-1] > 0.1 * work.max()
        assert np.all(np.diff(dissipated) >= -1e-13 * work.max())  # round-off of sums over points
    else:
        assert not dissipated.any()


def test_newton_converges_quadratically(peeled: Peeled) -> None:
    """In steps of up to an eighth of the path, and up to round-off."""
    space = peeled.peeling.space
    # nothing is known before the first step, which is taken with care
    places = peeled.peeling.to * np.array([0, 1 / 64, 1 / 16, *np.arange(1, 9) / 8])
    steps = trace(peeled.peeling.problem, space, places, NewtonSettings(plain=True))
    scale = 60.0 * 4.0  # about E times the area
    most = 0
    for step in steps:
        most = max(most, len(step.iterations))
        *_, large, small = (np.inf, *step.iterations)
        # the exponent of the energy doubles, times a constant; linear convergence gains some digits at most
        assert small < max(1e-28 * scale, 1e3 * (large / scale) ** 1.5 * scale)
    assert most > 2


def test_a_path_continues_from_its_file_bit_for_bit(peeled: Peeled, tmp_path: Path) -> None:
    problem, space = peeled.peeling.problem, peeled.peeling.space
    cut = 4 * len(peeled.steps) // 5  # during the return, if there is one
    attributes = run_attributes(problem, space, Provenance({}, "", "", "", ""))
    with RunWriter(tmp_path / "run.h5", problem.drive, "", attributes) as file:
        for step in trace(problem, space, [s.parameter for s in peeled.steps[:cut]]):
            file.append(step)
    state = read_run(tmp_path / "run.h5").last
    assert state is not None
    later = peeled.steps[cut : cut + 6]
    again = trace(problem, space, [s.parameter for s in later], start=[state])
    for one, other in zip(again, later, strict=True):
        assert (one.reaction, one.dissipated_energy) == (other.reaction, other.dissipated_energy)
        np.testing.assert_array_equal(one.displacement, other.displacement)


def test_tangent_is_the_derivative_of_the_residual(peeled: Peeled) -> None:
    """K^-1 of central differences of the residual gives back their direction, around a random state."""
    problem = peeled.peeling.problem
    system = System(problem, fitting(problem.body.shape, (20, 2)))
    rng = np.random.default_rng(3)
    y, direction = 0.02 * rng.standard_normal((2, system.count))
    if problem.adhesion.irreversible:
        # about half of the points open further than ever
        system = system.after(0.04 * rng.random(system.maximum_openings.shape))

    def residual(values: FloatArray) -> FloatArray:
        return system.equilibrium(system.state(values, 0.1)[0]).residual

    change = (residual(y + 1e-5 * direction) - residual(y - 1e-5 * direction)) / 2e-5
    factor = factorize(system.linearize(system.state(y, 0.1)[0], "general")[1])
    # central differences of step 1e-5 leave 1e-10 of the third derivative, which the solution enlarges
    np.testing.assert_allclose(factor.solve(change), direction, rtol=0, atol=1e-6 * np.abs(direction).max())


def test_every_registered_component_is_tested() -> None:
    """Laws and materials are by themselves; what else is registered needs an example that suits it."""
    here = Path(__file__).parent
    drives = {drive.name for drive, _ in run_path(str(here / "test_drives.py"))["DRIVES"].values()}
    for found, examples, place in (
        (FOUND[2], SUBSTRATES, "SUBSTRATES in tests/solve/test_every_component.py"),
        (FOUND[3], SHAPES, "SHAPES in tests/solve/test_every_component.py"),
        (FOUND[4], drives, "DRIVES in tests/solve/test_drives.py"),
    ):
        missing = sorted(set(found) - set(examples))
        assert not missing, f"{', '.join(missing)}: give an example in {place}"
