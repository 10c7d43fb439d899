"""New cases from what a data sheet has: a tape, a T-peel, a double cantilever or a film.

The mesh resolves the process zone as `isopeel.post.resolution` estimates it, and the path goes on until the
closed form is valid (`isopeel.post.closed_form.expected`). The texts state both.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import ceil, cos, degrees, pi, radians, sqrt

from scipy.optimize import brentq

from isopeel.case import Case
from isopeel.case.values import quantity_of
from isopeel.common.errors import InputError
from isopeel.common.quantities import (
    ANGLE,
    FORCE_PER_WIDTH,
    LENGTH,
    NUMBER,
    STRESS,
    SURFACE_ENERGY,
    Dimension,
)
from isopeel.post.closed_form import kendall_force, t_peel_force
from isopeel.post.closed_form.expected import ARM, DECAY
from isopeel.post.resolution import process_zone_length

#: Elements in the process zone; N2.1 needs half an element for 1 %, so that the peaks of the force are right,
#: too. The front passes one of them in this number of steps, of which an amplitude needs 8.
_ELEMENTS, _STEPS = 3, 9
#: The reading begins where the free part is this many times as long as the closed form needs: at 180 degrees,
#: an arm of 3 elastica lengths changes the force by 1 %, and one of 4.5 by 0.05 %.
_LATER = 1.5
#: More elements take more than minutes.
_MOST = 4000


@dataclass(frozen=True)
class Question:
    """What is asked for: an option, its dimension, the question, and the answer if there is none."""

    option: str
    dimension: Dimension
    text: str
    usual: str | None = None

    @property
    def name(self) -> str:
        """The option on the command line."""
        return f"--{self.option.replace('_', '-')}"

    def read(self, written: str) -> float:
        """Return an answer in SI units, angles in degrees. Raises InputError unless it is positive."""
        try:
            if self.dimension.is_number:
                value = float(written)
            else:
                quantity = quantity_of(self.dimension, written)
                value = quantity.value if self.dimension.angle else float(quantity.exact)
        except ValueError as error:
            raise InputError(self.name, written, self.dimension.needed) from error
        if not 0 < value < float("inf"):
            raise InputError(self.name, written, f"it must be positive; {self.dimension.needed}")
        return value


_THICKNESS = Question("thickness", LENGTH, "thickness of the backing, without the adhesive, such as 25 um")
_MODULUS = Question("modulus", STRESS, "Young's modulus, such as 4 GPa")
_POISSON = Question("poissons_ratio", NUMBER, "Poisson's ratio", "0.38")
_ANGLE = Question("angle", ANGLE, "angle of the force from the substrate", "90 deg")
_FORCE = Question("force", FORCE_PER_WIDTH, "peel force of the data sheet, such as 5 N/25 mm")
_FORCE_ANGLE = Question("force_angle", ANGLE, "angle at which that force was measured", "180 deg")
_WORK = Question("work", SURFACE_ENERGY, "work of adhesion, such as 0.05 J/m^2")
_CRACK = Question("crack", LENGTH, "length of the crack at the start, from the loaded end, such as 20 mm")
#: Options that are not asked for.
STRENGTH = Question("strength", STRESS, "strength of the joint, such as 0.5 MPa", "")
WIDTH = Question("width", LENGTH, "width of the specimen, such as 25 mm", "")

Answers = Mapping[str, float]


@dataclass(frozen=True)
class _Layer:
    """A layer that peels: its numbers (SI), the process zone and the elements in it."""

    height: float
    modulus: float  # E' = E/(1 - nu^2)
    work: float
    strength: float
    zone: float
    chosen: bool  # whether the strength was chosen, not given
    arms: int  # equal layers that open together

    @property
    def element(self) -> float:
        return self.zone / _ELEMENTS

    @property
    def bending(self) -> float:
        """E' I."""
        return self.modulus * self.height**3 / 12

    @property
    def decay(self) -> float:
        """The length that the front reaches into the joint, as `expected.decay_of` has it."""
        return max(sqrt(sqrt(8 * self.bending * self.work) / self.strength), self.height)

    def comments(self) -> str:
        """State the rule of the mesh."""
        zone = _length(self.zone)
        lines = [
            f"# The mesh has {_ELEMENTS} elements in the process zone, {zone} long as estimated by",
            "# 1/(1/(0.47 l_s) + 1/(1.45 l_I)), l_I = E' W/strength^2, l_s = l_I^(1/4) height^(3/4).",
        ]
        if self.arms > 1:
            lines.append("# with half of E' of an arm, as both arms open.")
        if self.chosen:
            lines = [
                f"# The strength was chosen: with it the process zone is {zone} long. The steady",
                "# reaction does not depend on it; the largest one does.",
                *lines,
            ]
        return "".join(f"{line}\n" for line in lines)


def _layer(answers: Answers, work: float, usual_zone: float, arms: int = 1) -> _Layer:
    """Return the layer of answers, one of `arms` equal ones; without a strength its process zone is given."""
    height = answers["thickness"]
    modulus = answers["modulus"] / (1 - answers["poissons_ratio"] ** 2)
    compliant = modulus / arms
    if "strength" in answers:
        strength = answers["strength"]
        zone = process_zone_length(compliant * work / strength**2, height)
        return _Layer(height, modulus, work, strength, zone, chosen=False, arms=arms)
    zone = usual_zone
    # the zone grows with l_I
    irwin = brentq(lambda one: process_zone_length(one, height) - zone, 1e-6 * height, 1e12 * height)
    # rounded as it is written
    strength = float(f"{sqrt(compliant * work / irwin):.3g}")
    return _Layer(height, modulus, work, strength, zone, chosen=True, arms=arms)


def _elements(length: float, layer: _Layer) -> tuple[int, int]:
    """Return the elements along and across. Raises InputError for too many."""
    along = ceil(length / layer.element)
    if along > _MOST:
        allowed = (
            f"the process zone of {_length(layer.zone)} would need {along} elements; {_MOST} are allowed; "
            "give a smaller one, or leave it out"
        )
        raise InputError(STRENGTH.name, f"{layer.strength:g} Pa", allowed)
    return along, min(max(1, round(layer.height / layer.element)), 4)


def _tape(answers: Answers, written: Mapping[str, str]) -> str:
    angle, height = radians(answers["angle"]), answers["thickness"]
    modulus = answers["modulus"] / (1 - answers["poissons_ratio"] ** 2)
    work = _work(answers, modulus * height)
    force = kendall_force(work, modulus * height, angle)
    bent = sqrt(modulus * height**3 / 12 / force)
    layer = _layer(answers, work, max(4 * height, bent / 5))
    free = DECAY * layer.decay
    if angle > pi / 2:
        # pushed along the substrate, so long a free part buckles at a quarter of the force (Euler), before
        # the joint slides apart under it
        free = max(free, pi * bent)
    arm = max(ARM * bent, free + DECAY * layer.decay)
    start = _LATER * arm
    end = start + max(12 * layer.element, 0.2 * arm)
    length = end + 1.5 * DECAY * layer.decay
    along, across = _elements(length, layer)
    # the turn from the front to the force takes 2 bent (1 - cos(angle/2)) of the displacement
    lever, turn = 1 - cos(angle), 2 * bent * (1 - cos(angle / 2))
    first, last = (lever * crack - turn for crack in (start, end))
    sliding = layer.decay / sqrt(modulus * height / (2 * work))
    return f"""\
# Written by isopeel new tape{_from(written)}.
# Kendall's force at this angle is {force:.4g} N/m: F (1 - cos angle) + F^2/(2 E' h) = W.
name = "tape"
{_units(written)}
[body]
length = "{_length(length)}"
height = "{written["thickness"]}"
{_width(written)}
{_material(written)}
[adhesion]
law = "exponential"
work_of_adhesion = "{work:.6g} J/m^2"
strength = "{layer.strength:g} Pa"
length = "{_length(length - free)}"
sliding_length = "{_length(sliding)}"    # the joint holds along the substrate, too

{layer.comments()}[discretization]
space = "N2.1"
mesh = "{along}x{across}"

[drive]
kind = "force"                    # the end moves along the force, and the size of the force is computed
side = "right"
angle = "{written["angle"]}"
to = "{_length(last)}"
step = "{_length(lever * layer.element / _STEPS)}"

# The free part is long enough for Kendall's force from here on.
[reading]
window = ["{_length(first)}", "{_length(last)}"]
"""


def _t_peel(answers: Answers, written: Mapping[str, str]) -> str:
    height, modulus = answers["thickness"], answers["modulus"] / (1 - answers["poissons_ratio"] ** 2)
    work = answers["work"]
    force = t_peel_force(work, modulus * height)
    bent = sqrt(modulus * height**3 / 12 / force)
    # with a weaker joint the arms overlap where they are pressed together
    layer = _layer(answers, work, max(2 * height, bent / 10), arms=2)
    free = DECAY * layer.decay
    arm = max(ARM * bent, free + DECAY * layer.decay)
    start = _LATER * arm
    end = start + max(12 * layer.element, 0.2 * arm)
    length = end + 1.5 * DECAY * layer.decay
    along, across = _elements(length, layer)
    turn = 2 * bent * (1 - cos(pi / 4))
    first, last = (2 * (crack - turn) for crack in (start, end))
    constants = f'youngs_modulus = "{written["modulus"]}", poissons_ratio = {written["poissons_ratio"]}'
    body = f"""\
length = "{_length(length)}"
height = "{written["thickness"]}"
{_width(written)}material = {{ law = "neo-hooke", {constants} }}
"""
    return f"""\
# Written by isopeel new t-peel{_from(written)}.
# The force S on each arm is {force:.4g} N/m: 2 S + S^2/(E' h) = W.
name = "t-peel"
{_units(written)}
[[body]]
name = "lower"
{body}
[[body]]
name = "upper"
on = "lower.top"
{body}
[[interface]]
between = ["upper.bottom", "lower.top"]
length = "{_length(length - free)}"
law = "exponential"
work_of_adhesion = "{written["work"]}"
strength = "{layer.strength:g} Pa"

[[support]]
boundary = "upper.left"
holds = "xy"

[[support]]
boundary = "lower.left"
holds = "x"

{layer.comments()}[discretization]
space = "N2.1"
mesh = "{along}x{across}"

[drive]
kind = "force"                    # it is computed; the distance by which the ends move apart is prescribed
angle = "90 deg"
to = "{_length(last)}"
step = "{_length(2 * layer.element / _STEPS)}"

[[drive.on]]
boundary = "upper.right"

[[drive.on]]
boundary = "lower.right"
factor = -1.0

# The arms are long enough for the steady force from here on.
[reading]
window = ["{_length(first)}", "{_length(last)}"]
"""


def _film(answers: Answers, written: Mapping[str, str]) -> str:
    height, modulus = answers["thickness"], answers["modulus"] / (1 - answers["poissons_ratio"] ** 2)
    work = answers["work"]
    radius = sqrt(modulus * height**3 / 12 / (2 * work))
    layer = _layer(answers, work, max(4 * height, radius / 10))
    free = DECAY * layer.decay
    start = _LATER * (free + DECAY * layer.decay)
    end = start + max(12 * layer.element, 0.2 * start)
    length = end + 1.5 * DECAY * layer.decay
    along, across = _elements(length, layer)
    first, last = (degrees(crack / radius) for crack in (start, end))
    if last > 180:
        allowed = (
            f"the film would bend by {last:.3g} deg before the moment is steady; a thinner film peels before"
        )
        raise InputError("--thickness", written["thickness"], allowed)
    return f"""\
# Written by isopeel new film{_from(written)}.
# The moment that bends the film off is sqrt(2 E' I W) = {sqrt(2 * layer.bending * work):.4g} N m/m.
name = "film"
{_units(written)}
[body]
length = "{_length(length)}"
height = "{written["thickness"]}"
{_width(written)}
{_material(written)}
[adhesion]
law = "exponential"
work_of_adhesion = "{written["work"]}"
strength = "{layer.strength:g} Pa"
length = "{_length(length - free)}"

{layer.comments()}[discretization]
space = "N2.1"
mesh = "{along}x{across}"

[drive]                           # the right face is rotated about its own free centre by a moment
kind = "rotation"
to = "{last:.4g} deg"
step = "{degrees(layer.element / radius) / _STEPS:.3g} deg"

# The free part is long enough for the steady moment from here on.
[reading]
window = ["{first:.4g} deg", "{last:.4g} deg"]
"""


def _double_cantilever(answers: Answers, written: Mapping[str, str]) -> str:
    crack, work = answers["crack"], answers["work"]
    layer = _layer(answers, work, answers["thickness"], arms=2)
    # of one of two equal arms, at the opening 2 u: u = a^2 sqrt(W/(E' I))/3 while the crack of length a grows
    opening = crack**2 * sqrt(work / layer.bending) / 3
    force = sqrt(work * layer.bending) / crack
    length = 2 * crack + 1.5 * DECAY * layer.decay
    along, across = _elements(length, layer)
    return f"""\
# Written by isopeel new double-cantilever{_from(written)}.
# The crack grows from a half opening of about {_length(opening)}, at a force of {force:.4g} N/m.
name = "double-cantilever"
{_units(written)}
# One half: its lower face adheres to its own mirror image, and its displacement is half of the opening.
[body]
length = "{_length(length)}"
height = "{written["thickness"]}"
{_width(written)}
{_material(written)}
[adhesion]
law = "bilinear"
work_of_adhesion = "{written["work"]}"
strength = "{layer.strength:g} Pa"
rise = 0.1
length = "{_length(length - crack)}"
symmetric = true
irreversible = true

{layer.comments()}[discretization]
space = "N2.1"
mesh = "{along}x{across}"

[drive]
kind = "force"                    # it is computed; the displacement of one arm is prescribed
side = "right"
angle = "90 deg"
to = "{_length(2.5 * opening)}"
step = "{_length(opening / 100)}"
"""


@dataclass(frozen=True)
class Test:
    """A test of which a case can be written: what it asks for, in order, and what writes it."""

    about: str
    questions: tuple[Question, ...]
    text: Callable[[Answers, Mapping[str, str]], str]


TESTS: Mapping[str, Test] = {
    "tape": Test(
        "a tape that a force pulls off a rigid substrate at an angle",
        (_THICKNESS, _MODULUS, _POISSON, _FORCE, _FORCE_ANGLE, _ANGLE),
        _tape,
    ),
    "t-peel": Test(
        "two equal layers that forces pull apart at right angles",
        (_THICKNESS, _MODULUS, _POISSON, _WORK),
        _t_peel,
    ),
    "double-cantilever": Test(
        "two equal bonded bars that are opened from a crack at one end",
        (_THICKNESS, _MODULUS, _POISSON, _WORK, _CRACK),
        _double_cantilever,
    ),
    "film": Test(
        "a film that a moment bends off a rigid substrate", (_THICKNESS, _MODULUS, _POISSON, _WORK), _film
    ),
}


def new_case(test: str, written: Mapping[str, str]) -> str:
    """Return the text of a case of one of the TESTS, with the answers to its questions.

    Answers are texts with units, by the names of options; `strength` and `width` may be missing. Raises
    InputError whose field is the option of an answer that cannot be used.
    """
    questions = (*TESTS[test].questions, STRENGTH, WIDTH)
    given = {one.option: written[one.option] for one in questions if one.option in written}
    answers = {one.option: one.read(given[one.option]) for one in questions if one.option in given}
    if answers["poissons_ratio"] >= 0.5:
        raise InputError("--poissons-ratio", given["poissons_ratio"], "it must lie below 0.5")
    for name in ("angle", "force_angle"):
        if answers.get(name, 90.0) > 180:
            raise InputError(f"--{name.replace('_', '-')}", given[name], "it must be at most 180 degrees")
    text = TESTS[test].text(answers, given)
    Case.parse(text)
    return text


def _work(answers: Answers, stiffness: float) -> float:
    """Return the work of adhesion of a force at an angle, by Kendall's balance."""
    force = answers["force"]
    return force * (1 - cos(radians(answers["force_angle"]))) + force**2 / (2 * stiffness)


def _from(written: Mapping[str, str]) -> str:
    return "".join(f" --{name.replace('_', '-')} {text!r}" for name, text in written.items())


def _units(written: Mapping[str, str]) -> str:
    return f"""
[units]
length = "{written["thickness"]}"
stress = "{written["modulus"]}"
"""


def _width(written: Mapping[str, str]) -> str:
    return f'width = "{written["width"]}"\n' if "width" in written else ""


def _material(written: Mapping[str, str]) -> str:
    return f"""\
[material]
law = "neo-hooke"
youngs_modulus = "{written["modulus"]}"
poissons_ratio = {float(written["poissons_ratio"])}
"""


def _length(metres: float) -> str:
    """Return a length with five digits."""
    units = (("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9))
    unit, size = next((one for one in units if metres >= one[1]), units[-1])
    return f"{metres / size:.5g} {unit}"
