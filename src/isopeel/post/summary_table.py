"""The table of a summary, as printed."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from isopeel.post.findings import Findings, all_readings
from isopeel.post.laboratory import Laboratory, kind_of
from isopeel.post.readings import (
    Reading,
)
from isopeel.problem import Column
from isopeel.results.curve import Curve


class Row(NamedTuple):
    """A row of the table of a summary: name, value, value of theory, and deviation."""

    name: str
    value: str
    theory: str = ""
    deviation: str = ""


def summary_rows(summary: Mapping[str, Any], curve: Curve, found: Findings) -> list[Row]:
    """Return the rows of a summary in words; cells without content are empty."""
    laboratory = found.laboratory
    parameter = curve.parameter_column
    spaces = zip(summary["space"].split(", "), summary["mesh"].split(", "), strict=True)
    described = "; ".join(f"{space}, {mesh}" for space, mesh in spaces)
    rows = [Row("space", f"{described}{';' if ';' in described else ','} {summary['dofs']} DOFs")]
    if not len(curve):
        rows.append(Row("reached", "-"))
    else:
        rows.append(Row("reached", laboratory.parameter(parameter, float(curve.parameter[-1]))))
    readings = all_readings(curve, found, None)
    rows += [_row(reading, parameter, laboratory) for reading in readings if reading.name != "jump"]
    if (found.window or found.closed_form) and not any(
        reading.name.startswith(("steady", "mean")) for reading in readings
    ):
        form = found.closed_form
        kind = kind_of(curve.reaction_column)
        steady = f"{laboratory.text(form.reaction, kind)}\n  {form.source}" if form else ""
        rows.append(Row(f"steady {curve.reaction_column.name}", "-", steady))
    plateau = found.plateau
    if plateau is not None:
        reaction, at = laboratory.column(curve.reaction_column), laboratory.column(parameter)
        kind = kind_of(curve.reaction_column)
        rows.append(Row("amplitude", laboratory.both(plateau.amplitude, kind, 4)))
        slopes = (plateau.steepest_rise, plateau.steepest_fall)
        values = ", ".join(f"{slope * reaction.factor / at.factor:+.4g}" for slope in slopes)
        rows.append(Row("steepest slopes", f"{values} {reaction.name} per {at.name}"))
    form = found.closed_form
    if summary["onset"] is not None or (form and form.onset is not None):
        onset = None if form is None else form.onset
        rows.append(Row("onset", _angle(summary["onset"]), "" if onset is None else _angle(onset)))
    if summary["jumps"]:
        released = [jump["released_energy"] for jump in summary["jumps"]]
        largest = int(np.argmax(released))
        at_which = laboratory.parameter(parameter, summary["jumps"][largest][parameter.name])
        text = f"{len(released)}, releasing {laboratory.text(sum(released), 'energy', 4)}"
        if len(released) > 1:
            text += f"; the largest {laboratory.text(released[largest], 'energy', 4)} at {at_which}"
        else:
            text += f" at {at_which}"
        rows.append(Row("jumps", text))
    rows += _zone_rows(found, parameter)
    for change in summary["finer_mesh"]:
        relative = change["relative_change"]
        name = curve.reaction_column.name
        finer = "no equilibrium nearby" if relative is None else f"{name} changes by {100 * relative:.2f} %"
        at_which = laboratory.parameter(parameter, change[parameter.name])
        rows.append(Row("half of the element length", f"{finer}, at {at_which}"))
    per_step = summary["corrections_per_step"]
    average = "-" if per_step is None else f"{per_step:.2f} per step"
    rows.append(Row("corrections", f"{summary['corrections']}, {average}"))
    rows.append(Row("time", f"{summary['wall_time_s']:.1f} s"))
    return rows


def _row(reading: Reading, parameter: Column, laboratory: Laboratory) -> Row:
    value = laboratory.both(reading.value, reading.kind)
    if reading.at is not None:
        value += f" at {laboratory.parameter(parameter, reading.at)}"
    words = reading.words
    if reading.between is not None:
        first, last = (laboratory.parameter(parameter, end) for end in reading.between)
        words += f"{', ' if words else ''}{first} to {last}"
    if words:
        value += f"\n  {words}"
    if reading.theory is None:
        return Row(reading.name, value)
    theory = f"{laboratory.text(reading.theory, reading.kind)}\n  {reading.source}"
    deviation = reading.deviation
    return Row(reading.name, value, theory, "" if deviation is None else f"{100 * deviation:+.2g} %")


def _zone_rows(found: Findings, parameter: Column) -> list[Row]:
    """Return a row on the elements that each process zone has, and needs; none where unknown."""
    laboratory, rows = found.laboratory, []
    for interface, zones in found.zones.items():
        counts, needed = [], None
        if zones.last is not None:
            at, zone = zones.last
            counts.append(f"{zone.elements:.2g} at {laboratory.parameter(parameter, at)}")
            needed = zone.needed
        if zones.estimated is not None:
            counts.append(f"{zones.estimated.elements:.2g} estimated")
            needed = zones.estimated.needed
        if counts:
            where = f", {interface}" if len(found.zones) > 1 else ""
            name = f"elements in process zone{where}"
            rows.append(Row(name, f"{', '.join(counts)}; {needed:.2g} needed"))
    return rows


def _angle(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g} deg"
