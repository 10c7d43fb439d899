"""The places of the bodies of a case: each where its keys put it, or on a side of another body."""

from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

from isopeel.case.bodies import BodyTable, PlacedBody
from isopeel.case.boundaries import split_boundary
from isopeel.case.errors import named_by
from isopeel.case.interfaces import InterfaceTable, inward_normal
from isopeel.common.errors import InputError
from isopeel.problem.place import placed, reach
from isopeel.splines.nurbs import Side


def placed_bodies(tables: Sequence[BodyTable], interfaces: Sequence[InterfaceTable]) -> dict[str, PlacedBody]:
    """Build the bodies by their names, in their order.

    Raises InputError where two share a name, or where one cannot be placed on the side that it names.
    """
    bodies: dict[str, PlacedBody] = {}
    for number, table in enumerate(tables, start=1):
        if table.name in bodies:
            raise InputError(f"body.{number}.name", table.name, "each body needs a name of its own")
        bodies[table.name] = table.placed(f"body.{number}")
    waiting = {table.name: number for number, table in enumerate(tables, start=1) if table.on is not None}
    while waiting:
        ready = [name for name, number in waiting.items() if _carrier(tables[number - 1]) not in waiting]
        if not ready:
            name, number = next(iter(waiting.items()))
            allowed = "a body lies on another one, and not in a circle; place one of them by `at` alone"
            raise InputError(f"body.{number}.on", tables[number - 1].on, allowed)
        for name in ready:
            number = waiting.pop(name)
            bodies[name] = _on_a_side(f"body.{number}", tables[number - 1], bodies, interfaces)
    return bodies


def _carrier(table: BodyTable) -> str:
    return str(table.on).rpartition(".")[0]


def _on_a_side(
    key: str, table: BodyTable, bodies: dict[str, PlacedBody], interfaces: Sequence[InterfaceTable]
) -> PlacedBody:
    """Move a body along the outward normal of a straight side, until their smallest distance is the gap."""
    carrier, side = split_boundary(f"{key}.on", str(table.on), list(bodies))
    shape, body = bodies[table.name]
    edge = bodies[carrier].body.shape.boundary(side)
    inward = inward_normal(edge, side)
    if inward is None:
        raise InputError(f"{key}.on", table.on, "it must be a straight side; place the body by `at` alone")
    gap = _equilibrium_gap(key, table, interfaces) if table.gap is None else table.gap
    nearest = max(reach(body.shape.boundary(own), inward) for own in get_args(Side))
    move = (nearest - float(edge.control_points[0] @ inward) + gap) * -inward
    moved = placed(body.shape, (float(move[0]), float(move[1])), 0.0)
    return PlacedBody(shape, replace(body, shape=moved))


def _equilibrium_gap(key: str, table: BodyTable, interfaces: Sequence[InterfaceTable]) -> float:
    """Return the equilibrium gap of the interface between a body and the side that it lies on, or zero."""
    gaps = set()
    for number, interface in enumerate(interfaces, start=1):
        others = [name.rpartition(".")[0] for name in interface.names if name != table.on]
        if table.on in interface.names and others == [table.name]:
            with named_by({"adhesion": f"interface.{number}"}):
                gaps.add(interface.adhesion_law().equilibrium_gap)
    if len(gaps) > 1:
        allowed = "the key is missing: the interfaces on this side have different equilibrium gaps"
        raise InputError(f"{key}.gap", None, allowed)
    return gaps.pop() if gaps else 0.0
