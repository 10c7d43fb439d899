"""Export a stored run as files for ParaView."""

import re
from pathlib import Path

from rich.console import Console

from isopeel.common.errors import InputError
from isopeel.post.grids import body_grids, body_mesh, side_grids, side_mesh
from isopeel.results.vtk import write_grid, write_series
from isopeel.running.folder import EXPORTED, check_overwritten, make_folder
from isopeel.running.run_reader import StoredStage, read_stages

#: Most straight cells of an element each way; the square of them is written for each element and state.
MOST_PIECES = 20

_BODY, _SIDE = "body", "adhesive-side"


def export_run(
    folder: Path, out: Path | None, linear: int | None, console: Console, *, force: bool = False
) -> None:
    """Write the stored fields of the run in a folder as series of grids, for ParaView and other readers.

    They are written to `out`, by default to `paraview` beside the file of the run; a case of several stages
    has a folder for each stage with fields. The time of a series, `body.pvd` or `adhesive-side.pvd`, is the
    drive's parameter in its shown unit. Cells are Bezier cells, or elements cut into `linear` straight cells
    each way. Files of an earlier export are replaced. Raises InputError where the folder holds no run with a
    field, or `out` cannot be written, and OSError where a file cannot be written.
    """
    if linear is not None and not 1 <= linear <= MOST_PIECES:
        raise InputError("--linear", linear, f"an element is cut into 1 to {MOST_PIECES} each way")
    stages = read_stages(folder)
    if not any(stage.run.fields for stage in stages):
        raise InputError("DIR", str(folder), "a run with a converged step is needed, and it has none yet")
    for stage in stages:
        run = stage.run
        if run.fields:
            place = stage.folder / "paraview" if out is None else out
            if out is not None and len(stages) > 1:
                place = out / stage.folder.name
            known = [path for path in place.glob("*") if EXPORTED.fullmatch(path.name)]
            check_overwritten("--out", known, force)
            removed = _export(stage, place, linear)
            unit = run.curve.parameter_column.unit
            suffix = "" if run.ending == "completed" else f" (the run {_ENDINGS[run.ending]})"
            states = f"{len(run.fields)} states, to {list(run.fields)[-1]:g} {unit}{suffix}"
            console.print(f"{states}: {place / _BODY}.pvd and {_SIDE}.pvd", soft_wrap=True)
            if removed:
                console.print(f"removed {', '.join(map(str, removed))}", soft_wrap=True)


_ENDINGS = {
    "running": "is still running, or was killed",
    "interrupted": "was interrupted",
    "not converged": "found no equilibrium beyond",
}


def _export(stage: StoredStage, out: Path, linear: int | None) -> list[Path]:
    """Write the files of a stage, and return those of an earlier export that are removed."""
    run, case, space = stage.run, stage.case, stage.space
    problem = stage.stage.problem
    make_folder(out)
    parameter = run.curve.parameter_column
    notes = {
        "case": case.name,
        "L0": case.units.length,
        "E0": case.units.stress,
        "time": f"{parameter.name} [{parameter.unit}]",
    }
    states, maximum_openings = list(run.fields.values()), [run.maximum_openings.get(at) for at in run.fields]
    body = body_grids(problem, space, body_mesh(problem, space, linear), states)
    side = side_grids(problem, space, side_mesh(problem, space, linear), states, maximum_openings)
    times: dict[str, dict[str, float]] = {_BODY: {}, _SIDE: {}}
    for number, (time, *grids) in enumerate(zip(run.fields, body, side, strict=True)):
        for name, grid in zip(times, grids, strict=True):
            file = f"{name}-{number:04d}.vtu"
            write_grid(out / file, grid, time, notes)
            times[name][file] = time
    removed = []
    for name, written in times.items():
        write_series(out / f"{name}.pvd", written)
        # files of an earlier run with more states
        for old in sorted(out.glob(f"{name}-*.vtu")):
            if old.name not in written and re.fullmatch(rf"{name}-\d{{4,}}\.vtu", old.name):
                old.unlink()
                removed.append(old)
    return removed
