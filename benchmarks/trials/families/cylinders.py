"""Cylinders pulled off a flat substrate or pressed on it, by their flat middle plane.

Answers, of which a quarter cylinder has one half:
* pulled off at a Tabor parameter (R W^2/(E*^2 delta^3))^(1/3), delta = W/strength, from 3 to 8: the line
  contact of Johnson, Kendall and Roberts, which `isopeel validate` meets within 0.8 % above 2.5;
* from 0.005 to 0.03: the law summed over a rigid parabola, which it meets within 0.4 % below 0.05;
* pressed by d without adhesion: d = P/(pi E*) (2 ln(4 R/a) - 1), a^2 = 4 P R/(pi E*) (Johnson, Contact
  Mechanics, Sec. 5.6: half of a cylinder between two planes), by a stiff law that takes less than 0.4 % of
  d. Contacts are narrower than 0.06 R at the load in question (0.04 R where pulled), for theories of half
  spaces.
"""

from math import log, pi, sqrt

from scipy.optimize import brentq

from isopeel.case import Case
from isopeel.post.closed_form import jkr_line_pull_off
from isopeel.post.closed_form.rigid_cylinder import rigid_cylinder_pull_off
from trials.case import Answer, Drawn, Value, case_text
from trials.dice import Dice
from trials.quantities import rounded
from trials.sheets import (
    DEFAULT_ELEMENTS,
    DEFAULT_MESH,
    DEFAULT_SPACE,
    HEIGHTS,
    MODULI,
    WORKS,
    law,
    material,
    path,
    poissons_ratio,
    units,
)

TABOR = {"JKR": (3.0, 8.0), "rigid": (0.005, 0.03)}
PULLED, PRESSED = (0.01, 0.04), (0.015, 0.06)  # half-widths of the contact over the radius
#: J/m^2: works of adhesion from 1e-12 on are read, in any of the units that cases measure in.
LEAST_WORK = 1e-8
#: Stiffness of the law that only repels, in E*/a: it takes 2/(9 * 300) of the approach.
STIFF = 300.0


def draw(dice: Dice) -> Drawn:
    """Draw a cylinder, what is done to it, and a mesh."""
    while True:
        drawn = _pressed(dice) if dice.chance(0.25) else _pulled(dice)
        if drawn:
            return drawn


def pressed_load(approach: float, reduced_modulus: float, radius: float) -> float:
    """Load per length at which a half cylinder is pressed by an approach of its middle plane."""

    def beyond(load: float) -> float:
        half_width = sqrt(4 * load * radius / (pi * reduced_modulus))
        return load / (pi * reduced_modulus) * (2 * log(4 * radius / half_width) - 1) - approach

    scale = reduced_modulus * approach
    return float(brentq(beyond, 1e-3 * scale, 3 * scale, xtol=1e-14 * scale))


def _pulled(dice: Dice) -> Drawn | None:
    theory = dice.pick(("JKR", "JKR", "rigid"))
    radius, work, ratio = dice.decades(*HEIGHTS), dice.decades(*WORKS), poissons_ratio(dice)
    reduced = 2 * work / (pi * radius * dice.decades(*PULLED) ** 3)
    modulus = rounded(reduced * (1 - ratio**2))
    if not MODULI[0] <= modulus <= MODULI[1]:
        return None
    reduced = modulus / (1 - ratio**2)
    tabor = dice.decades(*TABOR[theory])
    strength = rounded(tabor * (reduced**2 * work / radius) ** (1 / 3))
    half_width = (2 * work * radius**2 / (pi * reduced)) ** (1 / 3)
    chosen = law(dice, work, strength, small=False)
    load = jkr_line_pull_off(work, reduced, radius)
    reaching = max(4 * half_width, sqrt(2 * radius * chosen.spent))
    if reaching > 0.5 * radius:
        return None
    stretched = load / (pi * reduced) * (2 * log(4 * radius / half_width) + 1)
    end, step = path(1.2 * stretched + 1.2 * work / strength, dice.pick((25, 40, 60)))
    zone = min(half_width, reduced * work / strength**2) if tabor > 1 else 0.3 * reaching
    drawn = _cylinder(
        dice,
        radius,
        ratio,
        modulus,
        chosen.table,
        reaching,
        end,
        step,
        zone,
        f"{theory}, {chosen.table['law']}",
    )
    if theory == "rigid":
        case = Case.parse(case_text("rigid", drawn.sections))
        size = _internal(case)
        law_of_case = case.problem().adhesion.law
        load = rigid_cylinder_pull_off(law_of_case, radius / size[0]) * size[0] * size[1]
    return _answered(drawn, "pull-off", load)


def _pressed(dice: Dice) -> Drawn | None:
    radius, ratio, modulus = dice.decades(*HEIGHTS), poissons_ratio(dice), dice.decades(*MODULI)
    reduced, half_width = modulus / (1 - ratio**2), dice.decades(*PRESSED) * radius
    load = pi * reduced * half_width**2 / (4 * radius)
    approach = load / (pi * reduced) * (2 * log(4 * radius / half_width) - 1)
    end, step = path(approach, dice.pick((10, 20, 40)))
    # a pull-off force of 0.0008 of the load, and the stiffness (e strength)^2/W
    work = rounded(1e-5 * sqrt(load**3 / (reduced * radius)))
    if work < LEAST_WORK:
        return None
    strength = rounded(sqrt(STIFF * reduced / half_width * work) / 2.718281828)
    table: dict[str, Value] = {"law": "exponential", "strength": f"{strength:.4g} Pa"}
    table["work_of_adhesion"] = f"{work:.4g} J/m^2"
    drawn = _cylinder(
        dice, radius, ratio, modulus, table, 3 * half_width, -end, step, half_width, "pressed", quarter=True
    )
    return _answered(drawn, "push", pressed_load(end, reduced, radius))


def _cylinder(
    dice: Dice,
    radius: float,
    ratio: float,
    modulus: float,
    adhesion: dict[str, Value],
    reaching: float,
    end: float,
    step: float,
    zone: float,
    kind: str,
    *,
    quarter: bool = False,
) -> Drawn:
    """A case whose adhesion acts up to an arc length from the lowest point; its answer is yet to come."""
    quarter = quarter or dice.chance(0.6)
    discretization: dict[str, Value] = {}
    if not dice.chance(DEFAULT_SPACE):
        discretization["space"] = dice.pick(("L1", "L2", "N2", "N2", "N4"))
    arc = radius * pi / (4 if quarter else 2)
    along, grading = DEFAULT_ELEMENTS, 1.0
    if not dice.chance(DEFAULT_MESH):
        grading = dice.pick((1.0, 10.0, 50.0, 200.0)) if quarter else 1.0
        # the first of graded elements is smaller than their mean by log(grading)/(1 - 1/grading), or more
        smaller = 1.0 if grading == 1 else log(grading) / (1 - 1 / grading)
        along = min(max(round(arc / smaller / (dice.decades(0.1, 10.0) * zone)), 6), 150)
        across = dice.pick((4, 8, 16, 24))
        discretization["mesh"] = f"{along}x{across}"
        if grading > 1:
            discretization["grading"] = [grading, grading]
        first = arc / along / smaller
    else:
        first = arc / along
    length = reaching if quarter else 2 * reaching
    return Drawn(
        f"{kind}, {'quarter' if quarter else 'half'}",
        {
            **units(dice, radius),
            "body": {"shape": f"{'quarter' if quarter else 'half'}-cylinder", "radius": dice.length(radius)},
            "material": material(dice, modulus, ratio),
            "adhesion": {**adhesion, "length": dice.length(rounded(length))},
            "discretization": discretization,
            "drive": {
                "kind": "displacement",
                "side": "top",
                "angle": "90 deg",
                "to": dice.length(end),
                "step": dice.length(step),
            },
        },
        Answer("push", 0.0),
        first / zone,
    )


def _answered(drawn: Drawn, reading: str, load: float) -> Drawn:
    body = drawn.sections["body"]
    assert isinstance(body, dict)
    assert reading in ("pull-off", "push")
    share = 0.5 if body["shape"] == "quarter-cylinder" else 1.0
    answer = Answer("pull-off" if reading == "pull-off" else "push", share * load)
    return Drawn(drawn.kind, drawn.sections, answer, drawn.element, drawn.files)


def _internal(case: Case) -> tuple[float, float]:
    """The units of a case in metres and pascals."""
    system = case.units.system()
    return float(system.length), float(system.stress)
