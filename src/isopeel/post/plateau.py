"""Read a reaction curve: its plateau, oscillation, steepest slopes and onset."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.results.curve import Curve

#: Relative difference of the reaction from its initial straight line at the onset.
ONSET_DEVIATION = 0.02
#: Steps per period that an oscillation needs: of eight, one is within 8 % of a sine's peak.
STEPS_PER_PERIOD = 8
# an angle of the window and one of the curve are the same when they differ by round-off only
_SAME = 1e-9


@dataclass(frozen=True)
class PlateauReading:
    """The numbers of a plateau in a window, in the units of the curve; slopes per unit of its parameter.

    The oscillation comes from the mesh: one period is the passage of one element. Amplitude and slopes are
    those of the curve minus the drift of the plateau, as the drift across a window can be larger than the
    oscillation. The drift is a parabola fitted to the running mean, or a line fitted to the curve.
    """

    window: tuple[float, float]
    mean: float
    drift: float  # mean slope of the subtracted drift
    drift_of: Literal["running mean", "curve"]  # to which the drift was fitted
    amplitude: float  # peak to peak
    steepest_rise: float  # largest one-sided difference quotient from step to step
    steepest_fall: float  # most negative one

    def __post_init__(self) -> None:
        """Check the window."""
        check_window(self.window)


def check_window(window: tuple[float, float]) -> None:
    """Raise InputError unless the window begins before it ends."""
    if not window[0] < window[1]:
        raise InputError("reading.window", window, "it must begin before it ends")


def unreadable(
    curve: Curve,
    window: tuple[float, float],
    period: float | None = None,
    shown: Callable[[float], str] | None = None,
) -> str | None:
    """Return why a window of a curve cannot be read, or None where it can.

    The curve must cover the window; with the `period` of the oscillation known, the window must hold one
    period, in at least STEPS_PER_PERIOD steps. A parameter is written by `shown`, by default with its unit.
    """
    check_window(window)
    start, end = window
    parameter, _ = rising(curve)
    inside = parameter[_inside(parameter, window)]
    write = shown or curve.parameter_column.text
    ends = f"{write(start)} to {write(end)}"
    if not _covers(parameter, window):
        reached = (
            f"the run reached {write(float(curve.parameter[-1]))}" if len(curve) else "no step converged"
        )
        return f"the window is {ends}, but {reached}"
    if len(inside) < 4:
        return f"the window of {ends} has {len(inside)} steps, and 4 are needed"
    if period is not None:
        step = float(np.diff(inside).max())
        if end - start < period:
            return f"the window is shorter than a period of the oscillation, {write(float(f'{period:.3g}'))}"
        if step > period / STEPS_PER_PERIOD:
            largest, passes = (float(f"{value:.3g}") for value in (period / STEPS_PER_PERIOD, period))
            return (
                f"steps of {write(step)} are too large for a period of {write(passes)}; they must be at most"
                f" {write(largest)}"
            )
    return None


def plateau_mean(curve: Curve, window: tuple[float, float]) -> float | None:
    """Return the mean reaction in a window of the parameter; None where the curve does not cover it."""
    inside = in_window(curve, window)
    return None if inside is None else float(curve.reaction[inside].mean())


def in_window(curve: Curve, window: tuple[float, float]) -> IntArray | None:
    """Return the steps (n,) in a window, in the order of `rising`; None where it is not covered."""
    steps = _rising_steps(curve)
    parameter = curve.parameter[steps]
    return steps[_inside(parameter, window)] if _covers(parameter, window) else None


def rising(curve: Curve) -> tuple[FloatArray, FloatArray]:
    """Return parameter and reaction (steps,) with rising parameter; a falling curve is reversed.

    Of a curve that turns back, only the steps beyond all earlier ones are returned.
    """
    steps = _rising_steps(curve)
    return curve.parameter[steps], curve.reaction[steps]


def _rising_steps(curve: Curve) -> IntArray:
    falls = len(curve) > 0 and curve.parameter[-1] < curve.parameter[0]
    forward = -curve.parameter if falls else curve.parameter
    if not len(curve):
        return np.zeros(0, dtype=np.int64)
    (beyond,) = np.nonzero(forward > np.append(-np.inf, np.maximum.accumulate(forward)[:-1]))
    return beyond[::-1] if falls else beyond


def _covers(parameter: FloatArray, window: tuple[float, float]) -> bool:
    start, end = window
    return bool(len(parameter) and parameter[0] <= start + _SAME and parameter[-1] >= end - _SAME)


def _inside(parameter: FloatArray, window: tuple[float, float]) -> NDArray[np.bool_]:
    start, end = window
    inside: NDArray[np.bool_] = (parameter >= start - _SAME) & (parameter <= end + _SAME)
    return inside


def read_plateau(
    curve: Curve, window: tuple[float, float], period: float | None = None
) -> PlateauReading | None:
    """Return the plateau in a window of the parameter; None where it is `unreadable`.

    The drift is a parabola fitted to the mean of the curve over one `period` of the oscillation around each
    step, which the oscillation does not change. Without a period, or where the curve ends too early, the
    drift is a line fitted to the curve.
    """
    if unreadable(curve, window, period) is not None:
        return None
    parameter, reaction = rising(curve)
    mean = None if period is None else running_mean(parameter, reaction, period)
    return read_window(parameter, reaction, window, mean)


def read_window(
    parameter: FloatArray, reaction: FloatArray, window: tuple[float, float], mean: FloatArray | None = None
) -> PlateauReading:
    """Return the same for arrays (steps,), which must cover the window with at least four steps in it.

    The drift is fitted to `mean` (steps,) where that is known in the whole window.
    """
    at, values, drift, taken_out, fitted = _without_drift(parameter, reaction, window, mean)
    oscillation = values - taken_out
    slopes = np.diff(oscillation) / np.diff(at)
    return PlateauReading(
        window=window,
        mean=float(values.mean()),
        drift=drift,
        drift_of=fitted,
        amplitude=float(np.ptp(oscillation)),
        steepest_rise=float(slopes.max()),
        steepest_fall=float(slopes.min()),
    )


class Oscillation(NamedTuple):
    """The steps (steps,) of a window: the reaction minus its mean there, and the drift."""

    parameter: FloatArray
    deviation: FloatArray
    drift: FloatArray

    @property
    def values(self) -> FloatArray:
        """The oscillation, from which amplitude and slopes are read."""
        return self.deviation - self.drift


def oscillation(curve: Curve, plateau: PlateauReading, period: float | None = None) -> Oscillation:
    """Return the oscillation that a plateau was read from, with the same `period`."""
    parameter, reaction = rising(curve)
    mean = None if period is None else running_mean(parameter, reaction, period)
    at, values, _, taken_out, _ = _without_drift(parameter, reaction, plateau.window, mean)
    return Oscillation(at, values - values.mean(), taken_out)


def _without_drift(
    parameter: FloatArray, reaction: FloatArray, window: tuple[float, float], mean: FloatArray | None
) -> tuple[FloatArray, FloatArray, float, FloatArray, Literal["running mean", "curve"]]:
    """Return parameter and reaction in a window, mean slope and values of the drift, and its source."""
    inside = _inside(parameter, window)
    at, values = parameter[inside], reaction[inside]
    if mean is not None and np.isnan(mean[inside]).any():
        mean = None
    line = at - at.mean()
    drift, taken_out = _along(line, values if mean is None else mean[inside])
    if mean is not None:
        # the curvature of the drift: a parabola, orthogonal to the line; the running mean itself is noisy
        bend = line**2 - np.mean(line**2)
        bend -= _along(line, bend)[1]
        taken_out = taken_out + _along(bend, mean[inside])[1]
    return at, values, float(drift), taken_out, "curve" if mean is None else "running mean"


def _along(direction: FloatArray, values: FloatArray) -> tuple[float, FloatArray]:
    """Return the part of values along a direction without mean: least squares of one unknown, and the fit."""
    share = float(direction @ values / (direction @ direction))
    return share, share * direction


def running_mean(parameter: FloatArray, reaction: FloatArray, period: float) -> FloatArray:
    """Return the mean (steps,) of a curve over one period around each step; nan next to its ends."""
    from scipy.interpolate import CubicSpline

    known = (parameter - period / 2 >= parameter[0]) & (parameter + period / 2 <= parameter[-1])
    integral = CubicSpline(parameter, reaction).antiderivative()
    at = parameter[known]
    mean = np.full(len(parameter), np.nan)
    mean[known] = (integral(at + period / 2) - integral(at - period / 2)) / period
    return mean


def onset_angle(curve: Curve) -> float | None:
    """Return the parameter at which the curve is 2 % below its initial straight line; None where it is not.

    By linear interpolation. The line passes through the origin and the first step after it.
    """
    later = curve.parameter > 0
    parameter, reaction = curve.parameter[later], curve.reaction[later]
    if not len(parameter):
        return None
    deviation = 1 - reaction / parameter / (reaction[0] / parameter[0])
    beyond = np.flatnonzero(deviation > ONSET_DEVIATION)
    if not len(beyond):
        return None
    k = beyond[0]
    return float(np.interp(ONSET_DEVIATION, deviation[k - 1 : k + 1], parameter[k - 1 : k + 1]))
