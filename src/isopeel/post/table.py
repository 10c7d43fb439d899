"""The table of a curve, curve.csv, in the units of a laboratory.

The first line has the name of each column with its unit in brackets, as "force [N/m]"; there are no other
lines before the numbers, so that `pandas.read_csv("curve.csv")` reads it as it is.
"""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from isopeel.post.crack import Fronts, crack_lengths, load_position
from isopeel.post.laboratory import Laboratory
from isopeel.problem import Column, Problem
from isopeel.results.curve import Curve, write_table

#: No state with a front on any interface.
NO_FRONTS: Mapping[str, Fronts] = MappingProxyType({})


def write_curve(
    path: Path,
    curve: Curve,
    problem: Problem,
    laboratory: Laboratory,
    fronts: Mapping[str, Fronts] = NO_FRONTS,
) -> None:
    """Write the curve of a problem with all digits; one line for each step.

    The column crack_length has a value where the displacement is stored and there is a front; of several
    interfaces each has one, with its name. A body on the whole of which the load acts has no such column, and
    neither has one that is not loaded. Raises OSError.
    """
    table = {}
    for column, values in curve.table():
        factor = laboratory.column(column).factor
        # a factor of one does not change whole numbers and texts
        table[laboratory.heading(column)] = (values if factor == 1.0 else values * factor).tolist()
    for name in problem.interface_names:
        if load_position(problem, name) is None:
            continue
        column = Column(f"crack_length {name}" if len(problem.interface_names) > 1 else "crack_length", "L0")
        lengths = crack_lengths(curve, fronts.get(name, {})) * laboratory.column(column).factor
        table[laboratory.heading(column)] = [
            None if length != length else length for length in lengths.tolist()
        ]
    write_table(path, table)
