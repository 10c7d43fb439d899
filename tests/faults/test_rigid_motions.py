"""Every discretization turns its body rigidly without strain: repaired where it would not, or refused."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from isopeel import Problem
from isopeel.assembly.system import System
from isopeel.case import Case
from isopeel.common.errors import InputError
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.trace import trace

#: The given fault: a rectangle of 60 x 1 whose parametrization has a kink, at 57 of 60.
RECTANGLE: dict[str, Any] = {
    "degrees": [1, 1],
    "knot_vectors": [[0, 0, 0.5, 1, 1], [0, 0, 1, 1]],
    "control_points": [[0, 0], [57, 0], [60, 0], [0, 1], [57, 1], [60, 1]],
}


def peeled(
    body: str, space: str, mesh: str, folder: Path = Path(), more: str = "", adhesion: str = ""
) -> Case:
    """The given case, with another body, space and mesh."""
    return Case.parse(
        f"""\
name = "peeled"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
{body}
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = 0.0
[adhesion]
law = "exponential"
strength = "0.01 MPa"
work_of_adhesion = "0.0005 N/mm"
irreversible = true
{adhesion}
[substrate]
kind = "flat"
[discretization]
space = "{space}"
mesh = "{mesh}"
{more}
[drive]
kind = "force"
side = "right"
start = 0.0
end = 0.05
angle = "90 deg"
to = "1.4 mm"
step = "0.1 mm"
""",
        folder=folder,
    )


def patch(
    folder: Path, spline: dict[str, Any], space: str, mesh: str, more: str = "", adhesion: str = ""
) -> Case:
    """The same of a patch in a file."""
    kind = {"SplineType": "NURBS" if "weights" in spline else "BSpline", "para_dim": 2, "dim": 2}
    (folder / "patch.json").write_text(json.dumps({"SplineList": [kind | spline]}), "utf-8")
    return peeled(
        'shape = "patch"\nfile = "patch.json"\nunit_length = "1 mm"', space, mesh, folder, more, adhesion
    )


def energy_of_a_turn(case: Case) -> float:
    """Energy of the body turned by two radians, over E times its area."""
    problem: Problem = case.problem()
    system = System(problem, case.space())
    turn = np.array([[np.cos(2.0) - 1, -np.sin(2.0)], [np.sin(2.0), np.cos(2.0) - 1]])
    u = system.space.interpolate(lambda xi, eta: problem.body.shape.evaluate(xi, eta) @ turn.T)
    return system.equilibrium(u).stored_energy / system.energy_scale


def largest_force(case: Case) -> float:
    (stage,) = case.stages()
    path = trace(stage.problem, case.space(), stage.parameters, NewtonSettings(path_control="auto"))
    return max(step.reaction for step in path)


@pytest.mark.parametrize("space", ["N2.1", "N3", "N2", "L2"])
def test_a_kinked_rectangle_peels_as_the_rectangle(space: str, tmp_path: Path) -> None:
    length = 'length = "55 mm"'
    kinked = largest_force(patch(tmp_path, RECTANGLE, space, "180x2", adhesion=length))
    strip = largest_force(peeled('length = "60 mm"\nheight = "1 mm"', space, "180x2", adhesion=length))
    # elements of 0.32 mm against 0.33 mm: the zone is 3 mm
    assert kinked == pytest.approx(strip, rel=0.005)


#: Kinks where the mesh has no breakpoint: moved to one that is near, or added.
@pytest.mark.parametrize(("knot", "elements"), [(0.5, 40), (0.501, 40), (0.4871, 40), (0.33, 2)])
def test_a_kink_is_a_breakpoint_wherever_it_lies(knot: float, elements: int, tmp_path: Path) -> None:
    spline = RECTANGLE | {"knot_vectors": [[0, 0, knot, 1, 1], [0, 0, 1, 1]]}
    case = patch(tmp_path, spline, "N4", f"{elements}x2")
    along = case.space().rows[0]
    (at,) = np.flatnonzero(along.breakpoints == knot)
    assert along.continuities[at - 1] == 0
    # elsewhere it has the continuity of its name
    assert np.delete(along.continuities, at - 1).tolist() == [3] * (along.elements - 2)
    assert np.diff(along.breakpoints).min() > 0.3 * np.diff(along.breakpoints).max()
    assert energy_of_a_turn(case) < 1e-13


def test_a_kink_across_the_height_is_taken_over_too(tmp_path: Path) -> None:
    spline = {
        "degrees": [1, 1],
        "knot_vectors": [[0, 0, 1, 1], [0, 0, 0.3, 1, 1]],
        "control_points": [[0, 0], [60, 0], [0, 0.7], [60, 0.7], [0, 1], [60, 1]],
    }
    case = patch(tmp_path, spline, "N2.1", "20x3")
    assert case.space().rows[0].continuities.tolist() == [1] * 19
    assert 0 in case.space().across.continuities
    assert energy_of_a_turn(case) < 1e-13


def test_two_arcs_that_meet_at_a_double_knot_turn_rigidly(tmp_path: Path) -> None:
    """Rational, quadratic, smooth in the plane but not in the parameter: arcs of 20 and 50 degrees."""
    inner, outer = arcs(30.0), arcs(31.0)
    spline = {
        "degrees": [2, 1],
        "knot_vectors": [[0, 0, 0, 0.5, 0.5, 1, 1, 1], [0, 0, 1, 1]],
        "control_points": [[x, y] for x, y, _ in (*outer, *inner)],
        "weights": [w for _, _, w in (*outer, *inner)],
    }
    case = patch(tmp_path, spline, "N3", "31x2")
    assert energy_of_a_turn(replaced_flat(case)) < 1e-13


def arcs(radius: float) -> list[tuple[float, float, float]]:
    """Control points and weights of two arcs below the origin, from -20 to 0 and on to 50 degrees."""
    points: list[tuple[float, float, float]] = []
    for start, end in ((-20.0, 0.0), (0.0, 50.0)):
        half, middle = np.radians(end - start) / 2, np.radians(start + end) / 2
        places: Sequence[tuple[float, float]] = (
            (float(np.radians(start)), radius),
            (middle, radius / np.cos(half)),
            (float(np.radians(end)), radius),
        )
        weights = 1.0, float(np.cos(half)), 1.0
        arc = [
            (r * float(np.sin(a)), -r * float(np.cos(a)), w)
            for (a, r), w in zip(places, weights, strict=True)
        ]
        points += arc[1:] if points else arc
    return points


def replaced_flat(case: Case) -> Case:
    """The same with the substrate below all of the body."""
    return Case.parse(case.text.replace('kind = "flat"', 'kind = "flat"\ngap = "40 mm"'))


CURVED = 'shape = "curved-strip"\nlength = "60 mm"\nheight = "1 mm"\nradius = "100 mm"'


@pytest.mark.parametrize(
    ("body", "space", "more", "field", "means"),
    [
        (CURVED, "L1", "", "space", "N2"),
        (CURVED, "L1+N2.1", "", "space", "N2"),
        (
            'shape = "quarter-cylinder"\nradius = "9 mm"',
            "N2",
            "across_degree = 1",
            "across_degree",
            "degree 2",
        ),
    ],
)
def test_a_space_below_the_degree_of_the_shape_is_refused(
    body: str, space: str, more: str, field: str, means: str
) -> None:
    case = peeled(body, space, "20x4", more=more)
    with pytest.raises(InputError, match=means) as refused:
        System(case.problem(), case.space())
    assert refused.value.field == field


def test_a_cubic_patch_needs_degree_3(tmp_path: Path) -> None:
    bottom: list[tuple[float, float]] = [(0.0, 0.0), (20.0, 0.5), (40.0, -0.3), (60.0, 0.0)]
    spline = {
        "degrees": [3, 1],
        "knot_vectors": [[0, 0, 0, 0, 1, 1, 1, 1], [0, 0, 1, 1]],
        "control_points": [*bottom, *((x, y + 1) for x, y in bottom)],
    }
    quadratic = patch(tmp_path, spline, "N2", "20x2")
    with pytest.raises(InputError, match="degree 3 in all rows, such as 'N3'"):
        System(replaced_flat(quadratic).problem(), quadratic.space())
    assert energy_of_a_turn(replaced_flat(patch(tmp_path, spline, "N2.1", "20x2"))) < 1e-13
