"""Figures: they show the given values, and their files have the stated size."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import TriMesh
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

import isopeel
from isopeel import Curve, InputError, Problem, RowSpace, Step
from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.units import UnitSystem
from isopeel.physics.adhesion import Exponential
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.post.closed_form import expected
from isopeel.post.fields import sample_fields
from isopeel.post.figures import reaction_figure, save, shapes_figure, space_figure
from isopeel.post.laboratory import Laboratory
from isopeel.post.plateau import PlateauReading
from isopeel.problem import Column
from isopeel.results.fields import StoredState

ANGLES = np.arange(0.0, 31.0, 7.5)


@pytest.fixture(scope="module")
def run() -> tuple[Problem, RowSpace, list[Step]]:
    problem, space = isopeel.strip(), isopeel.row_space("N2", (20, 2))
    return problem, space, list(isopeel.trace(problem, space, np.radians(ANGLES)))


@pytest.fixture
def long_curve() -> Curve:
    """A moment that rises to its plateau at 60 degrees and oscillates there by 0.004 peak to peak."""
    angle = np.linspace(0, 120, 1201)
    moment = np.where(angle < 60, angle * 1.63 / 60, 1.63 + 0.002 * np.sin(angle - 60))
    zeros = frozen(np.zeros(1201))
    return Curve(
        Column("theta_deg", "degree"),
        Column("moment", "E0 L0^3"),
        frozen(angle),
        frozen(moment),
        np.zeros(1201, dtype=np.int64),
        zeros,
        zeros,
        zeros,
        zeros,
        zeros,
        zeros,
        np.zeros(1201, dtype=np.int64),
        np.zeros(1201, dtype=np.int64),
    )


def pixels(path: Path) -> FloatArray:
    with Image.open(path) as image:
        return np.asarray(image, dtype=np.float64)


def data(line: Line2D) -> tuple[FloatArray, FloatArray]:
    x, y = np.asarray(line.get_xydata(), dtype=np.float64).T
    return x, y


def texts(figure: Figure) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def test_a_short_run_has_one_panel_with_its_curve(run: tuple[Problem, RowSpace, list[Step]]) -> None:
    problem, space, steps = run
    curve = Curve.of(steps, problem.drive)
    figure = reaction_figure(curve, None, expected(problem, space))
    (axes,) = figure.axes
    (line,) = axes.lines  # the closed form is valid from its onset on, at 53.8 degrees
    np.testing.assert_array_equal(data(line), [curve.parameter, curve.reaction])
    assert axes.get_xlabel() == "rotation of the driven face / degree"
    assert axes.get_ylabel() == "moment $M$ / $E_0 L_0^3$"
    assert axes.get_xlim() == (0.0, 30.0)


def test_a_single_step_can_be_drawn(run: tuple[Problem, RowSpace, list[Step]], tmp_path: Path) -> None:
    problem, space, steps = run
    save(reaction_figure(Curve.of(steps[:1], problem.drive)), tmp_path / "moment.png")
    save(shapes_figure(problem, space, [StoredState.of(steps[0], problem.drive)]), tmp_path / "shapes.png")
    assert pixels(tmp_path / "moment.png").shape[:2] == (520, 700)  # 2.6 x 3.5 inches at 200 dpi


def test_the_closed_form_and_the_plateau_are_drawn_and_named(long_curve: Curve) -> None:
    plateau = PlateauReading((90.0, 110.0), 1.63, 1e-4, "running mean", 0.004, 0.002, -0.002)
    figure = reaction_figure(long_curve, plateau, expected(isopeel.strip(), isopeel.row_space("L1", (20, 2))))
    whole, enlarged = figure.axes
    _, level, onset = whole.lines
    np.testing.assert_allclose(data(level)[1], 1.6315, atol=5e-5)  # the published digits
    np.testing.assert_allclose(data(onset)[0], 53.8, atol=0.05)
    angle, deviation = data(enlarged.lines[-1])
    inside = (long_curve.parameter >= 87) & (long_curve.parameter <= 113)  # 15 % wider each way
    np.testing.assert_array_equal(angle, long_curve.parameter[inside])
    # drawn in thousandths; 1e-12 is round-off of the difference, a thousandfold
    np.testing.assert_allclose(deviation, 1e3 * (long_curve.reaction[inside] - 1.63), rtol=0, atol=1e-12)
    # 1e-4 per degree over 20 degrees, in thousandths
    np.testing.assert_allclose(data(enlarged.lines[0]), [[90, 110], [-1, 1]], rtol=1e-12)
    assert enlarged.get_xlim() == (87.0, 113.0)
    assert "$10^{-3}$" in enlarged.get_ylabel()
    assert texts(figure) == [
        "beam theory 1.6315",
        "onset 53.8°",
        "mean 1.63, amplitude $4.00\\times 10^{-3}$\n"
        "slopes $2.00\\times 10^{-3}$, $-2.00\\times 10^{-3}$ per degree\n"
        "subtracted drift $1.00\\times 10^{-4}$ per degree",
    ]


def test_shapes_share_one_scale_and_hold_the_body(
    run: tuple[Problem, RowSpace, list[Step]], tmp_path: Path
) -> None:
    problem, space, steps = run
    states = [StoredState.of(step, problem.drive) for step in steps]
    figure = shapes_figure(problem, space, states)
    upper, lower, bar = figure.axes
    meshes = [mesh for axes in (upper, lower) for mesh in axes.collections if isinstance(mesh, TriMesh)]
    # 7.5 degrees lift the end by 50 sin(7.5)/2 = 3 nm, too little to be distinguished from the next shape: 3
    # % of 200
    assert texts(figure) == ["0°", "15°", "30°"]
    assert len(meshes) == 4
    # as many cells per element as the figure takes, so that it meets the same extreme values
    largest = max(
        np.abs(sample_fields(problem, space, one.displacement, (15, 8)).first_invariant).max()
        for one in states
    )
    assert {mesh.get_clim() for mesh in meshes} == {(-largest, largest)}
    last = sample_fields(problem, space, states[-1].displacement).position.reshape(-1, 2)
    assert upper.get_xlim()[0] < last[:, 0].min() < last[:, 0].max() < upper.get_xlim()[1]
    assert upper.get_ylim()[0] < last[:, 1].min() < last[:, 1].max() < upper.get_ylim()[1]
    assert [axes.get_aspect() for axes in (upper, lower)] == [1.0, 1.0]
    assert bar.get_ylabel() == r"$I_1 = \mathrm{tr}\,\sigma / E$"
    save(figure, tmp_path / "shapes.png")
    height, width, _ = pixels(tmp_path / "shapes.png").shape
    assert (width, height) == (1440, int(200 * figure.get_figheight()))  # 7.2 inches at 200 dpi


def test_the_last_shape_is_the_last_of_the_run_where_parameters_fall() -> None:
    problem, space = isopeel.strip(), isopeel.row_space("L1", (40, 2))
    # ramps of up to 40 high
    ramp = np.zeros((space.size, 2))
    ramp[:, 1] = np.maximum(200 * space.greville[:, 0] - 100, 0) / 100
    figure = shapes_figure(problem, space, [StoredState(at, float(-at), at * ramp) for at in range(41)])
    assert texts(figure) == ["0°", "-8°", "-16°", "-24°", "-32°", "-40°"]
    assert figure.axes[1].get_title("left") == "front at -40°"


def test_the_legend_names_a_mirror_and_the_units(run: tuple[Problem, RowSpace, list[Step]]) -> None:
    problem, space, steps = run
    adhesion = replace(problem.adhesion, law=Mirrored(Exponential(0.06, 0.015, 0.25)))
    mirrored = problem.changed(adhesion=adhesion)
    units = Laboratory(UnitSystem(Fraction(1, 1000), Fraction(10**9)), 200.0)
    rest = [StoredState.of(steps[0], problem.drive)]
    for one, name in ((problem, "substrate"), (mirrored, "mirror plane")):
        figure = shapes_figure(one, space, rest, units=units)
        (legend,) = figure.legends
        assert [text.get_text() for text in legend.get_texts()] == [
            "face that adheres",
            name,
            "enlarged below",
        ]
        assert [axes.get_xlabel() for axes in figure.axes[:2]] == ["$x$ / mm"] * 2
        assert shapes_figure(one, space, rest).axes[0].get_xlabel() == "$x$ / $L_0$"


def test_the_front_is_enlarged_where_the_pull_is_strongest() -> None:
    problem, space = isopeel.strip(), isopeel.row_space("L1", (40, 2))
    displacement = np.zeros((space.size, 2))
    places = 200 * space.greville[:, 0]
    displacement[:, 1] = np.maximum(places - 100, 0) / 10  # a ramp of slope 1/10 from x = 100
    figure = shapes_figure(problem, space, [StoredState(1, 1.0, displacement)])
    lower = figure.axes[1]
    # at the gap 0.3059, where the lift is 0.0512, at x = 100.5; points are 0.375 apart
    assert np.mean(lower.get_xlim()) == pytest.approx(100.5, abs=0.4)


def test_each_kind_of_row_has_a_panel() -> None:
    contact, rest, across = space_figure(isopeel.row_space("L1+N2.1", (40, 4))).axes
    assert contact.get_title("left") == r"$N_i(\xi)$, contact row: degree 3, $C^1$"
    assert rest.get_title("left") == r"$N_i(\xi)$, rows 2 to 5: degree 1, $C^0$"
    assert across.get_title("left") == r"$M_j(\eta)$, across the rows: degree 1, $C^0$"
    # on six elements 2 (6 - 1) + 4 = 14 cubics, and 7 hat functions; one more line holds the knots
    assert [len(axes.lines) for axes in (contact, rest, across)] == [15, 8, 6]
    assert contact.get_xlim() == (0.0, 0.15)
    ends = [data(line) for line in rest.lines[:-1]]
    assert [x[-1] for x, y in ends if y[-1] == 1] == [0.15]  # one hat stands on the last knot shown


def test_the_users_settings_neither_matter_nor_change(long_curve: Curve, tmp_path: Path) -> None:
    save(reaction_figure(long_curve), tmp_path / "ours.png")
    with mpl.rc_context({"font.size": 30, "lines.linewidth": 9, "savefig.dpi": 17}):
        save(reaction_figure(long_curve), tmp_path / "theirs.png")
        assert mpl.rcParams["font.size"] == 30
    np.testing.assert_array_equal(pixels(tmp_path / "ours.png"), pixels(tmp_path / "theirs.png"))


def test_bad_input_is_named(run: tuple[Problem, RowSpace, list[Step]], tmp_path: Path) -> None:
    problem, space, _ = run
    with pytest.raises(InputError, match="one state at least"):
        shapes_figure(problem, space, [])
    with pytest.raises(InputError, match=r"\.png, \.pdf, \.svg"):
        save(Figure(), tmp_path / "figure.docx")
