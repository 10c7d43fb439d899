"""What flows to the front of an interface in states of a run, and its readings."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple, TypeAlias

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.physics.joints import JointLaw
from isopeel.post.contour import Contours, JIntegral, flow_through
from isopeel.post.laboratory import Kind
from isopeel.post.mode_ratio import ModeRates, rates_at
from isopeel.post.readings import Reading
from isopeel.problem import Problem
from isopeel.results.fields import StoredState

#: Share of the J-integral that is named where the contour does not enclose it.
_NAMED = 1e-3


class FrontFlow(NamedTuple):
    """What flows to a front in one state: J, and its shares of opening and sliding if they are given."""

    j: JIntegral
    rates: ModeRates | None


#: What flows to the front of one interface, by the numbers of the steps whose states have one.
FrontFlows: TypeAlias = Mapping[int, FrontFlow]


def front_flows(
    problem: Problem, space: SpaceOfBodies, states: Iterable[StoredState], interface: str = ""
) -> dict[int, FrontFlow]:
    """Return what flows to the front of an interface in states, by the numbers of their steps.

    States where the J-integral is not given are left out. Of several interfaces one is chosen by its name.
    """
    contours, found = Contours(problem, space, interface), {}
    for state in states:
        contour = contours.around(state)
        if isinstance(contour, str):
            continue
        rates = rates_at(problem, space, state.displacement, contour, interface)
        given = None if isinstance(rates, str) or not rates.ratio >= 0 else rates
        found[state.step] = FrontFlow(flow_through(problem, space, state.displacement, contour), given)
    return found


def flow_columns(found: FrontFlows) -> list[tuple[str, Kind, dict[int, float]]]:
    """Return the name, kind and values by the numbers of their steps of each column that has values."""
    rates = {step: flow.rates for step, flow in found.items() if flow.rates is not None}
    columns: list[tuple[str, Kind, dict[int, float]]] = [
        ("J_integral", "toughness", {step: flow.j.value for step, flow in found.items()}),
        ("G_I", "toughness", {step: one.opening for step, one in rates.items()}),
        ("G_II", "toughness", {step: one.sliding for step, one in rates.items()}),
        ("mode_ratio", "number", {step: one.ratio for step, one in rates.items()}),
    ]
    return [column for column in columns if column[2]]


def front_readings(problem: Problem, flow: FrontFlow, interface: str) -> list[Reading]:
    """Return the J-integral and the mode ratio of a front, if given."""
    found, rates = flow
    law = problem.interface_of(interface).law
    of = f", {interface}" if sum(one.adheres for one in problem.interfaces) > 1 else ""
    words = "by sections of the bodies"
    if found.neglected > _NAMED * found.value:
        words += f"; {100 * found.neglected / found.value:.3g} % more lies beyond them"
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
    if rates is None:
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
