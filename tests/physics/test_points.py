"""A law and a substrate of one's own: their formulas at one point, and all that is made of them."""

import subprocess
import sys
from collections.abc import Callable
from inspect import cleandoc, getsource
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from isopeel import NeoHooke, row_space, trace
from isopeel.assembly.system import System
from isopeel.case.sections import AdhesionSection, SubstrateSection
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Finite, Length, NotNegative, Number, Positive, Stress, SurfaceEnergy
from isopeel.matrix.factorize import factorize
from isopeel.physics.adhesion import NormalLaw, normal_law
from isopeel.physics.batch import evaluate_law, evaluate_substrate
from isopeel.physics.substrates import RigidSubstrate, substrate
from isopeel.problem import Body, Interface, MovedSide, Problem, Support
from isopeel.problem.shapes import Strip


@normal_law
class Polynomial(NormalLaw):
    """T = -27/4 S z (1 - z)^2 of z = opening/reach, linear in compression (Needleman 1987)."""

    strength: Positive[Stress]
    work_of_adhesion: Positive[SurfaceEnergy]
    equilibrium_gap: NotNegative[Length] = 0.0

    def constants(self) -> tuple[float, ...]:
        return self.work_of_adhesion, 27 / 4 * self.strength, 16 / 9 * self.work_of_adhesion / self.strength

    @staticmethod
    def at_point(opening: float, W: float, stress: float, reach: float) -> tuple[float, float, float]:
        z, rest = opening / reach, 1.0 - opening / reach
        if z <= 0.0:
            return 0.5 * stress * opening * z - W, -stress * z, -stress / reach
        if z >= 1.0:
            return 0.0, 0.0, 0.0
        traction, slope = -stress * z * rest**2, -stress / reach * rest * (1.0 - 3.0 * z)
        return -W * rest**3 * (4.0 - 3.0 * rest), traction, slope


@substrate
class Parabola(RigidSubstrate):
    """Solid below y = height - (x - place)^2/(2 radius)."""

    radius: Positive[Length]
    place: Finite[Length] = 0.0
    height: Finite[Length] = 0.0

    @staticmethod
    def graph(x: float, radius: float, place: float, height: float) -> tuple[float, float, float]:
        slope = -(x - place) / radius
        return height + 0.5 * (x - place) * slope, slope, -1.0 / radius


@substrate
class Incline(RigidSubstrate):
    """Half space below a line through the origin, given by its slope."""

    slope: Finite[Number]

    @staticmethod
    def at_point(x: float, y: float, slope: float) -> tuple[float, float, float, float]:
        length = np.hypot(1.0, slope)
        return (y - slope * x) / length, -slope / length, 1.0 / length, 0.0


@normal_law
class Morse(NormalLaw):
    """Phi = W ((1 - exp(-x/d))^2 - 1) over the opening x."""

    work_of_adhesion: Positive[SurfaceEnergy]
    length: Positive[Length]
    equilibrium_gap: NotNegative[Length] = 0.0
    potential = "work_of_adhesion*((1 - exp(-opening/length))**2 - 1)"


@substrate
class Sine(RigidSubstrate):
    """Solid below y = amplitude sin(x/length)."""

    amplitude: Finite[Length]
    length: Positive[Length]
    formula = "amplitude*sin(x/length)"


LAW = Polynomial(0.06, 0.015, 0.25)


def law_at(law: NormalLaw, opening: FloatArray) -> tuple[FloatArray, ...]:
    gap = law.equilibrium_gap + opening
    return evaluate_law(law.kernel, law.parameters, gap, np.zeros_like(gap))


@pytest.mark.parametrize("kind", [Polynomial, Parabola, Incline, Morse, Sine])
def test_each_takes_at_most_25_lines(kind: type[Any]) -> None:
    lines = cleandoc(getsource(kind)).replace(f'    """{kind.__doc__}"""\n', "").splitlines()
    assert len(lines) <= 25


def test_the_law_in_closed_form() -> None:
    reach = 16 / 9 * 0.015 / 0.06
    potential, traction, derivative = law_at(LAW, reach * np.array([-0.1, 0.0, 1 / 3, 1.0, 2.0]))
    # round-off
    np.testing.assert_allclose(potential[1:], [-0.015, -0.015 * 16 / 27, 0, 0], rtol=1e-14, atol=1e-17)
    np.testing.assert_allclose(traction, [0.1 * 6.75 * 0.06, 0, -0.06, 0, 0], rtol=1e-14, atol=1e-16)
    np.testing.assert_allclose(derivative, [-0.405 / reach] * 2 + [0] * 3, rtol=1e-14, atol=1e-15)
    work, error = quad(lambda x: -law_at(LAW, np.array([x]))[1][0], 0.0, reach, epsabs=1e-15)
    assert work == pytest.approx(0.015, abs=10 * error)


@pytest.mark.parametrize("law", [LAW, Morse(0.015, 0.1, 0.25)], ids=["written", "derived"])
def test_traction_and_derivative_by_finite_differences(law: NormalLaw) -> None:
    step, openings = 1e-5, np.linspace(-0.05, 0.42, 50) + 1e-4
    values, ahead, behind = (law_at(law, openings + change) for change in (0.0, step, -step))
    # third derivatives of potential and traction, up to 1e2 and 2e3 for this work and length, by step^2/6
    np.testing.assert_allclose((behind[0] - ahead[0]) / (2 * step), values[1], rtol=0, atol=1e-8)
    np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), values[2], rtol=0, atol=2e-7)


def test_a_derived_law_in_closed_form() -> None:
    z = np.linspace(-0.5, 5.0, 30)
    _, traction, derivative = law_at(Morse(0.015, 0.1, 0.25), 0.1 * z)
    decay = np.exp(-z)
    # round-off of the openings, by the slope of 3 and its own one
    np.testing.assert_allclose(traction, -0.3 * decay * (1 - decay), rtol=0, atol=1e-14)
    np.testing.assert_allclose(derivative, 3.0 * decay * (1 - 2 * decay), rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("kind", "curve"),
    [
        (Parabola(2.0, 0.3, -0.1), lambda x: -0.1 - (x - 0.3) ** 2 / 4),
        (Incline(0.4), lambda x: 0.4 * x),
        (Sine(0.3, 0.5), lambda x: 0.3 * np.sin(x / 0.5)),
    ],
)
def test_substrates_by_a_search_for_the_closest_point(
    kind: RigidSubstrate, curve: Callable[[float], float]
) -> None:
    places = np.random.default_rng(4).uniform((-1.0, 0.3), (1.0, 0.6), (20, 2))
    gap, normal, _ = evaluate_substrate(kind.kernel, kind.parameters, places)
    for (x, y), found, n in zip(places, gap, normal, strict=True):
        grid = np.linspace(x - 1.0, x + 1.0, 401)
        start = grid[np.argmin((grid - x) ** 2 + (np.array([curve(s) for s in grid]) - y) ** 2)]
        nearest = minimize_scalar(
            lambda s: np.hypot(s - x, curve(s) - y),  # noqa: B023
            bounds=(start - 0.005, start + 0.005),
            method="bounded",
            options={"xatol": 1e-10},
        )
        # a distance is flat where it is smallest: found to the square of the place's error
        assert found == pytest.approx(np.copysign(nearest.fun, y - curve(x)), abs=1e-14)
        np.testing.assert_allclose(found * n, [x - nearest.x, y - curve(nearest.x)], rtol=0, atol=1e-6)


def test_curvature_of_a_graph_in_closed_form() -> None:
    parabola = Parabola(2.0, 0.3, -0.1)
    _, normal, curvature = evaluate_substrate(
        parabola.kernel, parabola.parameters, np.array([[0.3, 1.0], [-0.4, 1.0]])
    )
    # 1/R at the top; k = cos(slope)^3/R, where n_y is the cosine
    assert curvature[0] == 0.5
    assert curvature[1] == pytest.approx(0.5 * normal[1, 1] ** 3, rel=1e-14)


BODY = Body(Strip(20.0, 4.0).surface(), NeoHooke(1.0, 0.2))
PEELED = Problem(
    "own",
    (BODY,),
    (Interface(BODY.side("bottom", end=0.7), law=LAW, against=Parabola(2000.0).receded(0.25)),),
    (Support(BODY.side("left"), (0,)),),
    MovedSide("right", np.pi / 2),
)
SPACE = row_space("N2", (20, 2))


def test_a_strip_is_peeled_with_both() -> None:
    before, last, after = list(trace(PEELED, SPACE, np.array([0.0, 0.2, 0.4, 0.6, 0.79, 0.8, 0.81])))[-3:]
    energy = [step.stored_energy + step.adhesive_energy for step in (before, after)]
    # a central difference of step 0.01 leaves 2e-5 of the third derivative of an energy
    assert last.reaction == pytest.approx((energy[1] - energy[0]) / 0.02, rel=1e-4)


def test_tangent_with_both_is_the_derivative_of_the_residual() -> None:
    system = System(PEELED, SPACE)
    y, direction = 0.02 * np.random.default_rng(3).standard_normal((2, system.count))

    def residual(values: FloatArray) -> FloatArray:
        return system.equilibrium(system.state(values, 0.01)[0]).residual

    change = (residual(y + 1e-5 * direction) - residual(y - 1e-5 * direction)) / 2e-5
    factor = factorize(system.linearize(system.state(y, 0.01)[0], "general")[1])
    # central differences of step 1e-5 leave 1e-10 of the third derivative, which the solution enlarges
    np.testing.assert_allclose(factor.solve(change), direction, rtol=0, atol=1e-6 * np.abs(direction).max())


def test_cases_have_their_fields_as_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("isopeel.case.kinds.discover", lambda _: {k.name: k for k in (Polynomial, Parabola)})
    written = {"law": "polynomial", "strength": "120 MPa", "work_of_adhesion": "30 mJ/m^2"}
    # in 2 GPa and 1 nm
    assert AdhesionSection.model_validate(written).made() == Polynomial(0.06, 0.015)
    with pytest.raises(InputError, match=r"substrate\.radius: 0\.0 cannot be used; it must be positive"):
        SubstrateSection.model_validate({"kind": "parabola", "radius": "0 nm"}).made()


def test_another_number_of_constants_is_an_error() -> None:
    class Wrong(Polynomial):
        def constants(self) -> tuple[float, ...]:
            return (1.0,)

    allowed = r"Polynomial\.at_point is given 1 constants; its constants are W, stress, reach"
    with pytest.raises(TypeError, match=allowed):
        Wrong(0.06, 0.015).kernel  # noqa: B018


def test_a_law_says_what_it_lacks() -> None:
    with pytest.raises(TypeError, match="Gapless needs equilibrium_gap"):

        @normal_law
        class Gapless(NormalLaw):
            work_of_adhesion: SurfaceEnergy
            potential = "work_of_adhesion*gap"

    with pytest.raises(TypeError, match="Nothing needs at_point or graph or formula"):

        @substrate
        class Nothing(RigidSubstrate):
            height: Length


def scaled(factor: float) -> NormalLaw:
    @normal_law
    class Spring(NormalLaw):
        equilibrium_gap: Length = 0.0
        work_of_adhesion = 1.0

        @staticmethod
        def at_point(gap: float) -> tuple[float, float, float]:
            return 0.5 * factor * gap**2, -factor * gap, -factor

    return Spring()


def test_formulas_that_depend_on_variables_of_a_function_are_not_cached() -> None:
    for factor in (1.0, 2.0):
        # a cached kernel would not know the factor
        assert law_at(scaled(factor), np.array([3.0]))[1][0] == -3.0 * factor


PLUG_IN = """
from isopeel.common.quantities import Length, NotNegative
from isopeel.physics.adhesion import NormalLaw, normal_law

@normal_law
class Spring(NormalLaw):
    equilibrium_gap: NotNegative[Length] = 0.0
    work_of_adhesion = 1.0

    @staticmethod
    def at_point(gap):
        return 0.5 * {0} * gap**2, -{0} * gap, -{0}
"""
RUN = """
import numpy as np
from isopeel.physics.batch import evaluate_law
from spring import Spring
law = Spring()
print(law.kernel.cache_hits, evaluate_law(law.kernel, law.parameters, np.ones(1), np.zeros(1))[1][0])
"""


def test_a_kernel_is_cached_until_the_formulas_change(tmp_path: Path) -> None:
    def run(factor: float) -> str:
        file = tmp_path / "spring.py"
        if not file.exists() or f"-{factor} * gap" not in file.read_text():
            file.write_text(PLUG_IN.format(factor))
        script = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{RUN}"
        return subprocess.run(
            [sys.executable, "-c", script], check=True, capture_output=True, text=True
        ).stdout

    assert [run(2.0), run(2.0), run(31.0)] == ["0 -2.0\n", "1 -2.0\n", "0 -31.0\n"]
