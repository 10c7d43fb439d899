"""Reading of curves whose plateau is known."""

import numpy as np
import pytest

from isopeel import Curve, InputError
from isopeel.common.arrays import FloatArray
from isopeel.post.plateau import onset_angle, plateau_mean, read_plateau, unreadable
from isopeel.problem import RotatedSide

PERIOD = 1.0768


def curve_of(angles: FloatArray, moments: FloatArray) -> Curve:
    columns = RotatedSide("right")
    zeros = np.zeros(len(angles))
    return Curve(
        columns.parameter_column,
        columns.reaction_column,
        angles,
        moments,
        np.ones(len(angles), dtype=np.int64),
        zeros,
        zeros,
        zeros,
        zeros,
        zeros,
        zeros,
        np.zeros(len(angles), dtype=np.int64),
        np.zeros(len(angles), dtype=np.int64),
    )


def sawtooth(angles: FloatArray, size: float) -> FloatArray:
    """Slow rise, then a fall within a tenth of the period, as a coarse mesh makes it."""
    phase = (angles / PERIOD) % 1
    wave: FloatArray = size * np.where(phase < 0.9, phase / 0.9, (1 - phase) / 0.1)
    return wave


@pytest.mark.parametrize("drift", [0.0, 2e-5, -3e-4])
@pytest.mark.parametrize("start", [97.6, 98.0, 98.3])
def test_amplitude_and_slopes_do_not_see_the_drift(drift: float, start: float) -> None:
    angles = np.round(np.arange(0, 110, 0.01), 10)
    moments = 1.63 + drift * (angles - 98) + sawtooth(angles, 1e-4)
    reading = read_plateau(curve_of(angles, moments), (start, start + 3.4), PERIOD)
    assert reading is not None
    # the mean over a period moves by the kinks between samples, 0.01 of a period apart
    assert reading.drift == pytest.approx(drift, abs=1e-7)
    assert reading.amplitude == pytest.approx(1e-4, rel=0.02)  # a peak lies up to half a sample off
    assert reading.steepest_rise == pytest.approx(1e-4 / 0.9 / PERIOD, rel=2e-3)
    assert reading.steepest_fall == pytest.approx(-1e-4 / 0.1 / PERIOD, rel=2e-3)


def test_a_straight_line_through_a_sawtooth_would_be_wrong() -> None:
    """Why the mean over a period is used: a fit to the curve takes part of the oscillation for drift."""
    angles = np.round(np.arange(0, 110, 0.01), 10)
    curve = curve_of(angles, 1.63 + sawtooth(angles, 1e-4))
    fitted, averaged = read_plateau(curve, (98, 101.4)), read_plateau(curve, (98, 101.4), PERIOD)
    assert fitted is not None
    assert averaged is not None
    assert abs(fitted.drift) > 20 * abs(averaged.drift)


def test_mean_is_that_of_the_window() -> None:
    angles = np.arange(0, 121.0)
    reading = read_plateau(curve_of(angles, 1.0 + 0.01 * (angles - 100)), (95, 105))
    assert reading is not None
    assert reading.mean == pytest.approx(1.0, rel=1e-14)  # symmetric about 100
    assert reading.drift == pytest.approx(0.01, rel=1e-12)
    assert reading.amplitude == pytest.approx(0.0, abs=1e-13)


def test_a_run_towards_smaller_parameters_is_read_like_its_mirror_image() -> None:
    angles = np.round(np.arange(0, 110, 0.01), 10)
    moments = 1.63 + 2e-5 * (angles - 98) + sawtooth(angles, 1e-4)
    rising = read_plateau(curve_of(angles, moments), (98.0, 101.4), PERIOD)
    fallen = curve_of(-angles, moments)
    falling = read_plateau(fallen, (-101.4, -98.0), PERIOD)
    assert rising is not None
    assert falling is not None
    # the same numbers, summed from the other end; slopes are of values rounded to 1e-16, 0.01 apart
    assert falling.mean == pytest.approx(rising.mean, rel=1e-14)
    assert falling.mean == plateau_mean(fallen, (-101.4, -98.0))
    assert falling.amplitude == pytest.approx(rising.amplitude, rel=1e-9)
    assert falling.drift == pytest.approx(-rising.drift, abs=1e-13)
    assert falling.steepest_fall == pytest.approx(-rising.steepest_rise, rel=1e-9)
    assert falling.steepest_rise == pytest.approx(-rising.steepest_fall, rel=1e-9)
    assert "the run reached -109.99 degrees" in str(unreadable(fallen, (-111.0, -108.0)))
    assert plateau_mean(fallen, (-111.0, -108.0)) is None


@pytest.mark.parametrize("last", [50.0, 101.3])
def test_a_run_that_ends_too_soon_is_not_read(last: float) -> None:
    angles = np.arange(0, last, 0.1)
    assert read_plateau(curve_of(angles, angles), (98, 101.4)) is None


@pytest.mark.parametrize(
    ("step", "window", "reason"),
    [
        (0.1, (98.0, 98.5), "shorter than a period"),
        (0.2, (98.0, 101.4), "steps of 0.2 degrees are too large"),
        (1.0, (98.0, 101.4), "steps of 1 degree are too large"),
        (2.0, (98.0, 101.4), "has 2 steps"),
        (0.1, (108.0, 111.4), "the run reached 110"),
    ],
)
def test_an_oscillation_that_is_not_resolved_is_not_read(
    step: float, window: tuple[float, float], reason: str
) -> None:
    """One sample per period would show none of it."""
    angles = np.round(np.arange(0, 110 + step / 2, step), 10)
    curve = curve_of(angles, 1.63 + sawtooth(angles, 1e-4))
    assert read_plateau(curve, window, PERIOD) is None
    assert reason in str(unreadable(curve, window, PERIOD))


def test_the_drift_names_what_it_was_fitted_to() -> None:
    angles = np.round(np.arange(0, 101.5, 0.1), 10)
    curve = curve_of(angles, 1.63 + sawtooth(angles, 1e-4))
    early, late = read_plateau(curve, (95, 98.4), PERIOD), read_plateau(curve, (98, 101.4), PERIOD)
    assert early is not None
    assert late is not None
    # the curve ends half a period too soon for the later window
    assert (early.drift_of, late.drift_of) == ("running mean", "curve")


def test_a_window_that_ends_before_it_begins_is_refused() -> None:
    angles = np.arange(0, 10.0)
    with pytest.raises(InputError, match=r"reading\.window"):
        read_plateau(curve_of(angles, angles), (5, 3))


def test_onset_is_a_deviation_of_two_percent() -> None:
    angles = np.linspace(0, 100, 1001)
    stiffness, plateau = 0.03, 1.5
    sharp = curve_of(angles, np.minimum(stiffness * angles, plateau))
    # plateau / angle = 0.98 stiffness; linear interpolation of 1/angle between samples 0.1 apart
    assert onset_angle(sharp) == pytest.approx(plateau / stiffness / 0.98, abs=1e-4)
    assert onset_angle(curve_of(angles, stiffness * angles)) is None
    assert onset_angle(curve_of(angles[:1], np.zeros(1))) is None
