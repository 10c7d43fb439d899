"""The table of a curve, curve.csv, in the units of a laboratory.

The first line has the name of each column with its unit in brackets, as "force [N/m]"; there are no other
lines before the numbers, so that `pandas.read_csv("curve.csv")` reads it as it is.
"""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from isopeel.post.crack import Fronts, crack_lengths, load_position
from isopeel.post.front_readings import FrontFlows, flow_columns
from isopeel.post.laboratory import Kind, Laboratory
from isopeel.problem import Problem
from isopeel.results.curve import Curve, write_table

#: Nothing is known of any interface.
NO_FRONTS: Mapping[str, Fronts] = MappingProxyType({})
NO_FLOWS: Mapping[str, FrontFlows] = MappingProxyType({})


def write_curve(
    path: Path,
    curve: Curve,
    problem: Problem,
    laboratory: Laboratory,
    fronts: Mapping[str, Fronts] = NO_FRONTS,
    flows: Mapping[str, FrontFlows] = NO_FLOWS,
) -> None:
    """Write the curve of a problem with all digits; one line for each step.

    The column crack_length has a value where the displacement is stored and there is a front; of several
    interfaces each has one, with its name. A body on the whole of which the load acts has no such column, and
    neither has one that is not loaded. What flows to fronts, the J-integral, G_I, G_II and the mode ratio,
    have columns if they are given in any state. Raises OSError.
    """
    table = {}
    for column, values in curve.table():
        factor = laboratory.column(column).factor
        # a factor of one does not change whole numbers and texts
        table[laboratory.heading(column)] = (values if factor == 1.0 else values * factor).tolist()
    table |= sensitivity_columns(curve, laboratory)
    for name in problem.interface_names:
        of = f" {name}" if len(problem.interface_names) > 1 else ""
        columns: list[tuple[str, Kind, Mapping[int, float]]] = []
        if load_position(problem, name) is not None:
            columns.append(("crack_length", "length", crack_lengths(fronts.get(name, {}))))
        columns += flow_columns(flows.get(name, {}))
        for heading, kind, found in columns:
            unit = laboratory.unit(kind)
            shown = {step: value * unit.factor for step, value in found.items()}
            table[f"{heading}{of} [{unit.name}]".removesuffix(" []")] = [
                shown.get(step) for step in range(len(curve))
            ]
    write_table(path, table)


def sensitivity_columns(curve: Curve, laboratory: Laboratory) -> dict[str, list[float | None]]:
    """Return the sensitivities of a curve (steps,) by their headings, as
    "d force / d body.height [N/m per nm]"."""
    unit, name = laboratory.column(curve.reaction_column), curve.reaction_column.name.removesuffix("_deg")
    found = {}
    for one, rates in zip(curve.sensitive_to, curve.sensitivities.T * unit.factor, strict=True):
        per = f"{unit.name} per {one.unit}" if one.unit else unit.name
        values: list[float | None] = [None if rate != rate else rate for rate in rates.tolist()]
        found[f"d {name} / d {one.key} [{per}]"] = values
    return found
