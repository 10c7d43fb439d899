"""The content of the HTML page of a stage, as numbers and texts for its script."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np

from isopeel.assembly.spaces import spaces_by_name
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.html_report.packing import packed, packed_positions, packed_stress
from isopeel.html_report.region import substrate_region
from isopeel.post.fields import SampledFields
from isopeel.post.figures.reaction import is_reached, unstable_pieces, widest_turn
from isopeel.post.findings import Findings
from isopeel.post.front import FrontProfile, front_profile
from isopeel.post.laboratory import Laboratory
from isopeel.post.law import law_character
from isopeel.post.shown import Shown, in_laboratory
from isopeel.post.states import (
    SMOOTH,
    DrawnState,
    Face,
    Window,
    adhering_names,
    drawn_state,
    front_window,
    hatched,
    stress_scale,
    substrates,
    whole_window,
)
from isopeel.problem import Column, Problem
from isopeel.results.curve import Curve
from isopeel.results.fields import StoredState
from isopeel.running.run_reader import StoredStage
from isopeel.solve.step import KINDS

_DOTS = 8_000  # steps of positions across the front: more than the pixels of a screen
_ALONG_SIDE = 400  # segments of the adhering face
_TRACTIONS = 1_200  # approximate number of points along it

#: A value that JSON can contain.
Content = dict[str, Any]


def stage_content(stored: StoredStage, found: Findings, most_bytes: int) -> Content:
    """Return the content of the page of a stage with steps; its states need about `most_bytes` at most.

    If all stored states need more, some of them are left out, at equal intervals.
    """
    run, problem = stored.run, stored.stage.problem
    shown = in_laboratory(run.curve, found)
    last = _drawn(stored, run.states[-1])
    most = max(2, most_bytes // _size(stored, run.states[-1], last))
    kept: Sequence[StoredState] = run.states
    if len(kept) > most:
        chosen = np.unique(np.linspace(0, len(kept) - 1, most).round().astype(int))
        kept = [kept[k] for k in chosen.tolist()]
    drawn = [*(_drawn(stored, state) for state in kept[:-1]), last]
    scale, window = stress_scale(drawn), whole_window(drawn)
    fronts = [_fronts(problem, state) for state in drawn]
    around = _around([window, *(front for one in fronts for front in one.values())])
    regions = [substrate_region(substrate, around) for substrate in substrates(problem)]
    return {
        "title": stored.title,
        "units": _units(found.laboratory, problem),
        "curve": _curve(shown.curve, found.laboratory),
        "views": _views(shown),
        "theory": _theory(shown),
        "window": shown.plateau and list(shown.plateau.window),
        "scale": scale,
        "grids": [_grid(fields) for fields in last.bodies.values()],
        "whole": [*window.x, *window.y],
        "hatched": hatched(problem),
        "substrates": [{"rings": rings, "surface": surface} for rings, surface in regions],
        "sides": [_side(stored, last, name) for name in last.faces],
        "stored": len(run.states),
        "states": [_shown_state(stored, *one, scale) for one in zip(kept, drawn, fronts, strict=True)],
    }


def plain(text: str) -> str:
    """Return words and units of a column without marks of mathematical type: E0 L0^3 becomes E₀ L₀³."""
    text = text.replace("$", "")
    text = re.sub(r"(?<=\b[A-Z])0", "₀", text).replace("^2", "²").replace("^3", "³")
    return re.sub(r"^degree$", "°", text)


def column_words(column: Column) -> dict[str, str]:
    """Return the texts of a column for a page: its name, symbol and unit."""
    symbol = re.search(r"\$(.+)\$", column.words)
    return {
        "words": plain(column.words or column.name),
        "symbol": symbol[1] if symbol else column.name.removesuffix("_deg"),
        "unit": plain(column.unit),
    }


def _drawn(stored: StoredStage, state: StoredState) -> DrawnState:
    # on a graded mesh small elements have no more cells than large ones, to keep the page small
    problem = stored.stage.problem
    cells = {}
    for name, space in spaces_by_name(problem, stored.spaces).items():
        along, across = (ceil(smooth / count) for smooth, count in zip(SMOOTH, space.elements, strict=True))
        cells[name] = along, across
    drawn = drawn_state(problem, stored.spaces, state, cells)
    return replace(drawn, faces={name: drawn.faces[name] for name in adhering_names(problem)})


def _fronts(problem: Problem, state: DrawnState) -> dict[str, Window]:
    return {name: front_window(problem, state, name) for name in state.faces}


def _size(stored: StoredStage, state: StoredState, drawn: DrawnState) -> int:
    """Return the number of bytes of a state in the page."""
    fronts = _fronts(stored.stage.problem, drawn)
    return len(json.dumps(_shown_state(stored, state, drawn, fronts, 1.0)))


def _units(laboratory: Laboratory, problem: Problem) -> Content:
    """Return the units of the drawn quantities of the bodies, and the factors from values in the page."""
    # the tension of the adhesion is of the order of W over the opening, or of the strength if it is known
    try:
        strengths = [law_character(interface.law).strength for interface in problem.faces]
    except InputError:
        strengths = []
    strength = max(strengths or [body.material.youngs_modulus for body in problem.bodies])
    found = {"length": laboratory.unit("length"), "stress": laboratory.unit("stress", strength)}
    return {name: {"name": plain(unit.name), "factor": unit.factor} for name, unit in found.items()}


def _curve(curve: Curve, laboratory: Laboratory) -> Content:
    energy = laboratory.unit("energy")
    pieces = np.zeros(len(curve), dtype=np.int64)
    pieces[1:] = unstable_pieces(curve)
    pieces[curve.kind == KINDS.index("jump")] = 2
    return {
        "parameter": column_words(curve.parameter_column) | {"values": packed(curve.parameter, "f8")},
        "reaction": column_words(curve.reaction_column) | {"values": packed(curve.reaction, "f8")},
        "iterations": packed(curve.iterations, "i4"),
        "stored_energy": packed(curve.stored_energy * energy.factor, "f4"),
        "adhesive_energy": packed(curve.adhesive_energy * energy.factor, "f4"),
        "released_energy": packed(curve.released_energy * energy.factor, "f4"),
        "energy_unit": energy.name,
        "kind": packed(curve.kind, "u1"),
        "pieces": packed(pieces, "u1"),  # before each step: stable, unstable, jumped
        "kinds": list(KINDS),
    }


def _views(found: Shown) -> list[Content]:
    """Return the views of the curve: the whole curve, and the enlarged parts."""
    curve = found.curve
    values = curve.reaction
    low, high = float(values.min()), float(values.max())
    if found.closed_form is not None and is_reached(found.closed_form, curve):
        low, high = min(0.0, low), max(high, found.closed_form.reaction)
    first, last = float(curve.parameter.min()), float(curve.parameter.max())
    # with margins for marks at the ends, and for the label of theory
    views = [{"name": "whole", "x": _wider(first, last, 0.02), "y": _wider(low, high, 0.1)}]
    if found.plateau is not None:
        start, end = _wider(*found.plateau.window, 0.15)
        inside = values[(curve.parameter >= start) & (curve.parameter <= end)]
        y = _wider(float(inside.min()), float(inside.max()), 0.1)
        views.append({"name": "plateau", "x": [start, end], "y": y})
    turn = widest_turn(curve)
    if turn is not None:
        x, y = (
            _wider(float(ends.min()), float(ends.max()), share)
            for ends, share in ((curve.parameter[list(turn)], 1.0), (values[list(turn)], 0.6))
        )
        views.append({"name": "widest snap-back", "x": x, "y": y})
    return views


def _wider(low: float, high: float, share: float) -> list[float]:
    """Return an interval with margins on both sides, a share of its length."""
    # a run of one step, or a constant
    margin = share * (high - low) or max(abs(high), 1.0) * share
    return [low - margin, high + margin]


def _theory(found: Shown) -> Content | None:
    curve, closed_form = found.curve, found.closed_form
    if closed_form is None or not is_reached(closed_form, curve):
        return None
    return {"source": closed_form.source, "reaction": closed_form.reaction, "onset": closed_form.onset}


def _around(windows: list[Window]) -> Window:
    """Return a window around windows, large enough for pictures up to three times as wide."""
    x, y = (np.array([getattr(window, axis) for window in windows]) for axis in "xy")
    size = max(float(np.ptp(x)), float(np.ptp(y)))
    wider = ((x, 1.0 * size), (y, 0.5 * size))
    return Window(*((float(ends.min()) - more, float(ends.max()) + more) for ends, more in wider))


def _grid(fields: SampledFields) -> list[int]:
    """Return the numbers of elements per direction, and of cells in each element."""
    elements_x, elements_y, nodes_x, nodes_y = fields.first_invariant.shape
    return [elements_x, elements_y, nodes_x - 1, nodes_y - 1]


def _nodes(fields: SampledFields) -> FloatArray:
    """Return the positions (m, k, 2) of the nodes of all cells, shared nodes once."""
    elements_x, elements_y, a, b = _grid(fields)
    nodes = np.empty((elements_x * a + 1, elements_y * b + 1, 2))
    for k in range(a + 1):
        for m in range(b + 1):
            nodes[k : k + (elements_x - 1) * a + 1 : a, m : m + (elements_y - 1) * b + 1 : b] = (
                fields.position[:, :, k, m]
            )
    return nodes


def _profile(stored: StoredStage, state: StoredState, name: str) -> FrontProfile:
    """Return the tractions on an interface at the points of the page."""
    problem, space = stored.stage.problem, stored.spaces
    boundary = problem.interface_of(name).boundary
    knots = spaces_by_name(problem, space)[boundary.body].rows[0].breakpoints
    elements = sum(end > boundary.start and start < boundary.end for start, end in pairwise(knots))
    points = np.linspace(0.0, 1.0, min(17, max(3, ceil(_TRACTIONS / elements) + 1)))
    return front_profile(problem, space, state.displacement, points, state.maximum_openings, name)


def _side(stored: StoredStage, drawn: DrawnState, name: str) -> Content:
    """Return the positions along an adhering face at which tractions are given."""
    state = stored.run.states[-1]
    profile = _profile(stored, state, name)
    at_rest = state._replace(displacement=np.zeros_like(state.displacement))
    cells = dict.fromkeys(drawn.bodies, (1, 1))
    rest = drawn_state(stored.stage.problem, stored.spaces, at_rest, cells).faces[name].position
    chords = np.linalg.norm(np.diff(rest, axis=0), axis=1)
    # places on the undeformed face of the points of the deformed face
    places = profile.position[0, 0] + np.append(0.0, np.cumsum(chords))[_along_face(rest)]
    problem = stored.stage.problem
    every = substrates(problem)
    return {
        "name": name,
        "substrates": [every.index(one) for one in substrates(problem, name)],  # that attract its body
        "position": packed(profile.position, "f4"),
        "points": profile.position.shape[1],
        "places": packed(places, "f4"),
    }


def _along_face(adhering: FloatArray) -> IntArray:
    """Return the indices of the points of the adhering face that are in the page."""
    return np.linspace(0, len(adhering) - 1, _ALONG_SIDE + 1).round().astype(np.int64)


def _shown_state(
    stored: StoredStage, state: StoredState, drawn: DrawnState, fronts: Mapping[str, Window], scale: float
) -> Content:
    # without an interface, the resolution is that of the whole picture
    widths = [front.x[1] - front.x[0] for front in fronts.values()]
    resolution = (min(widths) if widths else np.ptp(whole_window([drawn]).x)) / _DOTS
    return {
        "step": state.step,
        "bodies": [
            {
                "nodes": packed_positions(_nodes(fields), resolution),
                "stress": packed_stress(fields.first_invariant, scale),
            }
            for fields in drawn.bodies.values()
        ],
        "faces": [_shown_face(stored, state, name, face, fronts[name]) for name, face in drawn.faces.items()],
        "residuals": [float(f"{value:.2e}") for value in stored.run.curve.residuals_of(state.step).tolist()],
    }


def _shown_face(stored: StoredStage, state: StoredState, name: str, face: Face, front: Window) -> Content:
    profile, position = _profile(stored, state, name), face.position
    resolution = (front.x[1] - front.x[0]) / _DOTS
    return {
        "adhering": packed_positions(position[_along_face(position)][:, None], resolution),
        "front": [*front.x, *front.y],
        # tension, positive where the substrate holds the body
        "adhesion": packed(-profile.adhesive_traction, "f4"),
        "body": packed(-profile.body_traction, "f4"),
    }
