"""Draw figures of a stored run: selected figures, at selected states, also in vector formats."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure
from rich.console import Console

from isopeel.common.errors import InputError
from isopeel.output.selection import chosen_states, shown_stages
from isopeel.post.figures import (
    front_figure,
    plateau_figure,
    reaction_figure,
    save,
    shapes_figure,
    tractions_figure,
)
from isopeel.post.figures.shapes import MOST_SHAPES, spread
from isopeel.post.findings import Findings
from isopeel.post.laboratory import Laboratory
from isopeel.post.plateau import unreadable
from isopeel.post.shown import Shown, in_laboratory
from isopeel.post.style import check_format
from isopeel.results.fields import StoredState
from isopeel.results.files import replacing
from isopeel.running.folder import FIGURES, check_overwritten, make_folder
from isopeel.running.run_reader import StoredStage


class _Shown(NamedTuple):
    """A stage, its findings, and the states to show, if they were chosen."""

    stored: StoredStage
    found: Findings
    chosen: list[StoredState]

    @property
    def units(self) -> Laboratory:
        return self.found.laboratory

    @property
    def read(self) -> Shown:
        return in_laboratory(self.stored.run.curve, self.found)


def plot_run(
    folder: Path,
    only: Sequence[str],
    at: Sequence[str],
    suffix: str,
    out: Path | None,
    console: Console,
    *,
    force: bool = False,
) -> None:
    """Draw figures of the run in a folder, by default all of PARTS, each to its own file.

    They are written to `out`, by default to the folder `figures` in that of the run; each of several stages
    has such a folder. The figures show the states `at` the parameters, by default some states along the run;
    the front is that of the last of them. Raises InputError if a figure, a parameter or a format is invalid,
    or if a requested figure cannot be drawn, and OSError if a file cannot be written.
    """
    check_format(suffix)
    for part in only:
        if part not in PARTS:
            raise InputError("--only", part, f"it must be one of {', '.join(PARTS)}")
    stages = shown_stages(folder)
    if at and len(stages) > 1:
        folders = ", ".join(str(stage.folder) for stage in stages)
        allowed = f"a parameter is that of one stage; give the folder of one stage: {folders}"
        raise InputError("--at", " ".join(at), allowed)
    for stage in stages:
        shown = _Shown(
            stage,
            stage.found(),
            chosen_states(stage, at, console),
        )
        into = stage.folder / FIGURES if out is None else out / stage.folder.relative_to(folder)
        check_overwritten("--out", [into / f"{part}.{suffix}" for part in only or PARTS], force)
        make_folder(into)
        for part in only or PARTS:
            draw = PARTS[part]
            if part == "plateau" and shown.found.plateau is None:
                reason = _unread(shown)
                if only and len(stages) == 1:
                    raise InputError("--only", part, reason)
                if only or shown.found.window is not None:
                    console.print(f"no {part} of {stage.title}: {reason}", soft_wrap=True)
                continue
            path = into / f"{part}.{suffix}"
            with replacing(path) as written:
                save(draw(shown), written)
            console.print(f"drawn in {path}", soft_wrap=True)


def _unread(shown: _Shown) -> str:
    found, curve = shown.found, shown.stored.run.curve
    if found.window is None:
        return "the case has no window for it, reading.window"
    reason = partial(found.laboratory.parameter, curve.parameter_column)
    return str(unreadable(curve, found.window, found.period, reason))


def _curve(shown: _Shown) -> Figure:
    curve, plateau, closed_form, _ = shown.read
    return reaction_figure(curve, plateau, closed_form)


def _plateau(shown: _Shown) -> Figure:
    curve, plateau, _, period = shown.read
    assert plateau is not None  # checked before
    return plateau_figure(curve, plateau, period)


def _shapes(shown: _Shown) -> Figure:
    stored, chosen = shown.stored, shown.chosen
    states = chosen or stored.run.states
    return shapes_figure(stored.stage.problem, stored.spaces, states, shown.units, every=bool(chosen))


def _front(shown: _Shown) -> Figure:
    stored = shown.stored
    last = (shown.chosen or stored.run.states)[-1]
    return front_figure(stored.stage.problem, stored.spaces, last, shown.units)


def _tractions(shown: _Shown) -> Figure:
    stored = shown.stored
    states = shown.chosen or spread(stored.run.states, MOST_SHAPES)
    return tractions_figure(stored.stage.problem, stored.spaces, states, shown.units)


#: The figures of a run, by the names of their files.
PARTS: dict[str, Callable[[_Shown], Figure]] = {
    "curve": _curve,
    "plateau": _plateau,
    "shapes": _shapes,
    "front": _front,
    "tractions": _tractions,
}
