"""The quantities of interest of a test: pull-off, initiation, crack length, energy release rate."""

from dataclasses import dataclass, replace
from math import sqrt
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import Contact
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form.expected import reach_behind
from isopeel.post.closed_form.opening import opening
from isopeel.post.crack import Fronts, Release, load_position, opened, release
from isopeel.post.laboratory import Kind, kind_of
from isopeel.post.resolution import lies_flat
from isopeel.problem import Load, Problem
from isopeel.results.curve import Curve
from isopeel.solve.step import KINDS
from isopeel.splines.nurbs import Side

#: The kind of test that a drive makes.
Test: TypeAlias = Literal["moment", "tape", "opening", "pull", "other"]

#: Relative deviation from a closed form above which a note is written.
FAR = 0.05
#: A maximum is a peak where the force falls by this share after it: more than the oscillation of a mesh.
_FALL = 0.02
#: Ratio of tension and largest pressure below which adhesion is negligible: half of the allowed 1 %.
_PRESSED = 0.005
#: Cosine of the angle to the normal of the substrate above which a load pulls and does not peel.
_NORMAL = sqrt(0.5)
#: Last shares of the path in which a steady value is read where a case names no window, the smaller ones for
#: a path that becomes steady late; and the relative variation of the reaction up to which it is steady.
LAST, _STEADY = (0.2, 0.1, 0.05), 0.05
#: Drift, as a share of the mean, up to which a reaction is steady: in a window that the case names, and over
#: the largest share of the path where it names none.
DRIFT = 0.02


@dataclass(frozen=True)
class Reading:
    """One value read from a run, in the units of the case, and that of theory where it is valid."""

    name: str
    value: float
    kind: Kind
    at: float | None = None  # parameter, in the unit of its column
    theory: float | None = None
    source: str = ""
    words: str = ""  # what the value is, or how it was found
    between: tuple[float, float] | None = None  # parameters, in the unit of their column

    @property
    def deviation(self) -> float | None:
        """Relative deviation of the run from theory."""
        return None if not self.theory else self.value / self.theory - 1


@dataclass(frozen=True)
class Forces:
    """Force and displacement of a curve (steps,), under load control or displacement control."""

    force: FloatArray
    displacement: FloatArray


def forces(curve: Curve) -> Forces | None:
    """Return the force of a curve over the displacement; None where its reaction is another quantity."""
    if kind_of(curve.reaction_column) == "force":
        return Forces(curve.reaction, curve.parameter)
    if kind_of(curve.parameter_column) == "force":
        return Forces(curve.parameter, curve.reaction)
    return None


def drive_test(problem: Problem, curve: Curve) -> Test:
    """Return the kind of test of a drive.

    A load on the end of an adhering side opens a joint where the arms are mirror images, or where the end is
    lifted by less than the length sqrt(E'I/W) over which a tape turns into its direction; otherwise it peels
    a tape. A load on the opposite side pulls where it acts within 45 degrees of the normal of the substrate.
    """
    if kind_of(curve.reaction_column) == "moment":
        return "moment"
    adhesion = problem.adhesion
    pulled = forces(curve)
    if pulled is None or not len(curve):
        return "other"
    if load_position(problem) is None:
        return "pull" if abs(_away(problem)) > _NORMAL else "other"
    if isinstance(adhesion.law, Mirrored):
        return "opening"
    if isinstance(adhesion.law, Contact):
        return "other"
    bending = plane_strain_modulus(problem.body.material) * _height(problem) ** 3 / 12
    turned = sqrt(bending / adhesion.law.work_of_adhesion)
    lifted = float(np.abs(pulled.displacement).max())
    return "opening" if abs(_away(problem)) > _NORMAL and lifted < turned else "tape"


def halves(problem: Problem, test: Test) -> str | None:
    """Return a sentence if one half of a problem is modelled; None if it is whole, as far as known."""
    if isinstance(problem.adhesion.law, Mirrored):
        return (
            "one half of a symmetric joint is modelled: forces are those on each arm, displacements are those"
            " of one arm (half of the opening), and energies are those of one half"
        )
    sides = [
        support.side
        for support in problem.supports
        if support.components == (0,) and support.side in ("left", "right") and support.boundary.is_whole
    ]
    if test == "pull" and sides and any(_straight_up(problem, side) for side in sides):
        return (
            f"the {sides[0]} side is held as a line of symmetry: forces and energies are those of this half;"
            " those of the whole body are twice as large"
        )
    return None


def read(
    problem: Problem,
    space: SpaceOfBodies,
    curve: Curve,
    found: Fronts,
    window: tuple[float, float] | None,
) -> list[Reading]:
    """Return the readings of one body on one interface, without the plateau of a window.

    The curve has one step or more, and `found` are the fronts.
    """
    test, pulled = drive_test(problem, curve), forces(curve)
    mirrored = isinstance(problem.adhesion.law, Mirrored)
    readings = []
    if test == "moment" or pulled is None:
        readings.append(largest(curve))
    elif test == "pull":
        readings += _pull(problem, curve, pulled)
    else:
        arm = " on each arm" if mirrored else ""
        peak = _initiation(problem, curve, pulled) if test == "tape" else None
        if peak is not None:
            value, at = float(pulled.force[peak]), float(curve.parameter[peak])
            readings.append(Reading("initiation force", value, "force", at, words="first peak"))
        strongest = _largest_force(curve, pulled)
        if peak is None or curve.parameter[peak] != strongest.at:
            words = ""
            if test == "tape" and _at_the_end(problem, curve)[curve.parameter == strongest.at].any():
                words = "when the end of the joint separates"
            readings.append(replace(strongest, name=f"largest force{arm}", words=words))
        if test == "opening":
            readings += _opened(problem, curve, pulled, arm)
    readings += buckled(curve)
    readings += cracks(curve, found)
    released = release(problem, curve, found, window[0] if window else None)
    if released is not None:
        readings.append(release_reading(problem, space, released))
    return readings


def release_reading(
    problem: Problem, space: SpaceOfBodies, released: Release, interface: str = ""
) -> Reading:
    """Return the energy release rate of an interface, with the work of adhesion of its law."""
    law = problem.interface_of(interface).law
    both = 2 if isinstance(law, Mirrored) else 1
    # a body that touches in part, such as a strip on waves, takes W on a part of its face: G is right, but W
    # is not its theory
    flat = lies_flat(problem, space, interface)
    return Reading(
        "energy release rate",
        both * released.rate,
        "toughness",
        theory=both * law.work_of_adhesion if flat else None,
        source="W" if flat else "",
        words="by the drive" if flat else "by the drive, per area of the face; a part of it adheres",
        between=released.between,
    )


def steady_window(curve: Curve, share: float = LAST[0]) -> tuple[float, float] | None:
    """Return the window of the last share of a curve where its reaction is steady there, else None."""
    if len(curve) < 10 or kind_of(curve.reaction_column) not in ("force", "moment"):
        return None
    rise = np.diff(curve.parameter)
    if not ((rise > 0).all() or (rise < 0).all()):
        return None
    first, last = float(curve.parameter[0]), float(curve.parameter[-1])
    start = last - share * (last - first)
    low, high = sorted((start, last))
    inside = curve.reaction[(curve.parameter >= low) & (curve.parameter <= high)]
    if len(inside) < 4 or np.ptp(inside) > _STEADY * abs(float(inside.mean())):
        return None
    # the reaction of a joint that has come off is steady too, and as small as round-off
    if np.abs(inside).max() < _FALL * np.abs(curve.reaction).max():
        return None
    if abs(drift(curve, (low, high))) * LAST[0] / share > DRIFT:
        return None
    return low, high


def drift(curve: Curve, window: tuple[float, float]) -> float:
    """Return the rise of a line fitted to the reaction in a window of two steps or more, over its mean."""
    inside = (curve.parameter >= window[0]) & (curve.parameter <= window[1])
    along, values = curve.parameter[inside], curve.reaction[inside]
    along = along - along.mean()
    slope = float(along @ values / (along @ along))
    return slope * (window[1] - window[0]) / float(values.mean())


def is_only_pressed(problem: Problem, curve: Curve) -> bool:
    """Return whether the tension of a body that is pulled or pressed is negligible: no front peels then."""
    pulled = forces(curve)
    if pulled is None or drive_test(problem, curve) != "pull":
        return False
    tension = pulled.force * np.sign(_away(problem))
    return float(tension.max()) <= _PRESSED * float(-tension.min())


def first_fall(force: FloatArray) -> int | None:
    """Return the first step at which a force is below its largest so far by more than an oscillation."""
    largest = np.maximum.accumulate(force)
    fallen = np.flatnonzero((force < (1 - _FALL) * largest) & (largest > 0))
    return None if not fallen.size else int(fallen[0])


def _initiation(problem: Problem, curve: Curve, pulled: Forces) -> int | None:
    """Return the step of the first peak of a force; None where it falls because the joint ends."""
    fallen = first_fall(pulled.force)
    if fallen is None or _at_the_end(problem, curve)[fallen]:
        return None
    # a film that buckles far from its joint does not peel
    if opened(problem, curve)[fallen] < _FALL * _height(problem):
        return None
    return int(np.argmax(pulled.force[: fallen + 1]))


def _at_the_end(problem: Problem, curve: Curve) -> NDArray[np.bool_]:
    """Return whether the rest of a joint at each step (steps,) is shorter than the reach of its front."""
    adhesion = problem.adhesion
    length = problem.body.shape.boundary(adhesion.side).length()
    left = length * (adhesion.end - adhesion.start) - opened(problem, curve)
    ends: NDArray[np.bool_] = left < reach_behind(problem, _height(problem))
    return ends


def _height(problem: Problem) -> float:
    """Return the mean thickness of the body."""
    shape = problem.body.shape
    return shape.area() / shape.boundary(problem.adhesion.side).length()


def pull_off(problem: Problem, curve: Curve) -> int | None:
    """Return the step of the largest tension of a body that is pulled off; None where none is."""
    pulled = forces(curve)
    if pulled is None or drive_test(problem, curve) != "pull":
        return None
    tension = pulled.force * np.sign(_away(problem))
    moved = np.diff(pulled.displacement) * np.sign(_away(problem))
    step = int(np.argmax(tension))
    # a body that snaps into contact is pulled while it approaches; the largest tension may be at the last
    # step
    return step if tension[step] > 0 and 0 < step < len(curve) - 1 and moved[step] > 0 else None


def _pull(problem: Problem, curve: Curve, pulled: Forces) -> list[Reading]:
    tension = pulled.force * np.sign(_away(problem))
    readings = []
    if tension.max() > 0:
        step = int(np.argmax(tension))
        comes_off = pull_off(problem, curve) is not None
        words = "tension, away from the substrate"
        if 0 < step == len(curve) - 1:
            words += "; it increases until the end of the run"
        elif step < len(curve) - 1 and not comes_off:
            words += ", while the body approaches the substrate"
        name = "pull-off force" if comes_off else "largest tension"
        readings.append(
            Reading(name, float(tension[step]), "force", float(curve.parameter[step]), words=words)
        )
    if tension.min() < -0.01 * max(float(tension.max()), 0.0):
        step = int(np.argmin(tension))
        value, at = float(-tension[step]), float(curve.parameter[step])
        readings.append(Reading("largest push", value, "force", at, words="towards the substrate"))
    return readings


def largest(curve: Curve) -> Reading:
    """Return the largest reaction of a curve of one step or more."""
    step = int(np.argmax(np.abs(curve.reaction)))
    kind, name = kind_of(curve.reaction_column), f"largest {curve.reaction_column.name}"
    return Reading(name, float(curve.reaction[step]), kind, float(curve.parameter[step]))


def _largest_force(curve: Curve, pulled: Forces) -> Reading:
    step = int(np.argmax(np.abs(pulled.force)))
    return Reading("largest force", float(pulled.force[step]), "force", float(curve.parameter[step]))


def _opened(problem: Problem, curve: Curve, pulled: Forces, arm: str) -> list[Reading]:
    lift, force = float(pulled.displacement[-1]), float(pulled.force[-1])
    name, at = f"force{arm} at the end", float(curve.parameter[-1])
    form = opening(problem, lift, force)
    if form is None or isinstance(form, str):
        words = f"no closed form: {form}" if form else ""
        return [Reading(name, force, "force", at, words=words)]
    readings = [Reading(name, force, "force", at, form.force, "elastica")]
    if form.by_compliance is not None:
        words = "arm clamped at its front, (3 E'I d/F)^(1/3)"
        name = "effective crack length"
        readings.append(
            Reading(name, form.by_compliance, "length", None, form.crack_length, "beam theory", words)
        )
    return readings


def buckled(curve: Curve) -> list[Reading]:
    """Return the force or moment at the first bifurcation that the path passed."""
    pulled = forces(curve)
    steps = np.flatnonzero(curve.kind == KINDS.index("bifurcation"))
    if not len(steps):
        return []
    values, name = (curve.reaction, curve.reaction_column.name) if pulled is None else (pulled.force, "force")
    kind = kind_of(curve.reaction_column) if pulled is None else "force"
    at = float(curve.parameter[steps[0]])
    return [Reading(f"buckling {name}", float(values[steps[0]]), kind, at, words="at the bifurcation")]


def cracks(curve: Curve, found: Fronts, of: str = "", start: str = "the loaded end") -> list[Reading]:
    """Return crack length and process zone at the last step, with a name that ends with `of`."""
    if not found or max(found) != len(curve) - 1:
        return []
    front = found[max(found)]
    words = "where the traction exceeds half of its peak"
    zone = Reading(f"process zone{of}", front.zone.length, "length", words=words)
    if front.crack_length is None:
        return [zone]
    words = f"from {start} to the largest traction"
    return [Reading(f"crack length{of}", front.crack_length, "length", words=words), zone]


def fronts_at_the_end(curve: Curve, found: Fronts, of: str) -> list[Reading]:
    """Return the front of one of several interfaces at the last step: its place, traction and lengths."""
    readings = cracks(curve, found, of, "the open end")
    if not readings:
        return []
    zone, words = found[max(found)].zone, "along the side at rest, from where its parameter begins"
    return [
        Reading(f"front{of}", zone.position, "length", words=words),
        Reading(f"largest traction{of}", zone.peak, "stress", words="at the front"),
        *readings,
    ]


def _away(problem: Problem) -> float:
    """Return the cosine of the angle of the load to the outward normal where the joint begins."""
    adhesion, drive = problem.adhesion, problem.drive
    place = problem.body.shape.boundary(adhesion.side).evaluate([adhesion.start])
    _, normal, _ = evaluate_substrate(adhesion.substrate.kernel, adhesion.substrate.parameters, place)
    direction = drive.direction if isinstance(drive, Load) else drive.rate(np.zeros((1, 2)), 0.0)[0]
    return float(direction @ normal[0])


def _straight_up(problem: Problem, side: Side) -> bool:
    """Return whether a side is a straight line along y."""
    places = problem.body.shape.boundary(side).evaluate(np.linspace(0.0, 1.0, 5))
    return bool(np.ptp(places[:, 0]) <= 1e-9 * np.ptp(places[:, 1]))
