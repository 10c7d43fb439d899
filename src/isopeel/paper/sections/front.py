"""Tractions at the front, and the length over which they act beside the size of an element."""

from collections.abc import Iterator, Sequence

from matplotlib.figure import Figure

from isopeel.paper.document import Block, Picture, Table, Text
from isopeel.paper.figures import front_figure
from isopeel.paper.record import FRONT_DEG
from isopeel.paper.results import Results
from isopeel.paper.study import MESHES, SPACES, Run, table_runs
from isopeel.paper.wording import ABSENT, digits
from isopeel.post.front import front_profile, layer_decay
from isopeel.problem import strip

TITLE = "Why the moment oscillates"
_MESH = "m2"
_SHOWN = ("L1", "L2", "N2.1", "L4")  # from the coarsest to the finest
_SIZE = 200.0 / MESHES[_MESH][0]  # of an element along the strip, in L0 = 1 nm
_MEGAPASCAL = 2000.0  # E0 = 2 GPa


def runs(meshes: Sequence[str]) -> list[Run]:
    """The published spaces on m2, where all of them reach the plateau."""
    return table_runs([_MESH]) if _MESH in meshes else []


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """The lengths and the jumps of all spaces, and one picture; nothing without its mesh."""
    if not runs(meshes):
        return
    finest = results.records[Run(_SHOWN[-1], _MESH)].front
    layer = layer_decay(strip())
    assert finest is not None  # it reaches the plateau
    assert layer is not None  # it is a strip
    yield Text(
        f"The attraction exceeds half its peak over {finest.process_zone:.2f} nm, which is "
        f"{finest.process_zone / _SIZE:.1f} elements of {_MESH}. While the front passes from one element to "
        "the next, the functions of a coarse space follow that peak now better, now worse, so that the "
        "moment rises and falls with the period of an element. The stress of the body balances the adhesion "
        "only on average: where functions are coarse and C0 it jumps from element to element, see {front}. "
        "Behind the front the stress dies out like that of an elastic layer on springs, by "
        f"{layer.length:.2f} nm for each factor e."
    )
    rows = []
    for space in SPACES:
        front = results.records[Run(space, _MESH)].front
        zone, jump = (None, None) if front is None else (front.process_zone, _MEGAPASCAL * front.jump)
        rows.append((space, digits(zone), digits(None if zone is None else zone / _SIZE), _jump(jump)))
    yield Table(
        "front-lengths",
        "Length over which the attraction exceeds half its peak, and the largest jump of the body's "
        f"traction between elements, at {FRONT_DEG:g} degrees on {_MESH}.",
        ("space", "process zone / nm", "in elements", "jump / MPa"),
        tuple(rows),
    )

    def draw() -> Figure:
        profiles = {}
        for run in (Run(space, _MESH) for space in _SHOWN):
            case, fields = run.case, results.stored(run).fields
            angle = min(fields, key=lambda angle: abs(angle - FRONT_DEG))
            profiles[run.space] = front_profile(case.problem(), case.space(), fields[angle])
        return front_figure(profiles, _SIZE)

    yield Picture(
        "front",
        f"Tension at the front on {_MESH} at {FRONT_DEG:g} degrees, of the adhesion and in the body; E0 = 2 "
        "GPa.",
        draw,
    )


def _jump(value: float | None) -> str:
    return ABSENT if value is None else f"{value:.2f}"
