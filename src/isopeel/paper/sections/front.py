"""Tractions at the front, and the length over which they act, compared with the size of an element."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from isopeel.paper.figures import front_figure
from isopeel.paper.figures.front import MEGAPASCAL
from isopeel.paper.record import FRONT_DEG
from isopeel.paper.results import Results
from isopeel.paper.study import LENGTH, MESHES, SPACES, Run, table_runs
from isopeel.post.front import beam_decay, front_profile, layer_decay
from isopeel.problem import strip
from isopeel.report.document import Block, Picture, Table, Text
from isopeel.report.wording import digits, number

TITLE = "Why the moment oscillates"
_MESH = "m2"
_SHOWN = ("L1", "L2", "N2.1", "L4")  # from the coarsest to the finest
_SIZE = LENGTH / MESHES[_MESH][0]  # of an element along the strip, in L0 = 1 nm


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return the published spaces on m2, where all of them reach the plateau."""
    return table_runs([_MESH]) if _MESH in meshes else []


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield the lengths and the traction of all spaces, and one picture; nothing without its mesh."""
    fronts = {space: results.records[Run(space, _MESH)].front for space in SPACES} if runs(meshes) else {}
    finest = fronts.get(_SHOWN[-1])
    if finest is None:
        return
    layer, beam = layer_decay(strip()), beam_decay(strip())
    assert layer is not None  # it is a strip
    assert beam is not None
    yield Text(
        f"The attraction exceeds half of its peak over {finest.process_zone:.2f} nm, which is "
        f"{finest.process_zone / _SIZE:.1f} elements of {_MESH}: {{front}}. A coarse space approximates this "
        "peak with an error that depends on the place of the front in its element. So the moment rises and "
        "falls once while the front passes an element. {front-lengths} shows that most spaces oscillate less "
        f"if their traction is closer to that of the finest space, {_SHOWN[-1]}. In the part that still "
        f"adheres, the traction changes its sign every {finest.half_wave:.1f} nm. This agrees with an "
        f"elastic layer on springs ({layer.wavelength / 2:.1f} nm), but not with a beam on springs "
        f"({beam.wavelength / 2:.1f} nm)."
    )
    rows = []
    for space, front in fronts.items():
        figures = results.figures(Run(space, _MESH))
        off = None
        if front is not None:
            there = np.interp(front.position, finest.position, finest.traction)
            off = MEGAPASCAL * float(np.abs(front.traction - there).max())
        rows.append(
            (
                space,
                number(None if front is None else front.process_zone),
                number(off, 2),
                number(None if front is None else MEGAPASCAL * front.jump, 2),
                digits(None if figures is None else figures.amplitude),
            )
        )
    yield Table(
        "front-lengths",
        f"At {FRONT_DEG:g} degrees on {_MESH}: the length over which the attraction exceeds half of its "
        f"peak; the largest difference of the adhesive traction from that of {_SHOWN[-1]}; the largest jump "
        "of the traction in the body between elements; and dM.",
        ("space", "process zone / nm", "difference / MPa", "jump / MPa", "dM x 1e3"),
        tuple(rows),
    )

    def draw() -> Figure:
        profiles = {}
        for run in (Run(space, _MESH) for space in _SHOWN):
            case, state = run.case, results.stored(run).nearest(FRONT_DEG)
            profiles[run.space] = front_profile(case.problem(), case.space(), state.displacement)
        return front_figure(profiles, _SIZE)

    yield Picture(
        "front",
        f"Tension at the front on {_MESH} at {FRONT_DEG:g} degrees, of the adhesion and in the body; E0 = 2 "
        "GPa.",
        draw,
    )
