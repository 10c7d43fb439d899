"""Contact with multipliers: Uzawa's loop to a stated penetration, whatever the stiffness."""

from pathlib import Path

import numpy as np
import pytest
from test_contact import PRESSURE, SPACES, alone, both
from test_facing import FLAT, deformed, facing

from isopeel import (
    Contact,
    ConvergenceError,
    InputError,
    Mirrored,
    Problem,
    Step,
    row_space,
    trace,
)
from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.multipliers import remaining
from isopeel.assembly.system import System
from isopeel.post.closed_form import hertz_line
from isopeel.results.layout import Layout
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.solve.newton import NewtonSettings
from isopeel.splines.rows import RowSpace
from isopeel.validation.two_cylinders import RADIUS, REDUCED_MODULUS, _spaces, _two_cylinders

#: E'/h of the softer body and 30 times as much; bodies would overlap by 0.01 and by 3e-4.
SOFT_CONTACT, STIFF_CONTACT = 1.0, 30.0
PENETRATION = 1e-5


def spaces_of(problem: Problem) -> dict[str, RowSpace]:
    return {body.name: SPACES[body.name] for body in problem.bodies}


@pytest.mark.parametrize("scheme", ["unbiased", "biased", "two-half-pass"])
def test_forces_after_a_history_are_derivatives_of_the_energy(scheme: str) -> None:
    problem = facing(FLAT, "bottom", scheme, law=Contact(3.0, 0.4, penetration=1e-3))
    spaces = {"upper": row_space("N2", (7, 2), 2), "lower": row_space("N2.1", (11, 2), 2)}
    system = System(problem, spaces)
    u, change = deformed(system, 0.1), deformed(system, 1.0, 2)
    rng = np.random.default_rng(3)
    replaced = np.maximum(0.1 * rng.standard_normal(system.maximum_openings.shape), 0.0)
    system = system.after(replaced)
    step = 1e-6
    at, matrix = system.linearize(u, "general")
    near = [system.equilibrium(u + sign * step * change) for sign in (1, -1)]
    if scheme != "two-half-pass":
        energies = [state.adhesive_energy + state.stored_energy for state in near]
        rise = (energies[0] - energies[1]) / (2 * step)
        # differences of energies of the order 1 over 2e-6
        assert np.sum(at.forces * change) == pytest.approx(rise, rel=1e-7)
    b, n = matrix.half_bandwidth, system.constraints.count
    unknowns, z = system.constraints.unknowns, np.zeros(system.constraints.count)
    z[unknowns[unknowns >= 0]] = change[unknowns >= 0]
    change = np.where(unknowns >= 0, z[unknowns], 0.0)
    one, other = (system.equilibrium(u + sign * step * change).residual for sign in (1, -1))
    product = np.zeros(n)
    for j in range(n):
        rows = np.arange(max(0, j - b), min(n, j + b + 1))
        product[rows] += matrix.entries[j, 2 * b + rows - j] * z[j]
    slope = (one - other) / (2 * step)
    # few points meet the kink of the law within the step: none here
    np.testing.assert_allclose(product, slope, atol=1e-7 * np.abs(slope).max())


def pressed(problem: Problem) -> Step:
    *_, last = trace(problem, spaces_of(problem), [0.0, 2 * PRESSURE, 4 * PRESSURE])
    return last


@pytest.mark.parametrize("kind", ["substrate", "mirror image", "biased", "unbiased"])
def test_a_uniform_pressure_leaves_no_more_than_the_penetration(kind: str) -> None:
    """Blocks on blocks: exact pressures, and the displacement of bodies that do not overlap."""

    def of(stiffness: float, penetration: float | None) -> Problem:
        law = Contact(stiffness, penetration=penetration)
        if kind in ("substrate", "mirror image"):
            return alone(Mirrored(law) if kind == "mirror image" else law)
        return both(law, kind)

    found = []
    for stiffness in (SOFT_CONTACT, STIFF_CONTACT):
        problem = of(stiffness, PENETRATION)
        last = pressed(problem)
        points = InterfacePoints.of_contact(problem, spaces_of(problem), interface=problem.interface_names[0])
        state = points.state(last.displacement, last.maximum_openings)
        faces = 2.0 if kind == "mirror image" else 1.0
        assert faces * np.abs(state.gap).max() <= PENETRATION
        # of meshes that do not match, the pressure oscillates by the quadrature error, see `test_facing.py`
        allowed = {"biased": 0.02, "unbiased": 0.02}.get(kind, 1e-6)
        mean = np.average(state.normal_traction, weights=points.lengths)
        assert mean == pytest.approx(PRESSURE, rel=allowed)
        found.append(last.reaction)
    # by the two gaps that may remain; without multipliers the overlap adds to it
    assert found[0] == pytest.approx(found[1], abs=2 * PENETRATION)
    assert pressed(of(SOFT_CONTACT, None)).reaction > found[0] + 0.4 * PRESSURE / SOFT_CONTACT


@pytest.mark.parametrize(
    ("stiffness", "elements"), [(2.0, (40, 6)), pytest.param(0.5, (60, 8), marks=pytest.mark.long)]
)
def test_cylinders_with_a_soft_contact_meet_as_hertz_says(
    stiffness: float, elements: tuple[int, int]
) -> None:
    """Without multipliers, the softer contact misses the pressure by a fifth."""
    problem, spaces = _two_cylinders(Contact(stiffness, penetration=1e-4), 0.2), _spaces(elements)
    path = -np.geomspace(0.1 / 40, 0.1, 4)
    *_, last = trace(problem, spaces, path, NewtonSettings(path_control="auto"))
    hertz = hertz_line(-2 * last.reaction, REDUCED_MODULUS, RADIUS)
    points = InterfacePoints.of_contact(problem, spaces, interface="upper.bottom")
    state = points.state(last.displacement, last.maximum_openings)
    place, pressure = state.position[..., 0].ravel(), state.normal_traction.ravel()
    assert np.abs(state.gap.ravel()[pressure > 0]).max() <= 1e-4
    inside = place < 0.9 * hertz.half_width
    slope, square = np.polyfit(place[inside] ** 2, pressure[inside] ** 2, 1)
    # as `isopeel validate` allows, on a mesh of half as many elements or less
    assert np.sqrt(-square / slope) == pytest.approx(hertz.half_width, rel=0.01)
    assert np.sqrt(square) == pytest.approx(hertz.peak_pressure, rel=0.01)


def test_a_loop_that_does_not_converge_says_so() -> None:
    """A contact a thousand times softer than the bodies leaves nearly all of the gap in each update."""
    problem = both(Contact(2e-4, penetration=1e-9), "biased")
    with pytest.raises(ConvergenceError, match=r"100 updates.*upper\.bottom.*penetration 1e-09 L0") as failed:
        list(trace(problem, spaces_of(problem), [0.0, 1e-4]))
    assert failed.value.cause == "penetration"


def test_the_multipliers_keep_the_pressure_that_is_written_and_read(tmp_path: Path) -> None:
    """A path continues from its file bit for bit."""
    problem = both(Contact(SOFT_CONTACT, penetration=PENETRATION), "biased")
    spaces, path = spaces_of(problem), np.linspace(0.0, 0.04, 9)
    settings = NewtonSettings(path_control="auto")
    steps, whole = trace(problem, spaces, path, settings), []
    attributes = run_attributes(problem, spaces, Provenance({}, "", "", "", ""))
    file = tmp_path / "run.h5"
    with RunWriter(file, problem.drive, "", attributes, layout=Layout.of(problem, spaces)) as writer:
        for step in steps:
            whole.append(step)
            writer.append(step)
            if step.parameter == path[4]:
                break
    whole += steps
    state = read_run(file).last
    assert state is not None
    assert state.maximum_openings is not None
    assert (state.maximum_openings > 0).all()
    first = next(n for n, step in enumerate(whole) if step.parameter == path[4]) + 1
    rest = list(trace(problem, spaces, path[5:], settings, start=[state]))
    for one, other in zip(rest, whole[first:], strict=True):
        assert (one.parameter, one.reaction) == (other.parameter, other.reaction)
        np.testing.assert_array_equal(one.displacement, other.displacement)
        np.testing.assert_array_equal(one.maximum_openings, other.maximum_openings)


def test_an_update_keeps_the_pressure() -> None:
    problem = alone(Contact(SOFT_CONTACT, penetration=1.0))
    last = pressed(problem)
    system = System(problem, spaces_of(problem))
    points = InterfacePoints.of_contact(problem, spaces_of(problem))
    before = points.state(last.displacement, last.maximum_openings)
    left = remaining(system, last.displacement)
    assert left.gap == pytest.approx(-before.gap.min(), rel=1e-12)
    # where the gap is closed, the multipliers press as much
    np.testing.assert_allclose(SOFT_CONTACT * left.history, before.normal_traction, rtol=1e-12)


@pytest.mark.parametrize("control", ["jump", "continuation"])
def test_a_curve_with_multipliers_is_refused(control: str) -> None:
    problem = both(Contact(penetration=1e-4))
    settings = NewtonSettings(path_control=control)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"drive\.path_control: .*multipliers"):
        trace(problem, spaces_of(problem), [0.0], settings)
