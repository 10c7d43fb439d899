"""Readings of what flows to the front of an interface between two bodies."""

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.physics.joints import JointLaw
from isopeel.post.contour import j_integral
from isopeel.post.mode_ratio import mode_rates
from isopeel.post.readings import Reading
from isopeel.problem import Problem
from isopeel.results.fields import StoredState

#: Share of the J-integral that is named where the contour does not enclose it.
_NAMED = 1e-3


def front_readings(
    problem: Problem, space: SpaceOfBodies, state: StoredState, interface: str
) -> list[Reading]:
    """Return the J-integral and the mode ratio of the front of an interface in a state, if given."""
    law = problem.interface_of(interface).law
    of = f", {interface}" if len(problem.interfaces) > 1 else ""
    found = j_integral(problem, space, state, interface)
    if isinstance(found, str):
        return []
    words = "by sections of the bodies"
    if found.neglected > _NAMED * found.value:
        words += f"; {100 * found.neglected / found.value:.2g} % more lies beyond them"
    # the work of a joint law depends on the mode ratio
    flat = found.parted and not isinstance(law, JointLaw)
    readings = [
        Reading(
            f"J-integral{of}",
            found.value,
            "toughness",
            theory=law.work_of_adhesion if flat else None,
            source="W" if flat else "",
            words=words,
        )
    ]
    rates = mode_rates(problem, space, state, interface)
    if isinstance(rates, str) or not rates.ratio >= 0:
        return readings
    words = "by moments and tensions of equal arms at the front"
    share = (rates.opening + rates.sliding) / found.value
    of_j = f"this sum is {100 * share:.3g} % of the J-integral"
    return [
        *readings,
        Reading(f"G_I{of}", rates.opening, "toughness", words=f"opening, {words}"),
        Reading(f"G_II{of}", rates.sliding, "toughness", words=f"sliding, {words}"),
        Reading(
            f"mode ratio{of}",
            rates.ratio,
            "number",
            words=f"G_II/(G_I + G_II); {of_j}",
        ),
    ]
