"""A curve and its plateau in the units in which they are shown."""

from dataclasses import replace
from typing import NamedTuple

from isopeel.post.closed_form import Expected
from isopeel.post.findings import Findings
from isopeel.post.plateau import PlateauReading
from isopeel.results.curve import Curve


class Shown(NamedTuple):
    """A curve and its findings in laboratory units, for figures and tables of several runs."""

    curve: Curve
    plateau: PlateauReading | None
    closed_form: Expected | None
    period: float | None


def in_laboratory(curve: Curve, found: Findings) -> Shown:
    """Return a curve, its plateau and its closed form in the units in which they are shown."""
    laboratory, plateau, form = found.laboratory, found.plateau, found.closed_form
    p, r = (laboratory.column(column).factor for column in (curve.parameter_column, curve.reaction_column))
    return Shown(
        laboratory.curve(curve),
        plateau
        and replace(
            plateau,
            window=(plateau.window[0] * p, plateau.window[1] * p),
            mean=plateau.mean * r,
            drift=plateau.drift * r / p,
            amplitude=plateau.amplitude * r,
            steepest_rise=plateau.steepest_rise * r / p,
            steepest_fall=plateau.steepest_fall * r / p,
        ),
        form
        and replace(
            form,
            reaction=form.reaction * r,
            onset=None if form.onset is None else form.onset * p,
            period=None if form.period is None else form.period * p,
        ),
        None if found.period is None else found.period * p,
    )
