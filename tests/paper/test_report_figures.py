"""Figures of the report: they hold what was given, nothing is cut off or hidden, a space has one look."""

from collections.abc import Callable, Iterator
from functools import cache
from itertools import combinations, pairwise

import numpy as np
import pytest
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import same_color, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from isopeel import InputError
from isopeel.common.arrays import FloatArray
from isopeel.paper.figures import (
    Amplitude,
    Cost,
    NewtonHistory,
    Trace,
    bases_figure,
    convergence_figure,
    cost_figure,
    linear_figure,
    meshes_figure,
    newton_figure,
    panels_figure,
    quadrature_figure,
    refinement_figure,
    windows_figure,
)
from isopeel.paper.study import CONTACT_ROW, LITERATURE, MESHES, SPACES, default_points
from isopeel.post.style import GREY, space_style, style

WINDOW = (98.0, 101.4)
# amplitudes at m2, in 1e-3 E0 L0^3, as two other codes found them
ALL = dict(zip(SPACES, (5.64, 0.85, 0.005, 4.46, 2.74, 1.96, 1.52, 0.08, 0.01), strict=True))
CONTACT = dict(zip(CONTACT_ROW, (1.74, 0.617, 4.78, 2.96, 2.04, 1.58, 0.355, 0.445), strict=True))
PUBLISHED = dict(zip(SPACES, (5.58, 1.49, 0.552, 4.28, 2.88, 1.80, 1.40, 0.34, 0.1), strict=True))
FINENESS = {"m1": 2.5, "m2": 1.0, "m3": 0.37}
STARTS = np.arange(85.0, 107.0, 0.5)


def curve(space: str, mesh: str = "m2", end: float = 150.0) -> Trace:
    """A plateau with a sawtooth whose period is one element, and a drift."""
    angles = np.round(np.arange(0, end + 0.05, 0.1), 10)
    phase = angles / (1.077 * 200 / MESHES[mesh][0]) % 1
    sawtooth = 1e-3 * ALL[space] * FINENESS[mesh] * (np.minimum(phase / 0.8, (1 - phase) / 0.2) - 0.5)
    rise = 1.63 * (1 - np.exp(-((angles / 25) ** 2)))
    return Trace(angles, rise + 1e-5 * np.maximum(angles - 80, 0) + np.where(angles > 60, sawtooth, 0))


HISTORIES = [
    NewtonHistory("L1", 69.3, (1e-5, 1e-8, 1e-14, 1e-26), True),
    NewtonHistory("L1", 69.4, (1e-5, 1e-3, 1e-6, float("inf"), 1e-2), False),
    NewtonHistory("N2", 72.1, (1e-5, 1e-8, 1e-14, 0.0), True),
    NewtonHistory("N2", 72.2, tuple(np.geomspace(1e-6, 1e-3, 25)), False),
    NewtonHistory("N4", 100.0, (1e-5, 1e-8, 1e-14, 1e-26), True),
    NewtonHistory("N2.1", 100.0, (1e-5, 1e-8, 1e-14, 1e-26), True),
]
LINEAR = {"m1": curve("L1", "m1", 69.3), "m2": curve("L1", "m2", 107.2), "m3": curve("L1", "m3")}
CURVES = {space: curve(space, end=147.3 if space == "N2" else 150.0) for space in SPACES}
REFINED = {(space, mesh): curve(space, mesh) for space in ("L4", "N2.1") for mesh in MESHES}
AMPLITUDES = [
    Amplitude(
        space,
        mesh,
        None if mesh == "m1" and space in ("L1", "N2") else 1e-3 * ALL[space] * factor,
        None if space == "L1" else 1e-3 * CONTACT[f"L1+{space}"] * factor,
        1.1e-3 * PUBLISHED[space] * factor if "." in space else None,
        None if mesh == "m1" and space in ("L1", "N2") else 1e-3 * PUBLISHED[space] * factor,
    )
    for mesh, factor in FINENESS.items()
    for space in SPACES
]
MOVED = {
    space: 1e-3 * amplitude * np.where((space == "L1") & (STARTS > 103), np.nan, 1 + (STARTS - 98) / 50)
    for space, amplitude in {**ALL, **CONTACT}.items()
}
POINTS = {
    space: {n: 1e-3 * amplitude * (1 + 1 / n**2) for n in range(2, default_points(space) + 2)}
    for space, amplitude in {**ALL, **CONTACT}.items()
}
DEFAULT = {space: default_points(space) for space in POINTS}
COSTS = [
    Cost(space, mesh, 40 * MESHES[mesh][0] * (1 + k % 3), 0.01 * k + 0.02, 1e-2 * factor / (k + 1) ** 2)
    for k, space in enumerate((*SPACES, *CONTACT_ROW, *LITERATURE))
    for mesh, factor in FINENESS.items()
]
MAKERS: dict[str, Callable[[], Figure]] = {
    "bases": bases_figure,
    "refinement": refinement_figure,
    "newton": lambda: newton_figure(HISTORIES),
    "linear": lambda: linear_figure(LINEAR),
    "panels": lambda: panels_figure(CURVES, WINDOW),
    "meshes": lambda: meshes_figure(REFINED, WINDOW),
    "convergence": lambda: convergence_figure(AMPLITUDES),
    "windows": lambda: windows_figure(
        STARTS, MOVED, WINDOW, {space: 1e-3 * value for space, value in PUBLISHED.items()}
    ),
    "quadrature": lambda: quadrature_figure(POINTS, DEFAULT),
    "cost": lambda: cost_figure(COSTS[::-1]),
}


@cache
def drawn(name: str) -> Figure:
    figure = MAKERS[name]()
    FigureCanvasAgg(figure)
    with style():
        figure.draw_without_rendering()
    return figure


def data(line: Line2D) -> FloatArray:
    return np.array(line.get_xydata(), dtype=np.float64).T


def hidden_labels(axis: Axis) -> Iterator[Text]:
    """Labels of ticks that lie outside the axis, which are not drawn."""
    low, high = np.sort(axis.get_view_interval()) + np.array([-1e-9, 1e-9]) * np.ptp(axis.get_view_interval())
    for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
        if not low <= tick.get_loc() <= high:
            yield from (tick.label1, tick.label2)


@pytest.mark.parametrize("name", MAKERS)
def test_all_text_is_on_the_canvas_and_apart(name: str) -> None:
    figure = drawn(name)
    axis = [axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)]
    hidden = {text for one in axis for text in hidden_labels(one)}
    texts = [text for text in figure.findobj(Text) if isinstance(text, Text) and text.get_text().strip()]
    boxes = {text: text.get_window_extent() for text in texts if text.get_visible() and text not in hidden}
    assert len(boxes) > 8
    pixel = 1.0
    for text, box in boxes.items():
        assert box.x0 > -pixel, text
        assert box.y0 > -pixel, text
        assert box.x1 < figure.bbox.x1 + pixel, text
        assert box.y1 < figure.bbox.y1 + pixel, text
    for (one, a), (other, b) in combinations(boxes.items(), 2):
        common = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        assert min(common) < pixel, (one, other)
    for legend in figure.legends:
        assert not any(axes.get_window_extent().overlaps(legend.get_window_extent()) for axes in figure.axes)


@pytest.mark.parametrize("name", ["linear", "panels"])
def test_a_legend_inside_a_panel_hides_no_curve(name: str) -> None:
    whole = drawn(name).axes[0]
    legend = whole.get_legend()
    assert legend is not None
    box = legend.get_window_extent()
    for line in whole.lines:
        x, y = whole.transData.transform(data(line).T).T
        assert not np.any((x > box.x0) & (x < box.x1) & (y > box.y0) & (y < box.y1))


def lightness_and_colour(color: str, seen_by: FloatArray) -> FloatArray:
    """CIELAB of an sRGB colour, after a matrix on linear sRGB."""
    encoded = np.array(to_rgb(color))
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.cbrt(to_xyz @ np.clip(seen_by @ linear, 0, 1) / [0.9505, 1, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


# Machado, Oliveira and Fernandes (2009), for those who lack one kind of cone
VISION = {
    "common": np.eye(3),
    "no long-wave cones": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "no middle-wave cones": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]]
    ),
    "no short-wave cones": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]]
    ),
}


@pytest.mark.parametrize("vision", VISION)
def test_colours_of_spaces_differ_for_everyone(vision: str) -> None:
    seen = [lightness_and_colour(space_style(space).color, VISION[vision]) for space in SPACES]
    # 2.3 is just noticeable side by side; thin lines apart from each other need several times that
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 15


def test_spaces_differ_without_colour() -> None:
    looks = {space: space_style(space) for space in (*SPACES, *CONTACT_ROW, *LITERATURE)}
    assert len({(look.marker, look.hollow) for look in looks.values()}) == len(looks) == 23
    grey = {space: lightness_and_colour(looks[space].color, np.eye(3))[0] for space in SPACES}
    for one, other in combinations(SPACES, 2):
        if looks[one].linestyle == looks[other].linestyle:
            assert abs(grey[one] - grey[other]) > 15  # of 100 from black to white


def test_the_contact_row_alone_looks_like_its_space_but_hollow() -> None:
    full, enriched = space_style("N2.1"), space_style("Q1N2.1")  # the published name of L1+N2.1
    assert (enriched.color, enriched.marker, enriched.linestyle) == (full.color, full.marker, full.linestyle)
    assert enriched.marked["markerfacecolor"] == "white"
    assert full.marked["markerfacecolor"] == full.color
    assert enriched.line["linewidth"] < full.line["linewidth"]
    with pytest.raises(InputError, match="what a name may be"):
        space_style("M3")


@pytest.mark.parametrize("name", ["panels", "windows", "quadrature", "cost"])
def test_the_legend_shows_each_space_in_its_own_look(name: str) -> None:
    figure = drawn(name)
    (legend,) = figure.legends
    lines = [line for line in legend.legend_handles if isinstance(line, Line2D)]
    message = {text.get_text(): line for text, line in zip(legend.get_texts(), lines, strict=True)}
    extra = {
        "panels": set(),
        "windows": {"L1+X", "used"},
        "quadrature": {"L1+X", "in all other runs"},
        "cost": {"L1+X", *LITERATURE},
    }[name]
    assert set(message) == set(SPACES) | extra  # L1+X differs from X in being hollow only
    for space in SPACES:
        look = space_style(space)
        assert same_color(message[space].get_color(), look.color)
        assert message[space].get_marker() == look.marker


@pytest.mark.parametrize("name", ["bases", "newton", "meshes", "convergence"])
def test_the_panel_of_a_space_has_its_colour(name: str) -> None:
    for axes in drawn(name).axes:
        space = axes.get_title("left").split(":")[0]
        # knots, published amplitudes, and those of another space
        other = {"bases": "^", "convergence": "_"}.get(name)
        others = [line for line in axes.lines if line.get_marker() == other or line.get_color() == GREY]
        coloured = [line for line in axes.lines if line not in others]
        assert coloured
        assert all(same_color(line.get_color(), space_style(space).color) for line in coloured)


def test_bases_are_partitions_of_unity_of_the_known_size() -> None:
    figure = drawn("bases")
    # degree p and continuity c on six elements: 5 (p - c) + p + 1
    sizes = {"L2": 13, "N2": 8, "N2.1": 14, "L4": 25, "N4": 10, "N4.1": 16}
    for axes, (space, size) in zip(figure.axes, sizes.items(), strict=True):
        assert axes.get_title("left").startswith(f"{space}: ")
        assert axes.get_title("left").endswith(f"{size} functions")
        functions = [line for line in axes.lines if line.get_marker() == "None"]
        assert len(functions) == size
        x = np.linspace(0.05, 5.95, 7)
        values = [np.interp(x, data(line)[0], data(line)[1], left=0, right=0) for line in functions]
        # chords of 40 points to an element: 1/8 (1/40)^2 times a second derivative of about 10
        np.testing.assert_allclose(np.sum(values, axis=0), 1, atol=1e-3)


def test_refinement_keeps_the_function_and_counts_what_it_adds() -> None:
    figure = drawn("refinement")
    panels = {axes.get_title("left").split("\n")[0]: axes for axes in figure.axes if axes.lines}
    known = {
        "a coarse space": (2, 4, [1]),
        "h: knots inserted": (2, 6, [1, 1, 1]),
        "p: degree elevated": (3, 6, [1]),
        "h, then p: knots inserted, then elevated": (3, 10, [1, 1, 1]),
        "k: elevated, then knots inserted": (3, 8, [2, 1, 2]),
    }
    assert set(panels) == set(known)
    coarse = data(panels["a coarse space"].lines[-1])
    for title, (degree, size, continuities) in known.items():
        assert panels[title].get_title("left").endswith(f"degree {degree}, {size} functions")
        assert [text.get_text() for text in panels[title].texts] == [f"$C^{k}$" for k in continuities]
        # refinement is exact to round-off; values are of the order of one
        np.testing.assert_allclose(data(panels[title].lines[-1]), coarse, rtol=0, atol=1e-14)


def test_newton_histories_are_drawn_where_there_is_a_logarithm() -> None:
    figure = drawn("newton")
    assert [axes.get_title("left").split(":")[0] for axes in figure.axes] == ["L1", "N2", "N4", "N2.1"]
    converging, diverging = figure.axes[0].lines
    np.testing.assert_array_equal(data(converging), [[1, 2, 3, 4], [1e-5, 1e-8, 1e-14, 1e-26]])
    np.testing.assert_array_equal(data(diverging)[1], [1e-5, 1e-3, 1e-6, np.nan, 1e-2])
    np.testing.assert_array_equal(data(figure.axes[1].lines[0])[1], [1e-5, 1e-8, 1e-14, np.nan])
    assert diverging.get_markerfacecolor() == "white"
    assert figure.axes[0].get_title("left") == "L1: 69.3°\n69.4° not converging"
    assert {axes.get_yscale() for axes in figure.axes} == {"log"}


def test_the_end_of_an_incomplete_curve_is_marked() -> None:
    whole, enlarged = drawn("linear").axes
    curves = [line for line in whole.lines if line.get_marker() == "None"]
    for line, trace in zip(curves, LINEAR.values(), strict=True):
        np.testing.assert_array_equal(data(line), [trace.angles_deg, trace.moments])
    assert len({(line.get_linestyle(), line.get_linewidth()) for line in curves}) == 3
    crosses = [line for line in whole.lines if line.get_marker() == "x"]
    ends = [(trace.angles_deg[-1], trace.moments[-1]) for trace in (LINEAR["m1"], LINEAR["m2"])]
    np.testing.assert_array_equal([data(cross).ravel() for cross in crosses], ends)
    legend = whole.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["m1 ends at 69.3°", "m2 ends at 107.2°"]
    # m1 does not get to the part that is enlarged, 95 to 105 degrees in steps of 0.1
    assert [data(line).shape[1] for line in enlarged.lines] == [101, 101]
    _, empty = linear_figure({"m1": LINEAR["m1"]}).axes
    assert [text.get_text() for text in empty.texts] == ["no curve gets this far"]


def test_panels_show_each_space_where_it_oscillates() -> None:
    whole, lagrange, smooth, smoothest = drawn("panels").axes
    assert len([line for line in whole.lines if line.get_marker() == "None"]) == 9
    assert [line.get_label() for line in lagrange.lines] == ["L1", "L2", "L4"]
    assert [line.get_label() for line in smooth.lines] == ["L1", "N2", "N4", "N6", "N8"]
    assert [line.get_label() for line in smoothest.lines] == ["L4", "N2.1", "N4.1"]
    trace = CURVES["N6"]
    near = (trace.angles_deg > 97.49) & (trace.angles_deg < 101.91)  # 15 % wider each way
    np.testing.assert_array_equal(data(smooth.lines[3]), [trace.angles_deg[near], trace.moments[near]])
    # without the drift of 3.4e-5 its own sawtooth is left, 8e-5 from peak to peak and 1e-5 that of N4.1;
    # steps of a tenth of a period miss its peaks by a fifth at most, and so much the line takes of it
    assert smoothest.get_ylabel() == r"deviation / $10^{-5}\,E_0 L_0^3$"
    for line, amplitude in zip(smoothest.lines, (0.5, 8, 1), strict=True):
        assert np.ptp(data(line)[1]) == pytest.approx(amplitude, rel=0.2)


def test_each_mesh_has_its_line_without_drift() -> None:
    for axes, space in zip(drawn("meshes").axes, ("L4", "N2.1"), strict=True):
        amplitudes = [float(np.ptp(data(line)[1])) for line in axes.lines]
        wanted = [FINENESS[mesh] / FINENESS["m1"] for mesh in MESHES]
        assert np.array(amplitudes) / amplitudes[0] == pytest.approx(wanted, rel=0.2), space  # as above
        assert len({(line.get_linestyle(), line.get_linewidth()) for line in axes.lines}) == 3
    with pytest.raises(InputError, match="m1, m2, m3"):
        meshes_figure({("L4", "m9"): CURVES["L4"]}, WINDOW)


def test_all_amplitudes_of_each_space_over_the_length_of_elements() -> None:
    figure = drawn("convergence")
    assert [axes.get_title("left") for axes in figure.axes] == list(SPACES)
    contact, ours, elevated, theirs = figure.axes[SPACES.index("N4.1")].lines
    lengths = [200 / 160, 200 / 200, 200 / 240]
    for line, value in (
        (ours, ALL["N4.1"]),
        (contact, CONTACT["L1+N4.1"]),
        (elevated, 1.1 * PUBLISHED["N4.1"]),
        (theirs, PUBLISHED["N4.1"]),
    ):
        np.testing.assert_array_equal(data(line)[0], lengths)
        np.testing.assert_allclose(data(line)[1], [1e-3 * value * f for f in FINENESS.values()], rtol=1e-14)
    assert contact.get_markerfacecolor() == "white"
    # at m1 N2 has the contact row alone, and L1 nothing
    _, ours, *_ = figure.axes[SPACES.index("N2")].lines
    np.testing.assert_array_equal(np.isnan(data(ours)[1]), [True, False, False])
    _, ours, *_ = figure.axes[SPACES.index("L1")].lines
    np.testing.assert_array_equal(data(ours)[0], lengths[1:])
    assert {(axes.get_xscale(), axes.get_yscale()) for axes in figure.axes} == {("log", "log")}
    # the row's scale holds all of it
    assert figure.axes[0].get_ylim()[0] < 1e-3 * 0.005 * 0.37


def test_windows_slide_over_the_plateau_beside_the_published_amplitudes() -> None:
    everywhere, contact, strip = drawn("windows").axes
    np.testing.assert_array_equal(data(everywhere.lines[0]), [STARTS, MOVED["L1"]])
    np.testing.assert_array_equal(data(contact.lines[0]), [STARTS, MOVED["L1+L2"]])
    np.testing.assert_array_equal(data(everywhere.lines[-1])[0], [98.0, 98.0])
    assert any("window of 3.4°" in text.get_text() for text in everywhere.figure.texts)
    published = sorted(float(data(line)[1][0]) for line in strip.lines)
    np.testing.assert_array_equal(published, sorted(1e-3 * value for value in PUBLISHED.values()))
    assert strip.get_ylim() == everywhere.get_ylim()
    assert everywhere.get_yscale() == "log"
    (alone,) = windows_figure(STARTS, {"L2": MOVED["L2"]}, WINDOW, {}).axes
    np.testing.assert_array_equal(data(alone.lines[0]), [STARTS, MOVED["L2"]])
    with pytest.raises(InputError, match="44 windows"):
        windows_figure(STARTS, {"L1": np.ones(3)}, WINDOW, {})


def test_the_usual_number_of_points_has_a_ring() -> None:
    everywhere, contact = drawn("quadrature").axes
    line, ring = contact.lines[:2]
    np.testing.assert_array_equal(data(line), [[2, 3, 4], list(POINTS["L1+L2"].values())])
    np.testing.assert_array_equal(data(ring).ravel(), [3, POINTS["L1+L2"][3]])  # quadratic: p + 1
    assert len(everywhere.lines) == 2 * 9
    assert everywhere.get_yscale() == "log"
    with pytest.raises(InputError, match="default"):
        quadrature_figure({"L2": {3: 1e-3}}, {})


def test_costs_of_a_space_are_joined_from_coarse_to_fine() -> None:
    by_dofs, by_seconds = drawn("cost").axes
    assert len(by_dofs.lines) == len(by_seconds.lines) == 23
    runs = [cost for cost in COSTS if cost.space == "L4"]
    np.testing.assert_array_equal(
        data(by_dofs.lines[2]), [[c.dofs for c in runs], [c.amplitude for c in runs]]
    )
    np.testing.assert_array_equal(
        data(by_seconds.lines[2]), [[c.seconds for c in runs], [c.amplitude for c in runs]]
    )
    assert all(b > a for a, b in pairwise(data(by_dofs.lines[2])[0]))
    assert {(axes.get_xscale(), axes.get_yscale()) for axes in (by_dofs, by_seconds)} == {("log", "log")}


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: newton_figure([]), "histories"),
        (lambda: NewtonHistory("L1", 1.0, (), True), "energy_residuals"),
        (lambda: linear_figure({}), "curves"),
        (lambda: panels_figure({}, WINDOW), "curves"),
        (lambda: meshes_figure({}, WINDOW), "curves"),
        (lambda: convergence_figure([Amplitude("L1", "m1", None, None, None, None)]), "entries"),
        (lambda: windows_figure(STARTS, {"L1": np.full(44, np.nan)}, WINDOW, {}), "amplitudes"),
        (lambda: quadrature_figure({"L1": {}}, {"L1": 2}), "amplitudes"),
        (lambda: cost_figure([]), "entries"),
        (lambda: Amplitude("L1", "m2", 0.0, None, None, None), "amplitude: 0.0"),
        (lambda: Amplitude("L1", "m0", None, None, None, None), "mesh: 'm0'"),
        (lambda: Trace(np.zeros(2), np.zeros(3)), "trace"),
        (lambda: Trace(np.zeros(2), np.zeros(2)), "angles must rise"),
    ],
)
def test_what_cannot_be_drawn_is_named(make: Callable[[], object], named: str) -> None:
    with pytest.raises(InputError, match=named):
        make()
