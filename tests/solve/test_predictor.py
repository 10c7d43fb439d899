"""Extrapolation of a path: polynomials, and translation of the states one element before."""

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.problem import strip
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.polynomials import slope
from isopeel.solve.predictor import Predictor
from isopeel.solve.predictor_selection import select_predictor
from isopeel.solve.step import AcceptedState
from isopeel.solve.trace import trace
from isopeel.solve.translation_predictor import TranslationPredictor
from isopeel.splines.rows import row_space


def _extrapolated(parameters: np.ndarray, energies: np.ndarray, values: np.ndarray, target: float) -> float:
    nothing = np.full(len(values), np.nan)  # is translated
    samples = np.stack([values, nothing], axis=1)[..., None]
    weights, _ = select_predictor(parameters, nothing, energies, samples, target)
    assert not weights[1].any()
    return float(weights[0] @ values)


def test_the_polynomial_with_the_smallest_errors_is_selected() -> None:
    x = np.arange(12.0)
    none = np.zeros(12)  # an energy that does not change is no path measure
    assert _extrapolated(x, none, x**2 + 1, 12.0) == pytest.approx(145, rel=1e-12)
    assert _extrapolated(x[:1], none[:1], x[:1] + 7, 1.0) == 7
    # a cubic, as far as its states go: one more is tried
    assert _extrapolated(x[:3], none[:3], x[:3] ** 3, 3.0) == pytest.approx(21, rel=1e-12)
    assert _extrapolated(x, none, np.where(x < 10, 0.0, 1.0), 12.0) == 1


def test_the_adhesive_energy_is_selected_where_the_parameter_hesitates() -> None:
    # near the limit point of p = s - s^2/2 at s = 1: the state's slope by p grows without end
    parameters = 0.49 + 0.0009 * np.arange(11)
    measure = 1 - np.sqrt(1 - 2 * parameters)
    target = parameters[-1] + 0.0009
    exact = 1 - np.sqrt(1 - 2 * target)
    cubed = _extrapolated(parameters, 5 * measure - 3, measure**3, target)
    assert cubed == pytest.approx(exact**3, rel=1e-9)  # 11 digits of the states, less what weights cost
    # without a measure but the parameter, a hundredth of the last step is missed at least
    blind = _extrapolated(parameters, np.zeros(11), measure**3, target)
    assert abs(blind - exact**3) > 0.01 * (measure[-1] ** 3 - measure[-2] ** 3)
    # beyond the limit point there is no state; one is returned all the same
    assert np.isfinite(_extrapolated(parameters, 5 * measure - 3, measure**3, 0.52))


def test_slope_is_that_of_the_polynomial() -> None:
    p = np.array([0.0, 0.3, 0.4, 0.55, 0.6])
    assert slope(p, p, p**4 - p) == pytest.approx(4 * 0.6**3 - 1, rel=1e-12)
    assert slope(p[:1], p[:1], np.ones(1)) == 0.0
    # since the drive has turned: a joint that was torn before follows another law
    turned, values = np.array([0.1, 0.5, 0.7, 0.6, 0.4]), np.array([0.1, 0.5, 0.7, 0.36, 0.16])
    expected = np.polyval(np.polyder(np.polyfit(turned[2:], values[2:], 2)), 0.4)
    assert slope(turned, turned, values) == pytest.approx(expected, rel=1e-12)


def test_slope_follows_the_adhesive_energy_past_a_limit_point() -> None:
    s = np.array([0.1, 0.3, 0.4, 0.45, 0.6])
    p = s - s**2  # turns at s = 0.5
    assert slope(3 * s - 1, p, s**3) == pytest.approx(3 * 0.6**2 / (1 - 2 * 0.6), rel=1e-12)
    s[-1] = 0.52  # the last step crosses the limit point: forwards, while the slope is backwards
    assert slope(3 * s - 1, s - s**2, s**3) == 0.0


def _periodic(measure: np.ndarray, hesitation: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """Parameter and state of a path that repeats itself after 2.3, but for what changes slowly."""
    phase = 2 * np.pi * measure / 2.3
    parameter = measure + hesitation * np.sin(phase) + 0.01 * measure**2
    state = np.stack([np.cos(phase) + np.sin(2 * phase), np.sin(phase + 1) + 0.01 * measure], axis=1)
    return parameter, state


def _measure(parameters: np.ndarray, hesitation: float = 0.1) -> np.ndarray:
    """The path measure at which a periodic path has some values of the parameter."""
    fine = np.linspace(0, 20, 200001)
    measure: np.ndarray = np.interp(parameters, _periodic(fine, hesitation)[0], fine)
    for _ in range(3):  # Newton's method for p(s) = parameter
        rate = (_periodic(measure + 1e-6, hesitation)[0] - _periodic(measure - 1e-6, hesitation)[0]) / 2e-6
        measure -= (_periodic(measure, hesitation)[0] - parameters) / rate
    return measure


def test_translation_extrapolates_where_polynomials_cannot() -> None:
    parameters = np.arange(0.5, 8.0, 0.2)
    measure = _measure(parameters)
    values = _periodic(measure)[1]
    earlier = slice(0, -1)
    known, samples = parameters[earlier], np.stack([values, values], axis=1)[earlier]
    weights, by_energy = select_predictor(known, known, 3 * measure[earlier] - 1, samples, parameters[-1])
    assert by_energy
    assert weights[1].any()
    missed = np.abs(weights[0] @ values[earlier] + weights[1] @ values[earlier] - values[-1]).max()
    samples[:, 1] = np.nan
    alone, _ = select_predictor(known, known, 3 * measure[earlier] - 1, samples, parameters[-1])
    assert not alone[1].any()
    # states around a place, of eleven in a period, against those before it
    assert missed < 0.3 * np.abs(alone[0] @ values[earlier] - values[-1]).max()


def test_stored_data_of_states_equal_those_computed_anew() -> None:
    """Beyond the number of stored states, with a turn back onto a known parameter, and a jump."""
    system = System(strip(), row_space("N2", (12, 2)))
    stored = Predictor(system)
    parameters = [*np.linspace(0.0, 2.0, 120), *np.linspace(1.97, 1.5, 20)]
    shape = np.random.default_rng(0).standard_normal((2, system.count))
    for k, parameter in enumerate(parameters):
        y = 0.1 * (np.sin(parameter) * shape[0] + np.cos(2 * parameter) * shape[1])
        if k == 130:
            stored.clear()
        stored.add(AcceptedState(parameter, y, 0.0, 0.0, parameter**2 - 1), system.state(y, parameter)[0])
        fresh = Predictor(system)
        for state in stored.states:
            fresh.add(state, system.state(state.unknown_values, state.parameter)[0])
        ahead = parameter + (0.02 if k < 119 else -0.02)
        np.testing.assert_array_equal(stored.guess(ahead), fresh.guess(ahead))


def test_translation_is_not_used_across_a_possible_jump() -> None:
    # once a period the parameter nearly halts: there the path measure grows four times as fast as usual
    parameters = np.arange(0.5, 12.0, 0.2)
    measure = _measure(parameters, 0.28)
    values = _periodic(measure, 0.28)[1]
    steep: list[bool] = []
    calm: list[bool] = []
    for n in range(36, len(measure)):
        earlier = slice(n - 36, n)
        known, samples = parameters[earlier], np.stack([values, values], axis=1)[earlier]
        weights, _ = select_predictor(known, known, measure[earlier], samples, parameters[n])
        steps = np.diff(measure[n - 4 : n + 1])
        (steep if steps[-1] > 2.6 * steps[:-1].min() else calm).append(bool(weights[1].any()))
    assert len(steep) > 1
    assert not any(steep)
    assert any(calm)


@pytest.mark.parametrize("name", ["L1", "L2", "N3", "N2.1"])
def test_what_is_linear_is_translated_by_one_element(name: str) -> None:
    system = System(strip(), row_space(name, (40, 2)))
    translation = TranslationPredictor.of(system)
    assert translation is not None
    gradient, element = np.array([[0.1, -0.7], [0.9, 0.2]]), np.array([5.0, 0.0])
    unknowns = system.constraints.unknowns
    own = (unknowns >= 0) & (translation.followers[unknowns] == 1)
    field = np.where(own, translation.points @ gradient.T, 0.0)
    change = np.zeros(system.count)
    change[unknowns[own]] = field[own]
    translated = translation.change(change, np.zeros_like(field))
    expected = (translation.points + element) @ gradient.T
    # where all functions are alike: off the ends by the functions of a degree, and off what is held
    inside = np.abs(system.space.greville[:, 0] - 0.5) < 0.3
    np.testing.assert_allclose(translated[unknowns[inside]], expected[inside], rtol=0, atol=1e-12 * 200)


def test_near_the_driven_side_the_body_is_translated_as_a_rigid_one() -> None:
    system = System(strip(), row_space("N2", (100, 4)))
    translation = TranslationPredictor.of(system)
    assert translation is not None
    curvature, element = 0.01, 2.0
    x, y = translation.points.T

    def bent(angle: np.ndarray, height: np.ndarray) -> np.ndarray:
        radius = 1 / curvature - height
        return np.stack([radius * np.sin(angle), 1 / curvature - radius * np.cos(angle)], axis=1)

    displacement = bent(curvature * x, y) - translation.points
    angle = curvature * 200.0
    ahead = translation.parameter(angle, displacement)
    # control points of a circle's spline lie off it by some (curvature x element)^2
    assert ahead - angle == pytest.approx(curvature * element, rel=1e-3)


def test_a_single_element_has_no_next_one() -> None:
    assert TranslationPredictor.of(System(strip(), row_space("L1", (1, 1)))) is None


@pytest.mark.chord_tangent
def test_the_front_of_a_finer_mesh_needs_few_corrections(monkeypatch: pytest.MonkeyPatch) -> None:
    angles = np.radians(np.concatenate([np.arange(0, 76, 1.0), np.arange(76, 82.05, 0.1)]))
    corrections, moments = [], []
    for blind in (False, True):
        if blind:
            monkeypatch.setattr(TranslationPredictor, "of", lambda _: None)
        steps = [*trace(strip(), row_space("N2.1", (100, 5)), angles, NewtonSettings(path_control="auto"))]
        last = [step for step in steps if step.kind == "requested"][-20:]
        corrections.append(np.mean([len(step.iterations) for step in last]))
        moments.append([step.reaction for step in last])
    assert corrections[0] < 0.75 * corrections[1]
    np.testing.assert_allclose(moments[0], moments[1], rtol=1e-8)
