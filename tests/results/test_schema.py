"""run.h5 as another program sees it, by h5py alone."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.interpolate import BSpline

from isopeel.problem import strip
from isopeel.results.fields import KeptStates, StoredState
from isopeel.results.layout import Layout
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.results.schema import SCHEMA
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

PROBLEM, SPACE = strip(), row_space("L1+N2", (20, 2))


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("run") / "run.h5"
    attributes = run_attributes(PROBLEM, SPACE, Provenance({}, "", "", "", ""))
    layout = Layout.of(PROBLEM, SPACE)
    with RunWriter(file, PROBLEM.drive, "name = 'x'", attributes, layout=layout) as writer:
        for step in trace(PROBLEM, SPACE, np.radians([0, 1, 2, 3])):
            writer.append(step)
        writer.end("completed")
    return file


def test_each_data_set_has_a_unit_and_a_description(path: Path) -> None:
    seen: list[str] = []

    def look(name: str, one: object) -> None:
        if isinstance(one, h5py.Dataset) and not name.startswith("last/solver/"):
            assert one.attrs["description"]
            assert one.attrs["unit"] or name == "case"
            seen.append(name)

    assert len(read_run(str(path)).curve) == 4
    with h5py.File(path) as file:
        file.visititems(look)
        assert file["curve/parameter"].attrs["unit"] == "degree"
        assert file["fields/step"][()].tolist() == [0, 3]
    required = {name for name, one in SCHEMA.items() if one.required}
    assert required <= set(seen)


def test_a_displacement_is_drawn_with_h5py_and_scipy_alone(path: Path) -> None:
    """At a point inside: knots, degrees and coefficients are those of the functions of isopeel."""
    at = 0.37, 0.6
    with h5py.File(path) as file:
        space, u = file["spaces/body"], file["fields/displacement"][-1]
        first = space["first_function"][()]
        rows = []
        for number in range(len(first) - 1):
            row = space[f"rows/{number}"]
            coefficients = np.hstack([u, space["control_points"][()]])[first[number] : first[number + 1]]
            rows.append(BSpline(row[()], coefficients, row.attrs["degree"])(at[0]))
        across = BSpline(space["across"][()], np.array(rows), space["across"].attrs["degree"])(at[1])
    basis = SPACE.basis(np.array([at[0]]), np.array([at[1]]), 1)
    np.testing.assert_allclose(across[:2], basis.values[0] @ u[basis.functions[0]], rtol=1e-12, atol=1e-14)
    place = PROBLEM.body.shape.evaluate(np.array([at[0]]), np.array([at[1]]))[0]
    np.testing.assert_allclose(across[2:], place, rtol=1e-12)


def test_both_states_of_a_parameter_that_is_passed_twice_are_kept() -> None:
    """On two branches, after a limit point: past 10, back below it, and past it again."""
    nothing = np.empty((0, 2))
    kept = KeptStates(10.0)
    for step, parameter in enumerate([0.0, 10.0, 12.0, 9.0, 10.0, 13.0]):
        kept.take(StoredState(step, parameter, nothing, nothing))
    states = [(state.step, state.parameter) for state in kept.all()]
    assert states == [(0, 0.0), (1, 10.0), (3, 9.0), (4, 10.0), (5, 13.0)]
