"""Locking of a strip peeled by a moment, over Poisson's ratio, degree and elements across."""

import argparse
from collections.abc import Iterator
from time import process_time

import numpy as np

from isopeel import ConvergenceError, NewtonSettings, row_space, trace
from isopeel.case import Case
from isopeel.post.closed_form import beam_peeling
from isopeel.post.locking import bending
from isopeel.splines.rows import RowSpace
from printing import plain_table, wide_console

RATIOS = (0.3, 0.45, 0.49, 0.499, 0.4999)
SPACES = ("L1", "L2", "N2", "N2.1")
#: Elements along and across the strip. There are 3 along per thickness, and 5 in the process zone.
ALONG, ACROSS = 180, (1, 2, 4)
DEGREES = (1, 2, 3)
#: Largest estimated error of a discretization that is run.
HOPELESS = 10.0


def strip(poissons_ratio: float) -> Case:
    """Return a strip of rubber (after Kendall), bent to a radius of 15 times its height."""
    return Case.parse(f"""\
name = "rubber"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "60 mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = {poissons_ratio}
[adhesion]
law = "exponential"
strength = "0.01 MPa"
work_of_adhesion = "0.0005 N/mm"
length = "50 mm"
[drive]
kind = "rotation"
to = "60 deg"
step = "1 deg"
""")


def plateau(case: Case, space: RowSpace) -> float:
    """Return the mean moment of the last ten degrees over that of beam theory; nan without an equilibrium."""
    (stage,) = case.stages()
    theory = beam_peeling(stage.problem)
    assert theory is not None
    path = trace(stage.problem, space, stage.parameters, NewtonSettings(path_control="auto"))
    try:
        moments = [step.reaction for step in path if step.parameter > stage.parameters[-11]]
    except ConvergenceError:
        return float("nan")
    return float(np.mean(moments)) / theory.moment


def rows(spaces: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield each discretization, its error in percent (and estimate) by Poisson's ratio, and seconds."""
    cases = [strip(ratio) for ratio in RATIOS]
    for name in spaces:
        for degree in DEGREES:
            for across in ACROSS:
                space = row_space(name, (ALONG, across), degree)
                began = process_time()
                cells = []
                for case in cases:
                    found = bending(case.problem(), space)
                    assert found is not None
                    estimate = 100 * (np.sqrt(1 + found.excess) - 1)
                    measured = 100 * (plateau(case, space) - 1) if estimate < HOPELESS else float("nan")
                    cells.append(
                        f"{measured:.2f} ({estimate:.2f})" if estimate < HOPELESS else f"({estimate:.0f})"
                    )
                yield name, str(degree), f"{ALONG}x{across}", *cells, f"{process_time() - began:.1f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--space", nargs="+", default=[*SPACES])
    chosen = parser.parse_args()
    table = plain_table(
        "error of the plateau of the moment, %; in brackets what is estimated before the run",
        "space",
        "degree across",
        "mesh",
        *(f"nu {ratio}" for ratio in RATIOS),
        "seconds",
        labels=3,
    )
    for row in rows(tuple(chosen.space)):
        table.add_row(*row)
    wide_console().print(table)


if __name__ == "__main__":
    main()
