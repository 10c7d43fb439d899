"""A system with other materials and laws is the one that is built of them."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.case import load_case

#: Shipped cases with a substrate, with facing sides, with fixed pairs, and with contact whose stiffness
#: follows from the materials; their meshes, and other values of material and law.
CASES: dict[str, tuple[dict[str, str], dict[str, str]]] = {
    "strip": (
        {"discretization.mesh": "30x2"},
        {"material.youngs_modulus": "1.9 GPa", "adhesion.hamaker_constant": "1.1e-19 J"},
    ),
    "t-peel": (
        {"discretization.mesh": "24x1"},
        {"body.2.material.youngs_modulus": "1.1 GPa", "interface.1.strength": "1.4 MPa"},
    ),
    "mixed-mode-bending": (
        {"discretization.mesh": "20x2"},
        {"body.1.material.youngs_modulus": "60 GPa", "interface.1.strength": "42 MPa"},
    ),
    "two-cylinders": (
        {"body.1.mesh": "12x3", "body.2.mesh": "3x12"},
        {"body.1.material.youngs_modulus": "0.9 MPa"},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_it_is_that_of_the_other_problem(name: str) -> None:
    meshes, values = CASES[name]
    case = load_case(name).with_values({**meshes, "output": None})
    stage, spaces = case.stages()[0], case.spaces()
    system = System(stage.problem, spaces)
    other = case.with_values(values).stages()[0].problem
    bodies = tuple(
        replace(mine, material=theirs.material)
        for mine, theirs in zip(stage.problem.bodies, other.bodies, strict=True)
    )
    interfaces = tuple(
        replace(mine, law=theirs.law)
        for mine, theirs in zip(stage.problem.interfaces, other.interfaces, strict=True)
    )
    problem = replace(stage.problem, bodies=bodies, interfaces=interfaces)
    found, expected = system.with_physics_of(problem), System(problem, spaces)
    assert found.problem == expected.problem
    u = 1e-3 * np.random.default_rng(1).standard_normal(system.constraints.offset.shape)
    mine, theirs, before = (one.equilibrium(u) for one in (found, expected, system))
    np.testing.assert_array_equal(mine.forces, theirs.forces)
    np.testing.assert_array_equal(found.maximum_openings, expected.maximum_openings)
    assert not np.array_equal(mine.forces, before.forces)
    assert found.energy_scale == expected.energy_scale
    if system.irreversible:
        np.testing.assert_array_equal(found.commit(u), expected.commit(u))


def test_a_system_shares_the_tables_of_equal_shapes() -> None:
    case = load_case("strip").with_values({"discretization.mesh": "30x2", "reading": None})
    one = case.stages()[0].problem
    system = System(one, case.spaces())
    gap = case.with_values({"adhesion.equilibrium_distance": "0.41 nm"}).stages()[0].problem
    moved = replace(gap, bodies=tuple(replace(body, shape=one.body.shape) for body in gap.bodies))
    found, expected = System(moved, case.spaces(), like=system), System(moved, case.spaces())
    assert found.body is system.body
    higher = case.with_values({"body.height": "11 nm"})
    assert System(higher.problem(), higher.spaces(), like=system).body is not system.body
    u = 1e-3 * np.random.default_rng(1).standard_normal(system.constraints.offset.shape)
    np.testing.assert_array_equal(found.equilibrium(u).forces, expected.equilibrium(u).forces)
