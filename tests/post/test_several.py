"""Results of two tapes on one substrate: each interface has those that it has alone."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import TriMesh
from two_tapes import FIRST, LAWS, SECOND, SPACES, alone, both

from isopeel import (
    Curve,
    Flat,
    InputError,
    Interface,
    MovedSide,
    NewtonSettings,
    Problem,
    PulledSide,
    RotatedSide,
    RowSpace,
    Step,
    Support,
    VanDerWaals,
    row_space,
    strip,
    trace,
)
from isopeel.assembly.interface import InterfacePoints, maximum_openings_by_name
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.units import UnitSystem
from isopeel.physics.substrates import Circle
from isopeel.post.closed_form.expected import theory
from isopeel.post.crack import fronts
from isopeel.post.fields import Depth, depths_inside, sample_fields
from isopeel.post.figures import front_figure, shapes_figure, tractions_figure
from isopeel.post.findings import Findings, find
from isopeel.post.front import POINTS, FrontProfile, front_profile, process_zone
from isopeel.post.laboratory import Laboratory
from isopeel.post.mesh_error import mesh_changes
from isopeel.post.notes import run_notes
from isopeel.post.resolution import estimated
from isopeel.post.states import drawn_state, stress_scale, substrates
from isopeel.post.summary import summarize
from isopeel.post.summary_table import summary_rows
from isopeel.problem import Drive
from isopeel.results.fields import StoredState
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import StoredRun, run_attributes

#: A moment peels the first tape, a force the second.
TURN, LIFT = RotatedSide("right"), PulledSide("right", np.pi / 2)
PATHS: Mapping[str, tuple[RotatedSide | PulledSide, FloatArray]] = {
    "first": (TURN, np.radians(np.arange(0.0, 121.0, 5.0))),
    "second": (LIFT, np.arange(0.0, 16.1, 1.0)),
}


def steps_of(problem: Problem, space: Mapping[str, RowSpace], path: FloatArray) -> list[Step]:
    return list(trace(problem, space, path, NewtonSettings(path_control="auto")))


@pytest.fixture(scope="module")
def single() -> dict[str, list[Step]]:
    """The steps of each tape alone."""
    return {
        name: steps_of(alone(number, drive), {name: SPACES[name]}, path)
        for number, (name, (drive, path)) in enumerate(PATHS.items())
    }


def state_of(step: Step, problem: Problem) -> StoredState:
    return StoredState.of(step, problem.drive)


def joined(first: Step, second: Step, problem: Problem) -> StoredState:
    """The state of both tapes in which each is as it is alone."""
    openings = np.concatenate([one.maximum_openings.ravel() for one in (first, second)])
    system = System(problem, SPACES)
    displacement = np.concatenate([first.displacement, second.displacement])
    return StoredState(0, 0.0, displacement, openings.reshape(system.maximum_openings.shape))


def profile_of(problem: Problem, state: StoredState, name: str) -> FrontProfile:
    return front_profile(problem, SPACES, state.displacement, POINTS, state.maximum_openings, name)


def arrays(profile: FrontProfile) -> list[FloatArray]:
    return list(vars(profile).values())


def test_each_interface_has_the_profile_that_it_has_alone(single: dict[str, list[Step]]) -> None:
    """To the bit: the same numbers are evaluated. The second one is damaged and was unloaded."""
    first, second = single["first"][-1], single["second"][-1]
    problem = both(TURN, "first")
    state = joined(first, second, problem)
    assert maximum_openings_by_name(problem, SPACES, state.maximum_openings)["second.bottom"].max() > 0
    for number, (name, step) in enumerate((("first", first), ("second", second))):
        one = alone(number, PATHS[name][0])
        u, openings = step.displacement, step.maximum_openings
        expected = front_profile(one, SPACES[name], u, maximum_openings=openings)
        found = profile_of(problem, state, f"{name}.bottom")
        for a, b in zip(arrays(found), arrays(expected), strict=True):
            np.testing.assert_array_equal(a, b)
        zone = process_zone(found)
        assert zone is not None
        assert zone.peak == pytest.approx(LAWS[number].strength, rel=0.01)  # at one of 21 points
        here = sample_fields(problem, SPACES, state.displacement, (2, 2), name)
        there = sample_fields(one, SPACES[name], u, (2, 2))
        np.testing.assert_array_equal(here.cauchy_stress, there.cauchy_stress)


@pytest.mark.parametrize("driven", ["first", "second"])
def test_tractions_fronts_and_cracks_are_those_of_single_runs(
    driven: str, single: dict[str, list[Step]]
) -> None:
    drive, path = PATHS[driven]
    problem, number = both(drive, driven), ["first", "second"].index(driven)
    one, name = alone(number, drive), f"{driven}.bottom"
    states = [state_of(step, problem) for step in steps_of(problem, SPACES, path)]
    expected = [state_of(step, one) for step in single[driven]]
    here = fronts(problem, SPACES, states[-4:], name)
    there = fronts(one, SPACES[driven], expected[-4:])
    assert list(here) == list(there)
    assert len(here) >= 2
    for step, front in here.items():
        # both paths are solved to the tolerance of the energy, 1e-8 of the fields
        assert front.zone.position == pytest.approx(there[step].zone.position, abs=1e-6)
        assert front.zone.length == pytest.approx(there[step].zone.length, rel=1e-6)
        assert front.crack_length == pytest.approx(there[step].crack_length, abs=1e-6)
    strongest = LAWS[number].strength
    profile = profile_of(problem, states[-1], name)
    alike = front_profile(
        one, SPACES[driven], expected[-1].displacement, maximum_openings=expected[-1].maximum_openings
    )
    np.testing.assert_allclose(
        profile.adhesive_traction, alike.adhesive_traction, rtol=0, atol=1e-6 * strongest
    )
    # the other tape is not loaded: it has no front, no crack, and tractions of the solver's tolerance
    other = next(another for another in problem.interface_names if another != name)
    assert fronts(problem, SPACES, states, other) == {}
    at_rest = profile_of(problem, states[-1], other)
    assert np.abs(at_rest.adhesive_traction).max() < 1e-6 * strongest


def test_openings_of_interfaces_of_other_degrees_are_told_apart() -> None:
    """By default an interface has one Gauss point more than its degree; contact_points is that of all."""
    problem, spaces = (
        both(TURN, "first"),
        {"first": row_space("N2", (8, 2)), "second": row_space("L1", (10, 2))},
    )
    for points in (None, 1, 5):
        system = System(problem, spaces, points)
        rng = np.random.default_rng(0)
        openings = rng.random(system.maximum_openings.shape)
        found, expected = (
            maximum_openings_by_name(problem, spaces, openings),
            system.maximum_openings_of(openings),
        )
        assert [one.shape for one in found.values()] == [(6, points or 3), (8, points or 2)]
        for name, values in expected.items():
            np.testing.assert_array_equal(found[name], values)
    with pytest.raises(InputError, match="the interfaces have 6, 8 elements"):
        maximum_openings_by_name(problem, spaces, np.zeros((13, 1)))


def two_sided() -> tuple[Problem, RowSpace]:
    """A strip between two planes, each at its law's equilibrium gap, of different laws."""
    problem = strip(length=20.0, height=2.0, adhering_length=15.0)
    body, law = problem.body, VanDerWaals(0.02, 0.4)
    plane = Circle(1e9, "inside", (0.0, 2.0 + law.equilibrium_gap + 1e9))
    above = Interface(body.side("top", 0.25, 1.0), law, plane)
    return replace(problem, interfaces=(*problem.interfaces, above)), row_space("N2", (20, 2))


def test_a_body_with_two_interfaces_has_two_profiles() -> None:
    problem, space = two_sided()
    lift = np.zeros((space.size, 2))
    lift[:, 1] = 0.05
    below = front_profile(problem, space, lift, interface="body.bottom")
    above = front_profile(problem, space, lift, interface="body.top")
    assert below.position[[0, -1], [0, -1]] == pytest.approx([0.0, 15.0], abs=1e-12)
    assert above.position[[0, -1], [0, -1]] == pytest.approx([5.0, 20.0], abs=1e-12)
    # pulled from below, pushed from above; the circle falls off by 20^2/2e9
    lower, upper = (interface.law.equilibrium_gap for interface in problem.interfaces)
    gaps = below.gap - lower, above.gap - upper
    np.testing.assert_allclose(gaps[0], 0.05, rtol=0, atol=1e-9)
    np.testing.assert_allclose(gaps[1], -0.05, rtol=0, atol=1e-6)
    assert below.adhesive_traction.max() < 0 < above.adhesive_traction.min()
    np.testing.assert_allclose(above.normal, np.broadcast_to([0.0, -1.0], above.normal.shape), atol=1e-7)
    with pytest.raises(InputError, match="2 of the kind interface"):
        front_profile(problem, space, lift)
    with pytest.raises(
        InputError, match=r"interface: 'body.left' cannot be used; there is body.bottom, body.top"
    ):
        InterfacePoints(problem, space, np.array([[0.5]]), interface="body.left")


def run_of(problem: Problem, steps: list[Step], every: int) -> StoredRun:
    curve = Curve.of(steps, problem.drive)
    attributes = run_attributes(problem, SPACES, Provenance({}, "", "", "", "")) | {
        "L0": "1 nm",
        "E0": "2 GPa",
    }
    kept = [*steps[:-1:every], steps[-1]]
    return StoredRun("", curve, tuple(state_of(step, problem) for step in kept), attributes, "completed")


def test_the_summary_names_the_interfaces() -> None:
    problem = both(TURN, "first")
    run = run_of(problem, steps_of(problem, SPACES, PATHS["first"][1]), 6)
    found = find(problem, SPACES, run, (90.0, 120.0), Laboratory.of(UnitSystem(), problem))
    summary = summarize("two", run, found, 1.0, mesh_changes(problem, SPACES, run))
    names = [row.name for row in summary_rows(summary, run.curve, found)]
    assert {"crack length, first.bottom", "process zone, first.bottom"} <= set(names)
    assert "elements in process zone, second.bottom" in names
    assert not any("second" in name for name in names if name.startswith(("crack", "process")))
    assert found.closed_form is None
    assert summary["closed_form"] is None
    assert (summary["space"], summary["mesh"]) == ("N2.1, N3", "40x2, 30x2")
    zone = summary["process_zone"]["first.bottom"]["measured"]
    assert zone["length"] == pytest.approx(found.fronts["first.bottom"][24].zone.length)
    texts = [note["text"] for note in summary["notes"]]
    assert any(text.startswith("closed forms exist for one body with one interface") for text in texts)
    # the tape that is peeled has the estimate that it has alone
    own = estimated(alone(0, TURN), SPACES["first"])
    beside = estimated(problem, SPACES, "first.bottom")
    assert own is not None
    assert own == beside
    (change, *_) = summary["finer_mesh"]
    # the moment is within 3 % of that on elements of half the length
    assert 0 < change["relative_change"] < 0.03


def test_the_note_on_penetration_names_the_side(single: dict[str, list[Step]]) -> None:
    """The deepest of several; a single interface has only the one face."""
    run = StoredRun("", Curve.of(single["first"], TURN), (), {}, "completed")
    depths = {"first.bottom": Depth(1.0, "substrate"), "second.bottom": Depth(2.0, "body third")}
    texts = {}
    for count in (1, 2):
        found = Findings(None, None, None, depths, fronts={name: {} for name in [*depths][:count]})
        notes = run_notes(run, found, 0.0)
        texts[count] = [note.text for note in notes if note.subject == "penetration"]
    assert texts == {
        1: ["a part of the face without adhesion is up to 2 nm inside the body third"],
        2: ["a part of the side second.bottom without adhesion is up to 2 nm inside the body third"],
    }


def test_figures_show_all_bodies_and_interfaces(single: dict[str, list[Step]]) -> None:
    problem = both(TURN, "first")
    state = joined(single["first"][-1], single["second"][-1], problem)
    drawn = drawn_state(problem, SPACES, state)
    whole, *fronts, bar = shapes_figure(problem, SPACES, [state]).axes
    assert [axes.get_title("left") for axes in fronts] == [
        "front of first.bottom at 0°",
        "front of second.bottom at 0°",
    ]
    # both bodies on one scale, in all three pictures
    meshes = [one for axes in (whole, *fronts) for one in axes.collections if isinstance(one, TriMesh)]
    assert len(meshes) == 6
    limits = {mesh.get_clim() for mesh in meshes}
    assert limits == {(-stress_scale([drawn]), stress_scale([drawn]))}
    assert whole.get_xlim()[0] < 0 < 170 < whole.get_xlim()[1]
    assert bar.get_ylabel() == r"$I_1 = \mathrm{tr}\,\sigma / E$"
    figure = front_figure(problem, SPACES, state)
    titles = [part.axes[0].get_title("left") for part in figure.subfigs]
    assert [title.partition(" at")[0] for title in titles] == [
        "front of first.bottom",
        "front of second.bottom",
    ]
    rows = tractions_figure(problem, SPACES, [state]).subfigs
    for row, name in zip(rows, problem.interface_names, strict=True):
        profile = profile_of(problem, state, name)
        line = np.asarray(row.axes[0].lines[1].get_xydata()).T
        np.testing.assert_array_equal(line[1], -profile.adhesive_traction.ravel())
        assert row.axes[0].get_title("left") == f"{name}: all of the face"


def test_a_front_is_drawn_with_the_substrates_of_its_body() -> None:
    """The plane of another body would fill the gap of this one."""
    problem = both(TURN, "first")
    lower = replace(problem.interfaces[1], against=Flat(0.1))
    apart = replace(problem, interfaces=(problem.interfaces[0], lower))
    assert substrates(problem) == [Flat()]
    assert substrates(apart) == [Flat(), Flat(0.1)]
    assert substrates(apart, "first.bottom") == [Flat()]
    assert substrates(apart, "second.bottom") == [Flat(0.1)]
    walls, _ = two_sided()
    assert len(substrates(walls, "body.top")) == 2


def test_an_interface_at_rest_is_drawn_as_none(single: dict[str, list[Step]]) -> None:
    """Beside one that peels: round-off has no scale of its own."""
    problem = both(TURN, "first")
    peeled, rest = single["first"][-1], single["second"][0]
    *_, last = tractions_figure(problem, SPACES, [joined(peeled, rest, problem)]).subfigs
    assert last.axes[0].get_ylim()[1] == pytest.approx(1e-3 * LAWS[0].strength, rel=0.01)


def test_a_part_of_a_side_that_another_interface_holds_is_not_free() -> None:
    """Only what adheres to nothing may lie inside of a substrate without a force."""
    problem = strip(length=20.0, height=2.0, adhering_length=10.0)
    space = row_space("N2", (20, 2))
    down = np.zeros((space.size, 2))
    down[:, 1] = -1.0
    deep = problem.adhesion.substrate
    assert isinstance(deep, Flat)
    inside = depths_inside(problem, space, [StoredState(0, 0.0, down)])
    assert inside["body.bottom"].depth == pytest.approx(1.0 + deep.height, rel=1e-12)
    assert inside["body.bottom"].inside == "substrate"
    rest = replace(problem.adhesion, boundary=problem.body.side("bottom", 0.5, 1.0))
    whole = replace(problem, interfaces=(*problem.interfaces, rest))
    assert depths_inside(whole, space, [StoredState(0, 0.0, down)]) == {}


def test_a_support_on_a_part_of_a_side_is_not_that_of_a_closed_form() -> None:
    problem, space = strip(), row_space("N2", (40, 2))
    assert theory(problem, space).form is not None
    part = Support(problem.body.side("left", 0.0, 0.5), (0,))
    assert theory(replace(problem, supports=(part,)), space).form is None


def test_a_bar_without_an_interface_has_findings() -> None:
    drive: Drive = MovedSide("right", 0.0)
    supports = (Support(FIRST.side("left"), (0,)), Support(FIRST.side("bottom"), (1,)))
    bar = Problem("bar", (FIRST,), (), supports, drive)
    spaces = {"first": row_space("N2", (8, 2))}
    steps = steps_of(bar, spaces, np.linspace(0.0, 0.1, 4))
    run = StoredRun("", Curve.of(steps, drive), (state_of(steps[-1], bar),), {}, "completed")
    found = find(bar, spaces, run, None)
    (largest,) = found.readings
    assert largest.value == pytest.approx(steps[-1].reaction, rel=1e-12)
    assert len(shapes_figure(bar, spaces, run.states).axes) == 2
    with pytest.raises(InputError, match="that of an interface"):
        front_figure(bar, spaces, run.states[0])


def test_two_bodies_of_one_name_have_no_results() -> None:
    with pytest.raises(InputError, match="the bodies are first, second"):
        both(TURN, "third")
    assert SECOND.name == "second"
