"""What is read from the sensitivities of a curve: those of its plateau and of its largest reaction."""

from collections.abc import Iterator

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.post.laboratory import Laboratory
from isopeel.post.plateau import in_window
from isopeel.post.readings import Reading
from isopeel.results.curve import Curve
from isopeel.results.notes import Note

_WORDS = "percent for one percent of {}"


def sensitivity_readings(curve: Curve, window: tuple[float, float] | None) -> list[Reading]:
    """Return the relative sensitivities d ln S/d ln m of the mean in a window, and of the largest reaction S.

    There are none by a parameter that is zero, nor of a reaction that is zero or has no sensitivities.
    """
    if not curve.sensitivities.size:
        return []
    name, readings = curve.reaction_column.name, []
    inside = None if window is None else in_window(curve, window)
    if inside is not None:
        mean = curve.reaction[inside].mean()
        for key, change in _relative(curve, mean, curve.sensitivities[inside].mean(axis=0)):
            words = _WORDS.format(key)
            readings.append(
                Reading(f"d ln mean {name}, {key}", change, "number", words=words, between=window)
            )
    k = int(np.argmax(curve.reaction))
    for key, change in _relative(curve, curve.reaction[k], curve.sensitivities[k]):
        at = float(curve.parameter[k])
        readings.append(
            Reading(f"d ln largest {name}, {key}", change, "number", at, words=_WORDS.format(key))
        )
    return readings


def sensitivity_notes(curve: Curve, laboratory: Laboratory) -> list[Note]:
    """Return a note where steps have no sensitivities."""
    (without,) = np.nonzero(np.isnan(curve.sensitivities).any(axis=1))
    if not len(without):
        return []
    ends = curve.parameter[without]
    first, last = (
        laboratory.parameter(curve.parameter_column, float(end)) for end in (ends.min(), ends.max())
    )
    text = (
        f"sensitivities: {len(without)} steps between {first} and {last} have none: at a limit point there is"
        " no derivative at a fixed displacement, nor where a joint keeps the damage of one"
    )
    return [Note("reading", text)]


def relative_sensitivities(curve: Curve) -> FloatArray:
    """Return m dr/dm (steps, parameters), in the unit of the reaction."""
    relative: FloatArray = curve.sensitivities * [one.value for one in curve.sensitive_to]
    return relative


def _relative(curve: Curve, reaction: float, rates: FloatArray) -> Iterator[tuple[str, float]]:
    """Yield the keys of parameters and m/r dr/dm, where it is known."""
    for one, rate in zip(curve.sensitive_to, rates, strict=True):
        if reaction and one.value and np.isfinite(rate):
            yield one.key, float(one.value * rate / reaction)
