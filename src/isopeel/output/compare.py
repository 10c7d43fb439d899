"""Compare stored runs: a table, a figure, and their differences."""

import csv
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Column, Table

from isopeel.common.errors import InputError
from isopeel.output.selection import shown_stage
from isopeel.post.comparison import Compared, comparison, difference
from isopeel.post.figures import comparison_figure, save
from isopeel.post.laboratory import short_unit
from isopeel.post.shown import in_laboratory
from isopeel.post.style import check_format
from isopeel.results.curve import Curve
from isopeel.results.files import replacing
from isopeel.running.folder import check_overwritten, make_folder
from isopeel.running.run_reader import StoredStage


def compare_runs(
    folders: Sequence[Path], suffix: str, out: Path, console: Console, *, force: bool = False
) -> None:
    """Print a table of the runs in folders, and write the table, a figure and the differences to a folder.

    The files are compare.csv, differences.csv (each run minus the first, at the parameters that both have)
    and compare with the suffix. Raises InputError for less than two folders, for a folder with no run or
    several stages, or for runs whose curves have different quantities; OSError if a file cannot be written.
    """
    check_format(suffix)
    if len(folders) < 2:
        raise InputError("DIR", " ".join(map(str, folders)), "two or more folders of runs are needed")
    stages = [shown_stage(folder) for folder in folders]
    for folder, stage in zip(folders, stages, strict=True):
        _check_alike(folder, stage, stages[0])
    runs = [_shown(name, one) for name, one in zip(_names(folders), stages, strict=True)]
    written = [out / name for name in ("compare.csv", "differences.csv", f"compare.{suffix}")]
    check_overwritten("--out", written, force)
    make_folder(out)
    rows = comparison(runs)
    _write(out / "compare.csv", _headings(rows[0], runs[0].run.curve), (row.values() for row in rows))
    _write_differences(out / "differences.csv", runs)
    path = out / f"compare.{suffix}"
    with replacing(path) as part:
        save(comparison_figure(runs), part)
    console.print(_table(rows, runs[0].run.curve))
    console.print(stages[0].laboratory.note(), soft_wrap=True)
    console.print(f"drawn in {path}; the tables are compare.csv and differences.csv", soft_wrap=True)


def _shown(name: str, stage: StoredStage) -> Compared:
    """Return a run in laboratory units."""
    found = stage.found()
    curve, plateau, closed_form, period = in_laboratory(stage.run.curve, found)
    read = replace(found, plateau=plateau, closed_form=closed_form, period=period)
    window = found.window
    if window is not None:
        factor = stage.laboratory.column(stage.run.curve.parameter_column).factor
        read = replace(read, window=(window[0] * factor, window[1] * factor))
    return Compared(name, replace(stage.run, curve=curve), read)


def _check_alike(folder: Path, stage: StoredStage, first: StoredStage) -> None:
    """Raise InputError if the curve of a stage has other quantities than the curve of the first."""

    def quantities(one: StoredStage) -> str:
        curve = one.laboratory.curve(one.run.curve)
        parameter, reaction = curve.parameter_column, curve.reaction_column
        return f"{reaction.name} ({reaction.unit}) over {parameter.name} ({parameter.unit})"

    if quantities(stage) != quantities(first):
        allowed = f"its curve is {quantities(stage)}, but that of the first run is {quantities(first)}"
        raise InputError("DIR", str(folder), allowed)


def _names(folders: Sequence[Path]) -> list[str]:
    """Return the names of runs: those of their folders, or the whole paths where two names are the same."""
    names = [folder.resolve().name for folder in folders]
    if len(set(names)) < len(names):
        names = [str(folder) for folder in folders]
    for folder, name in zip(folders, names, strict=True):
        if names.count(name) > 1:
            raise InputError("DIR", str(folder), "each folder can be given only once")
    return names


def _headings(row: dict[str, Any], curve: Curve) -> list[str]:
    """Return the headings of the table with their units, as in the table of a curve."""
    parameter, reaction = short_unit(curve.parameter_column), curve.reaction_column.unit
    slope = f"{reaction} per {parameter}"
    units = {
        "reached": parameter,
        "plateau": reaction,
        "amplitude": reaction,
        "steepest_rise": slope,
        "steepest_fall": slope,
        "onset": parameter,
        "seconds_per_step": "s",
        "largest_difference": reaction,
        "largest_difference_at": parameter,
    }
    return [f"{name} [{units[name]}]" if name in units else name for name in row]


def _write(path: Path, heading: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    with replacing(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(heading)
        writer.writerows(rows)


def _write_differences(path: Path, runs: Sequence[Compared]) -> None:
    """One row for each parameter of the first run; empty where a run does not have it."""
    first, *others = runs
    curve = first.run.curve
    apart = [difference(other.run.curve, curve) for other in others]
    parameters = np.unique(np.concatenate([one.parameter for one in apart]))
    columns = [dict(zip(one.parameter.tolist(), one.reaction.tolist(), strict=True)) for one in apart]
    parameter, reaction = curve.parameter_column, curve.reaction_column
    first_heading = f"{parameter.name.removesuffix('_deg')} [{short_unit(parameter)}]"
    heading = [first_heading, *(f"{other.name} [{reaction.unit}]" for other in others)]
    _write(path, heading, ([at, *(column.get(at) for column in columns)] for at in parameters.tolist()))


def _table(rows: Sequence[dict[str, Any]], curve: Curve) -> Table:
    """Return a table with one column for each run, so that a few runs fit on any terminal."""
    reaction, unit = curve.reaction_column.unit, short_unit(curve.parameter_column)
    table = Table("", *(Column(row["run"], overflow="fold") for row in rows), box=SIMPLE_HEAD)
    for key, label, digits in (
        ("space", "space", ""),
        ("mesh", "mesh", ""),
        ("dofs", "DOFs", ""),
        ("reached", f"reached / {unit}", "g"),
        ("plateau", f"plateau / {reaction}", ".6g"),
        ("amplitude", f"amplitude / {reaction}", ".3e"),
        ("steepest_rise", f"steepest rise / {reaction}/{unit}", "+.3e"),
        ("steepest_fall", f"steepest fall / {reaction}/{unit}", "+.3e"),
        ("onset", f"onset / {unit}", ".1f"),
        ("seconds_per_step", "time of a step / s", ".2g"),
        ("largest_difference", f"difference from the first / {reaction}", "+.3e"),
        ("largest_difference_at", f"  at / {unit}", "g"),
    ):
        values = ["-" if row[key] is None else f"{row[key]:{digits}}" for row in rows]
        if key.startswith("largest"):
            values[0] = ""
        if set(values) - {"-", ""}:
            table.add_row(label, *values)
    return table
