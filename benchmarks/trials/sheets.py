"""Material, law, units and mesh of thin bodies."""

from dataclasses import dataclass
from math import e, exp, pi, sqrt

from trials.case import Table, Value
from trials.dice import Dice
from trials.quantities import rounded

#: Heights and works of adhesion, three decades each; those of van der Waals adhesion at its own scale.
HEIGHTS, WORKS = (2e-6, 2e-3), (0.05, 50.0)
SMALL_HEIGHTS, SMALL_WORKS = (4e-9, 4e-6), (0.003, 0.3)
#: Young's moduli of soft gels and of steel; draws beyond are drawn again.
MODULI = (2e4, 4e11)
#: Number of elements along, in a mesh that a case names.
FEWEST, MOST = 6, 360
DEFAULT_ELEMENTS = 200
#: Shares of cases that name no space, and no mesh.
DEFAULT_SPACE, DEFAULT_MESH = 0.6, 0.35
SPACES = ("L1", "L2", "N2", "N4", "N2.1", "L4")
#: Openings, in W/strength, at which cohesive laws have less than a thousandth of their work left: the
#: exponential law has (1 + z) e^-z = 1e-3 at z = 9.2 openings W/(e strength).
SPENT = 3.4
#: The same of van der Waals adhesion: 0.54 (r0/r)^2 of the work is left at r, and W/strength = 0.62 r0.
FAR = 37.0


@dataclass(frozen=True)
class Law:
    """A law of adhesion: its table, and the opening at which nearly all of its work is done."""

    table: dict[str, Value]
    spent: float


def poissons_ratio(dice: Dice) -> float:
    """Poisson's ratio from 0 to 0.4999: of a handbook, any, or of rubbers and gels."""
    sort = dice.pick(("handbook", "any", "rubber"))
    if sort == "handbook":
        return dice.pick((0.0, 0.2, 0.3, 0.33, 0.35, 0.4, 0.45))
    if sort == "any":
        return round(dice.between(0.01, 0.49), 3)
    return dice.pick((0.48, 0.49, 0.495, 0.499, 0.4995, 0.4999))


def law(dice: Dice, work: float, strength: float, *, small: bool) -> Law:
    """A law of this work and strength, van der Waals adhesion at `small` scales."""
    if small:
        # W = A_H 15^(1/3)/(16 pi r0^2), strength = sqrt(5) A_H/(9 pi r0^3)
        distance = rounded(work / strength * 16 * sqrt(5) / 9 / 15 ** (1 / 3))
        hamaker = work * 16 * pi * distance**2 / 15 ** (1 / 3)
        table: dict[str, Value] = {
            "law": "van-der-waals",
            "hamaker_constant": f"{hamaker:.9e} J",
            "equilibrium_distance": f"{distance * 1e9:.6g} nm",
        }
        return Law(table, FAR * work / strength)
    kind = dice.pick(("exponential", "exponential", "bilinear", "dugdale", "trapezoidal", "formula"))
    if kind == "formula":
        # strengths: 2/sqrt(2 e) W/d at r = d/sqrt(2), and W/(e d) at r = d
        gauss = dice.chance(0.5)
        length = rounded(work / strength * (sqrt(2 / e) if gauss else exp(-1)))
        shape = "-W*exp(-(r/d)**2)" if gauss else "-W*(1 + r/d)*exp(-r/d)"
        constants = {"W": dice.work(work), "d": dice.length(length)}
        return Law({"law": kind, "potential": shape, "constants": constants}, SPENT * work / strength)
    table = {"law": kind, "strength": dice.stress(strength), "work_of_adhesion": dice.work(work)}
    if kind == "bilinear":
        table["rise"] = round(dice.between(0.05, 0.5), 2)
    elif kind == "dugdale":
        table["transition"] = round(dice.between(0.1, 0.6), 2)
    elif kind == "trapezoidal":
        table["rise"] = round(dice.between(0.05, 0.3), 2)
        table["plateau"] = round(dice.between(0.1, 0.6), 2)
    return Law(table, SPENT * work / strength)


def units(dice: Dice, length: float) -> dict[str, Table]:
    """Return the table `units` of a case, or nothing, for a body of this height."""
    if length < 3e-6:
        choices: tuple[tuple[str, str] | None, ...] = (None, None, ("1 nm", "1 GPa"), ("1 um", "1 MPa"))
    else:
        choices = (None, ("1 mm", "1 MPa"), ("1 mm", "1 MPa"), ("1 mm", "1 GPa"), ("1 um", "1 MPa"))
    chosen = dice.pick(choices)
    return {} if chosen is None else {"units": {"length": chosen[0], "stress": chosen[1]}}


def material(dice: Dice, modulus: float, ratio: float) -> Table:
    """The table of the material."""
    return {"law": "neo-hooke", "youngs_modulus": dice.stress(modulus), "poissons_ratio": ratio}


@dataclass(frozen=True)
class Mesh:
    """A discretization: its table, the elements along, and the size of one over that of the process zone."""

    table: Table
    elements: int
    element: float


def element_size(dice: Dice, zone: float) -> float | None:
    """Return a size from a tenth of the process zone to ten process zones; None for the default mesh."""
    return None if dice.chance(DEFAULT_MESH) else dice.decades(0.1, 10.0) * zone


def mesh(dice: Dice, length: float, size: float | None, zone: float, across: int | None = None) -> Mesh:
    """Return a mesh of elements of this size, limited by the cost of a case."""
    table: dict[str, Value] = {}
    if not dice.chance(DEFAULT_SPACE):
        table["space"] = dice.pick(SPACES)
    along = DEFAULT_ELEMENTS
    if size is not None:
        along = min(max(round(length / size), FEWEST), MOST)
        table["mesh"] = f"{along}x{across or dice.pick((1, 2, 2, 3, 4))}"
    return Mesh(table, along, length / along / zone)


def path(end: float, steps: int) -> tuple[float, float]:
    """Return the end and the step of about this number of steps; the step has three digits."""
    step = rounded(end / steps, 2)
    return rounded(step * max(1, round(end / step)), 10), step


def process_zone(stiffness: float, bending: float, work: float, strength: float) -> float:
    """Return the length over which adhesion of this strength separates.

    That of thin bodies is (E'I W/strength^2)^(1/4), up to a factor near one: a beam on which the attraction
    `strength` acts over a length l bends by strength l^4/(E'I), and separates at W/strength. In a thick body
    it is E'W/strength^2 (Hillerborg, Modeer and Petersson, Cem. Concr. Res. 6, 1976). The shorter one is
    used.
    """
    return min(sqrt(sqrt(bending * work) / strength), stiffness * work / strength**2)
