"""Process zones of strips under a moment, measured and estimated, and errors over their elements."""

import argparse
from collections.abc import Callable, Iterator

import numpy as np

from isopeel import ConvergenceError, NewtonSettings, trace
from isopeel.case import Case
from isopeel.post.closed_form import beam_peeling
from isopeel.post.front import front_profile, process_zone
from isopeel.post.resolution import estimated
from printing import plain_table, wide_console

#: Keys of laws by their strength in units of E; W is 2e-5 times E and the height of the strip.
LAWS: dict[str, Callable[[float], str]] = {
    "exponential": lambda s: f'strength = "{s} MPa"\nwork_of_adhesion = "2e-5 N/mm"',
    "bilinear": lambda s: f'strength = "{s} MPa"\nwork_of_adhesion = "2e-5 N/mm"\nrise = 0.1',
    # the two constants of van der Waals adhesion that give this W and this strength
    "van-der-waals": lambda s: (
        f'equilibrium_distance = "{1.6122 * 2e-5 / s!r} mm"\n'
        f'hamaker_constant = "{2e-5 * 16 * np.pi * (1.6122 * 2e-5 / s) ** 2 / 15 ** (1 / 3)!r} N mm"'
    ),
}
#: Strengths, for which E' W/(sigma^2 h) is from 88 to 0.9, and numbers of elements that resolve the zone.
STRENGTHS = {5e-4: 80, 2e-3: 160, 5e-3: 240}
SPACES = ("L1", "L2", "N2", "N2.1", "N4")
#: Elements in the estimated process zone.
ELEMENTS = (0.3, 0.5, 0.7, 1.0, 1.4, 2.0)


def strip(law: str, strength: float, space: str, along: int) -> Case:
    """Return a strip of E = 1 MPa, bent to a radius of 40 heights."""
    return Case.parse(f"""\
name = "strip"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "40 mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "1 MPa"
poissons_ratio = 0.3
[adhesion]
law = "{law}"
{LAWS[law](strength)}
length = "30 mm"
[discretization]
space = "{space}"
mesh = "{along}x1"
[drive]
to = "40 deg"
step = "0.5 deg"
""")


def peeled(case: Case) -> tuple[float, float | None]:
    """Return the mean moment of the last ten degrees over that of beam theory, and the last process zone."""
    (stage,) = case.stages()
    theory = beam_peeling(stage.problem)
    assert theory is not None
    *_, last = steps = list(
        trace(stage.problem, case.space(), stage.parameters, NewtonSettings(path_control="auto"))
    )
    zone = process_zone(front_profile(stage.problem, case.space(), last.displacement))
    mean = np.mean([step.reaction for step in steps[-20:]])
    return float(mean) / theory.moment, None if zone is None else zone.length


def estimates() -> Iterator[tuple[str, ...]]:
    """Yield each law and strength with the length of the process zone: measured, estimated, and the ratio."""
    for law in LAWS:
        for strength, along in STRENGTHS.items():
            case = strip(law, strength, "N2.1", along)
            _, zone = peeled(case)
            found = estimated(case.problem(), case.space())
            assert zone is not None
            assert found is not None
            yield law, f"{strength:g}", f"{zone:.3f}", f"{found.zone:.3f}", f"{found.zone / zone:.2f}"


def errors(law: str, strength: float) -> Iterator[tuple[str, ...]]:
    """Yield each space with errors of the plateau in percent, over elements in the zone; * with a note."""
    reference = strip(law, strength, "N2.1", STRENGTHS[strength])
    fine, _ = peeled(reference)
    found = estimated(reference.problem(), reference.space())
    assert found is not None
    for space in SPACES:
        cells = []
        for elements in ELEMENTS:
            case = strip(law, strength, space, round(40 * elements / found.zone))
            resolution = estimated(case.problem(), case.space())
            assert resolution is not None
            mark = "" if resolution.is_enough else " *"
            try:
                cells.append(f"{100 * (peeled(case)[0] / fine - 1):.2f}{mark}")
            except ConvergenceError:
                cells.append(f"-{mark}")
        yield law, f"{strength:g}", space, *cells


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--law", nargs="+", choices=LAWS, default=[*LAWS])
    parser.add_argument("--strength", nargs="+", type=float, choices=STRENGTHS, default=[5e-4, 2e-3])
    chosen = parser.parse_args()
    console = wide_console()
    table = plain_table(
        "process zone in heights of the strip", "law", "strength / E", "measured", "estimated", "ratio"
    )
    for row in estimates():
        table.add_row(*row)
    console.print(table)
    table = plain_table(
        "error of the plateau, %, over elements in the process zone",
        "law",
        "strength / E",
        "space",
        *(f"{elements:g}" for elements in ELEMENTS),
        caption="* with a note before the run; L1 with the excess of its bending stiffness",
        labels=3,
    )
    for law in chosen.law:
        for strength in chosen.strength:
            for row in errors(law, strength):
                table.add_row(*row)
    console.print(table)


if __name__ == "__main__":
    main()
