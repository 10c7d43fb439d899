"""Reading a reaction curve: plateau, oscillation, steepest slopes, onset."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from isopeel.arrays import FloatArray
from isopeel.errors import InputError
from isopeel.results.curve import Curve

#: The onset is where the reaction has fallen this far below its initial straight line.
ONSET_DEVIATION = 0.02
# an angle of the window and one of the curve are the same when they differ by round-off only
_SAME = 1e-9


@dataclass(frozen=True)
class PlateauReading:
    """What a window of the plateau tells; in the units of the curve, slopes per unit of its parameter.

    The oscillation comes from the mesh: one period is the passage of one element. Amplitude and slopes are
    read after the drift of the plateau, a straight line, was taken out, because the drift across a
    window can be larger than the oscillation.
    """

    window: tuple[float, float]
    mean: float
    drift: float  # slope of the line that was taken out
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


def read_plateau(
    curve: Curve, window: tuple[float, float], period: float | None = None
) -> PlateauReading | None:
    """Read the plateau in a window of the parameter; None where the curve does not cover it.

    The drift is fitted to the mean of the curve over one `period` of the oscillation around each step, which
    the oscillation itself does not move; without a period, or where the curve ends too soon for that, it is
    fitted to the curve.
    """
    check_window(window)
    start, end = window
    inside = (curve.parameter >= start - _SAME) & (curve.parameter <= end + _SAME)
    covered = len(curve) > 1 and curve.parameter[0] <= start + _SAME and curve.parameter[-1] >= end - _SAME
    if not covered or np.count_nonzero(inside) < 4:
        return None
    parameter, reaction = curve.parameter[inside], curve.reaction[inside]
    drift, level = np.polyfit(parameter - start, _running_mean(curve, parameter, period), 1)
    oscillation = reaction - level - drift * (parameter - start)
    slopes = np.diff(oscillation) / np.diff(parameter)
    return PlateauReading(
        window=window,
        mean=float(reaction.mean()),
        drift=float(drift),
        amplitude=float(np.ptp(oscillation)),
        steepest_rise=float(slopes.max()),
        steepest_fall=float(slopes.min()),
    )


def _running_mean(curve: Curve, parameter: FloatArray, period: float | None) -> FloatArray:
    """Mean of the curve over one period around each parameter, or the curve itself."""
    spline = CubicSpline(curve.parameter, curve.reaction)
    if period is not None:
        before, after = parameter - period / 2, parameter + period / 2
        if before[0] >= curve.parameter[0] and after[-1] <= curve.parameter[-1]:
            integral = spline.antiderivative()
            mean: FloatArray = (integral(after) - integral(before)) / period
            return mean
    return np.asarray(spline(parameter), dtype=np.float64)


def onset_angle(curve: Curve) -> float | None:
    """Parameter at which the curve has left its initial straight line by 2 %, by linear interpolation.

    None where it has not. The line goes through the origin and the first step after it.
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
