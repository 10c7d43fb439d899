"""Export a stored run as files for ParaView."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from rich.console import Console

from isopeel.common.errors import InputError
from isopeel.post.grids import body_grids, body_mesh, side_grids, side_mesh
from isopeel.results.vtk import Grid, Part, write_grid, write_series
from isopeel.running.folder import EXPORTED, check_overwritten, make_folder, part_of_name
from isopeel.running.run_reader import StoredStage, read_stages

#: Most straight cells of an element in each direction; for each element and state, their square is written.
MOST_PIECES = 20

_BODY, _SIDE = "body", "adhesive-side"


def export_run(
    folder: Path, out: Path | None, linear: int | None, console: Console, *, force: bool = False
) -> None:
    """Write the stored fields of the run in a folder as series of grids, for ParaView and other readers.

    They are written to `out`, by default to `paraview` beside the file of the run; a case of several stages
    has a folder for each stage with fields. The time of a series, `body.pvd` or `adhesive-side.pvd`, is the
    parameter of the drive in the unit of its column; if the path turns back, it is the number of the step.
    If there are several bodies or interfaces, each has its own files, and is a part of the series. Cells are
    Bezier cells, or `linear` straight cells per element and direction. Files of an earlier export are
    replaced. Raises InputError if the folder has no run with a field, or if `out` cannot be written, and
    OSError if a file cannot be written.
    """
    if linear is not None and not 1 <= linear <= MOST_PIECES:
        raise InputError("--linear", linear, f"it must be from 1 to {MOST_PIECES} cells per direction")
    stages = read_stages(folder)
    if not any(stage.run.states for stage in stages):
        raise InputError("DIR", str(folder), "its run has no converged step yet")
    for stage in stages:
        run = stage.run
        if run.states:
            place = stage.folder / "paraview" if out is None else out
            if out is not None and len(stages) > 1:
                place = out / stage.folder.name
            known = [path for path in place.glob("*") if EXPORTED.fullmatch(path.name)]
            check_overwritten("--out", known, force)
            removed = _export(stage, place, linear)
            last = stage.laboratory.parameter(run.curve.parameter_column, run.states[-1].parameter)
            suffix = "" if run.ending == "completed" else f" (the run {_ENDINGS[run.ending]})"
            states = f"{len(run.states)} states, to {last}{suffix}"
            side = f" and {_SIDE}.pvd" if stage.stage.problem.interfaces else ""
            console.print(f"{states}: {place / _BODY}.pvd{side}", soft_wrap=True)
            if removed:
                console.print(f"removed {', '.join(map(str, removed))}", soft_wrap=True)


_ENDINGS = {
    "running": "is still running, or was killed",
    "interrupted": "was interrupted",
    "not converged": "found no equilibrium beyond",
}


def _export(stage: StoredStage, out: Path, linear: int | None) -> list[Path]:
    """Write the files of a stage, and return those of an earlier export that are removed."""
    run, case = stage.run, stage.case
    make_folder(out)
    parameter = run.curve.parameter_column
    times, words = [state.parameter for state in run.states], f"{parameter.name} [{parameter.unit}]"
    rise = np.sign(np.diff(times))
    if np.ptp(rise) > 0 or not rise.all():
        times, words = [float(state.step) for state in run.states], "step"
    notes = {"case": case.name, "L0": case.units.length, "E0": case.units.stress, "time": words}
    removed = []
    for kind, series in ((_BODY, _body_series(stage, linear)), (_SIDE, _side_series(stage, linear))):
        written: list[Part] = []
        for number, (name, grids) in enumerate(series.items()):
            prefix, part = kind, {}
            if len(series) > 1:
                prefix, part = f"{kind}-{part_of_name(name, list(series))}", {"part": name}
            for state, (time, grid) in enumerate(zip(times, grids, strict=True)):
                file = f"{prefix}-{state:04d}.vtu"
                write_grid(out / file, grid, time, notes | part)
                written.append(Part(file, time, number))
        if series:
            write_series(out / f"{kind}.pvd", written)
        # files of an earlier run with more states
        files = {part.file for part in written}
        for old in sorted(out.glob(f"{kind}-*.vtu")):
            if old.name not in files and EXPORTED.fullmatch(old.name):
                old.unlink()
                removed.append(old)
    return removed


def _body_series(stage: StoredStage, linear: int | None) -> Mapping[str, Iterator[Grid]]:
    """Return the grids of all states of each body."""
    problem, space, states = stage.stage.problem, stage.spaces, stage.run.states
    return {
        body.name: body_grids(problem, space, body_mesh(problem, space, linear, body.name), states, body.name)
        for body in problem.bodies
    }


def _side_series(stage: StoredStage, linear: int | None) -> Mapping[str, Iterator[Grid]]:
    """Return the grids of all states of each interface."""
    problem, space, states = stage.stage.problem, stage.spaces, stage.run.states
    return {
        name: side_grids(problem, space, side_mesh(problem, space, linear, name), states, name)
        for name in problem.interface_names
    }
