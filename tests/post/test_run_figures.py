"""Figures of one run and of several: lines have the values that were read, pictures the named states."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection, TriMesh
from matplotlib.lines import Line2D

import isopeel
from isopeel import Curve, InputError
from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.units import UnitSystem
from isopeel.post.comparison import Compared, comparison, difference
from isopeel.post.figures import (
    comparison_figure,
    front_figure,
    plateau_figure,
    reaction_figure,
    shapes_figure,
    tractions_figure,
)
from isopeel.post.figures.labels import power_of_ten
from isopeel.post.figures.moving import MovingFigure
from isopeel.post.findings import Findings
from isopeel.post.front import front_profile, process_zone
from isopeel.post.laboratory import Laboratory
from isopeel.post.plateau import oscillation, read_plateau
from isopeel.post.style import line_style
from isopeel.problem import Column
from isopeel.results.fields import StoredState
from isopeel.results.run_file import StoredRun
from isopeel.solve.step import KINDS

ANGLE, MOMENT = Column("theta_deg", "degree"), Column("moment", "E0 L0^3", words="moment $M$")
PERIOD = 2.0
PROBLEM, SPACE = isopeel.strip(), isopeel.row_space("N2", (40, 2))


def curve_of(
    parameter: FloatArray, reaction: FloatArray, kinds: tuple[str, ...] = (), unstable: tuple[int, ...] = ()
) -> Curve:
    count = len(parameter)
    zeros, negative = frozen(np.zeros(count)), np.zeros(count, dtype=np.int64)
    negative[list(unstable)] = 1
    kind = [KINDS.index(name) for name in kinds] if kinds else [0] * count
    return Curve(
        *(ANGLE, MOMENT, frozen(parameter), frozen(reaction), np.zeros(count, dtype=np.int64)),
        *(zeros, zeros, zeros, zeros, frozen(np.full(count, 0.02)), frozen(np.empty(0))),
        *(np.array(kind, dtype=np.int64), negative),
    )


def waves(amplitude: float, drift: float = 1e-4) -> Curve:
    """A plateau at 1.6 that drifts, and oscillates with the period 2, at steps of 0.1 up to 40."""
    angle = np.linspace(0, 40, 401)
    return curve_of(angle, 1.6 + drift * angle + amplitude / 2 * np.sin(2 * np.pi * angle / PERIOD))


def compared(name: str, curve: Curve, window: tuple[float, float] = (10.0, 20.0)) -> Compared:
    attributes: dict[str, str | int] = {"space": name, "mesh": "1x1", "dofs": 8, "L0": "1 nm", "E0": "2 GPa"}
    run = StoredRun("", curve, (), attributes, "completed")
    return Compared(name, run, Findings(window, read_plateau(curve, window), None, {}))


def data(line: Line2D) -> FloatArray:
    return np.asarray(line.get_xydata(), dtype=np.float64).T


@pytest.fixture
def bent() -> FloatArray:
    """A ramp that rises smoothly from x = 100: a front at rest."""
    x = 200 * SPACE.greville[:, 0]
    displacement = np.zeros((SPACE.size, 2))
    displacement[:, 1] = np.maximum(x - 100, 0) / 20
    return displacement


def test_the_oscillation_is_the_curve_without_its_drift() -> None:
    curve = waves(0.01, drift=0.003)
    plateau = read_plateau(curve, (10.0, 20.0), PERIOD)
    assert plateau is not None
    read = oscillation(curve, plateau, PERIOD)
    np.testing.assert_allclose(read.parameter, np.arange(10, 20.05, 0.1))
    # the mean over a period of a sine is zero, up to a spline through 20 steps of a period
    np.testing.assert_allclose(read.values, 0.005 * np.sin(np.pi * read.parameter), rtol=0, atol=1e-6)
    np.testing.assert_allclose(np.diff(read.drift), 0.0003, rtol=0, atol=1e-8)
    # the same but for the order of sums
    assert np.ptp(read.values) == pytest.approx(plateau.amplitude, rel=1e-9)


def test_the_plateau_shows_what_was_read() -> None:
    curve = waves(0.01)
    plateau = read_plateau(curve, (10.0, 20.0), PERIOD)
    assert plateau is not None
    figure = plateau_figure(curve, plateau, PERIOD)
    around, inside = figure.axes
    np.testing.assert_array_equal(data(around.lines[0]), [curve.parameter[:301], curve.reaction[:301]])
    assert around.get_xlabel() == "theta_deg / degree"
    assert around.get_ylabel() == "moment $M$ / $E_0 L_0^3$"
    assert inside.get_ylabel() == "deviation / $10^{-3}$ $E_0 L_0^3$"
    read = oscillation(curve, plateau, PERIOD)
    np.testing.assert_array_equal(data(inside.lines[1]), [read.parameter, read.values / 1e-3])
    legend = inside.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [
        # 0.1 from a zero of 0.005 sin(pi x): 0.005 sin(0.1 pi)/0.1
        "steepest rise $1.55\\times 10^{-2}$ per degree",
        "steepest fall $-1.55\\times 10^{-2}$ per degree",
        "amplitude $1.00\\times 10^{-2}$",
        "period of the elements 2 degree",
    ]
    rise, fall = (data(line) for line in inside.lines[2:4])
    assert np.diff(rise[1]) / np.diff(rise[0]) == pytest.approx(plateau.steepest_rise / 1e-3)
    assert np.diff(fall[1]) / np.diff(fall[0]) == pytest.approx(plateau.steepest_fall / 1e-3)


def test_a_jump_is_no_part_of_the_curve() -> None:
    kinds = ("requested", "requested", "jump", "requested")
    curve = curve_of(np.array([0.0, 1.0, 1.0, 2.0]), np.array([0.0, 2.0, 1.0, 1.5]), kinds)
    (axes,) = reaction_figure(curve).axes
    stable, jump, mark = axes.lines
    np.testing.assert_array_equal(data(stable), [[0, 1, np.nan, 1, 2], [0, 2, np.nan, 1, 1.5]])
    np.testing.assert_array_equal(data(jump)[:, 2:4], [[1, 1], [2, 1]])
    assert jump.get_linestyle() != stable.get_linestyle()
    np.testing.assert_array_equal(data(mark), [[1], [1]])


def test_a_snap_back_is_dashed_between_its_limit_points() -> None:
    kinds = ("requested", "limit point", "between", "limit point", "requested")
    curve = curve_of(np.array([0.0, 2.0, 1.5, 1.0, 3.0]), np.array([0.0, 2.0, 1.5, 1.0, 2.5]), kinds, (2,))
    whole, turned = reaction_figure(curve).axes
    for axes in (whole, turned):
        stable, unstable, limits = axes.lines
        np.testing.assert_array_equal(
            data(stable)[0], [0, 2, np.nan, 1.5, np.nan, 1, 3]
        )  # the point between two breaks is not drawn
        np.testing.assert_array_equal(data(unstable)[0], [0, np.nan, 2, 1.5, 1, np.nan, 3])
        np.testing.assert_array_equal(data(limits)[0], [2, 1])


def test_tractions_are_those_of_the_states(bent: FloatArray) -> None:
    states = [StoredState(step, at, at / 20 * bent) for step, at in enumerate((0.0, 10.0, 20.0))]
    profiles = [front_profile(PROBLEM, SPACE, state.displacement) for state in states]
    figure = tractions_figure(PROBLEM, SPACE, states, Laboratory(UnitSystem(), 200.0))
    whole, fronts = figure.axes
    _, *lines = whole.lines
    assert [line.get_label() for line in lines] == ["0°", "10°", "20°"]
    for line, profile in zip(lines, profiles, strict=True):
        tension = [profile.position.ravel(), -profile.adhesive_traction.ravel()]
        np.testing.assert_array_equal(data(line), tension)
    # there is no front at rest; those of the others begin to be seen from their peaks
    zone = process_zone(profiles[1])
    assert zone is not None
    assert len(fronts.lines) == 3
    x, tension = data(fronts.lines[1])
    assert x[tension.argmax()] == pytest.approx(0, abs=1e-12)
    assert tension.max() == zone.peak
    assert whole.get_xlabel() == "distance along the face / nm"
    assert whole.get_ylabel() == "tension $-T$ / MPa"
    # ticks are those of internal values, in E0 = 2 GPa, written in MPa
    assert whole.yaxis.get_major_formatter()(0.05, 0) == "100"
    with pytest.raises(InputError, match="one state at least"):
        tractions_figure(PROBLEM, SPACE, [])


def test_without_a_front_there_is_one_panel() -> None:
    rest = StoredState(0, 0.0, np.zeros((SPACE.size, 2)))
    (axes,) = tractions_figure(PROBLEM, SPACE, [rest]).axes
    assert axes.get_ylabel() == "tension $-T$ / $E_0$"


def test_the_front_shows_stress_forces_and_tensions(bent: FloatArray) -> None:
    figure = front_figure(PROBLEM, SPACE, StoredState(1, 20.0, bent))
    upper, lower, bar = figure.axes
    profile = front_profile(PROBLEM, SPACE, bent)
    zone = process_zone(profile)
    assert zone is not None
    assert upper.get_title("left") == "front at 20°: $I_1$ of the body, and the force of the adhesion on it"
    assert upper.get_xlim()[0] < zone.position < upper.get_xlim()[1]
    assert [type(mesh) for mesh in upper.collections].count(TriMesh) == 1
    *_, forces = (found for found in upper.collections if isinstance(found, LineCollection))
    segments = np.array(forces.get_segments())
    # as an attraction is: from the face down; and the longest one where it is strongest
    lengths = segments[:, 0, 1] - segments[:, 1, 1]
    assert segments[lengths.argmax(), 0, 0] == pytest.approx(zone.position, abs=0.5)  # 80 to a width of 32
    assert upper.get_ylim()[0] < segments[:, 1, 1].min()
    _, adhesion, body = lower.lines
    tension = data(adhesion)[1]
    np.testing.assert_array_equal(tension[~np.isnan(tension)], -profile.adhesive_traction.ravel())
    held = data(body)[1]
    np.testing.assert_array_equal(held[~np.isnan(held)], -profile.body_traction.ravel())
    assert f"process zone {zone.length:.3g} $L_0$" in [text.get_text() for text in lower.texts]
    assert bar.get_ylabel() == r"$I_1 = \mathrm{tr}\,\sigma / E$"


def test_a_front_that_is_wider_than_a_thin_body_is_seen_whole(bent: FloatArray) -> None:
    problem = isopeel.strip(height=0.2)
    zone = process_zone(front_profile(problem, SPACE, bent))
    assert zone is not None
    # the window is 3.2 heights wide where the front is narrower than that
    assert zone.length > 3.2 * 0.2
    upper, lower, *_ = front_figure(problem, SPACE, StoredState(1, 20.0, bent)).axes
    assert lower.get_xlim()[0] <= zone.start < zone.end <= lower.get_xlim()[1]
    # the ramp moves points up alone
    assert upper.get_xlim()[0] < zone.start < zone.end < upper.get_xlim()[1]
    assert any("process zone" in text.get_text() for text in lower.texts)


def test_a_body_at_rest_has_a_front_figure() -> None:
    figure = front_figure(PROBLEM, SPACE, StoredState(0, 0.0, np.zeros((SPACE.size, 2))))
    assert figure.axes[0].get_title("left").startswith("front at 0°")
    figure.draw_without_rendering()


def test_a_front_between_the_points_of_long_elements_can_be_drawn() -> None:
    space = isopeel.row_space("L1", (2, 1))
    rest = StoredState(0, 0.0, np.zeros((space.size, 2)))
    figure = front_figure(isopeel.strip(height=0.5), space, rest)
    lower = figure.axes[1]
    # 1.6 times the height either way, of 150 that adhere: the window lies at their end
    assert lower.get_xlim() == pytest.approx((150 - 0.8, 150), abs=1e-9)
    figure.draw_without_rendering()


def test_all_chosen_shapes_are_drawn(bent: FloatArray) -> None:
    # their ends lie closer together than shapes that are not chosen may
    states = [StoredState(at, float(at), at / 1000 * bent) for at in (1, 2, 7)]
    figure = shapes_figure(PROBLEM, SPACE, states, every=True)
    assert [text.get_text() for text in figure.axes[0].texts] == ["1°", "2°", "7°"]


def test_curves_are_laid_over_each_other() -> None:
    one, other = compared("one", waves(0.01)), compared("other", waves(0.02))
    figure = comparison_figure([one, other])
    whole, apart, oscillations = figure.axes
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["one", "other"]
    for line, run in zip(whole.lines, (one, other), strict=True):
        np.testing.assert_array_equal(data(line), [run.run.curve.parameter, run.run.curve.reaction])
    expected = 5 * np.sin(np.pi * one.run.curve.parameter)  # of 0.005, in thousandths
    np.testing.assert_allclose(data(apart.lines[1])[1], expected, rtol=0, atol=1e-9)
    assert apart.get_title("left") == "less that of one"
    assert apart.get_ylabel() == "difference / $10^{-3}$ $E_0 L_0^3$"
    assert len(oscillations.lines) == 2
    with pytest.raises(InputError, match="two or more"):
        comparison_figure([one])


def test_missing_plateaus_and_parameters_in_common_are_reported() -> None:
    angle = np.linspace(0, 1, 11)
    one, other = (compared(f"{k}", curve_of(angle + k * 0.03, angle)) for k in (1, 2))
    _, apart = comparison_figure([one, other]).axes
    assert [text.get_text() for text in apart.texts] == ["no parameter in common"]


def test_differences_are_at_common_parameters() -> None:
    first = curve_of(np.array([0.0, 0.1, 0.2, 0.3]), np.array([0.0, 1.0, 2.0, 3.0]))
    # 0.1 * 3 differs from 0.3 by round-off; 0.15 is not there
    other = curve_of(np.array([0.0, 0.15, 0.2, 0.1 * 3, 0.5]), np.array([1.0, 2.0, 5.0, 7.0, 9.0]))
    found = difference(other, first)
    assert found.parameter.tolist() == [0.0, 0.2, 0.1 * 3]
    assert found.reaction.tolist() == [1.0, 3.0, 4.0]
    # where a curve turns back, the steps beyond all before it: 2 at 1.5 and the way back are left out
    back = curve_of(np.array([0.0, 0.2, 0.1, 0.3]), np.array([0.0, 5.0, 6.0, 7.0]))
    assert difference(back, first).reaction.tolist() == [0.0, 3.0, 4.0]
    # towards smaller parameters
    down = curve_of(np.array([0.0, -1.0]), np.array([0.0, 4.0]))
    assert difference(down, down).reaction.tolist() == [0.0, 0.0]


def test_a_comparison_tabulates_what_was_read() -> None:
    # five periods, from peak to peak: the line that is fitted does not slope for them
    window = (10.5, 20.5)
    first, second = comparison(
        [compared("one", waves(0.01), window), compared("two", waves(0.02), (50.0, 60.0))]
    )
    assert (first["run"], first["space"], first["dofs"], first["steps"]) == ("one", "one", 8, 401)
    # 1e-4 per degree, at 15.5; one of the 101 steps is a peak too many
    assert first["plateau"] == pytest.approx(1.60155, abs=0.005 / 100)
    assert first["amplitude"] == pytest.approx(0.01, rel=1e-9)  # round-off
    assert first["seconds_per_step"] == 0.02
    assert first["largest_difference"] == 0
    assert (second["plateau"], second["amplitude"], second["steepest_rise"]) == (None, None, None)
    assert abs(second["largest_difference"]) == pytest.approx(0.005)


def test_lines_differ_in_colour_and_dashes() -> None:
    looks = [line_style(number) for number in range(42)]
    assert len({str(look) for look in looks}) == 42
    assert len({str(look["linestyle"]) for look in looks[:6]}) == 6
    assert len({look["color"] for look in looks[:7]}) == 7


def test_powers_of_ten() -> None:
    assert [power_of_ten(np.array([value]), 1.0) for value in (0.0, 0.5, -20.0)] == [-12, -1, 1]
    assert power_of_ten(np.empty(0), 0.0) == -300


def test_a_moving_figure_moves(bent: FloatArray) -> None:
    curve = curve_of(np.array([0.0, 10.0, 20.0]), np.array([0.0, 1.0, 1.5]))
    states = [StoredState(0, 0.0, 0 * bent), StoredState(2, 20.0, bent)]
    moving = MovingFigure(PROBLEM, SPACE, curve, states, (500, 240))
    assert len(moving) == 2
    first, last, again = (moving.picture(number).astype(int) for number in (0, 1, 0))
    assert first.shape == (240, 500, 3)
    assert np.abs(last - first).max() > 100
    np.testing.assert_array_equal(first, again)
    # the mark is orange, and lies higher and further to the right in the last state
    marks = [np.argwhere((picture == (230, 159, 0)).all(axis=2)).mean(axis=0) for picture in (first, last)]
    assert marks[1][0] < marks[0][0] - 20
    assert marks[1][1] > marks[0][1] + 20
