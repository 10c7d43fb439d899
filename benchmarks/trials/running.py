"""Run one case like `isopeel run`, and return its outcome."""

import json
import re
import time
import traceback
from dataclasses import dataclass
from fractions import Fraction
from io import StringIO
from math import isnan, nan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from rich.console import Console

from isopeel.case import load_case
from isopeel.common.errors import InputError
from isopeel.common.units import parse_quantity
from isopeel.results.run_file import StoredRun, read_run
from isopeel.running.folder import places
from isopeel.running.run import run_case
from isopeel.solve.step import KINDS
from trials.case import Reading, Trial
from trials.energy import Gain, gain_in_parts, largest_gain

#: The ending of a case: complete; ended before its last step, with a cause; rejected as bad input; ended by
#: an unexpected error; or stopped at the time limit.
Ending: TypeAlias = Literal["completed", "not converged", "refused", "crashed", "too slow"]

#: Subjects of notes that do not question the numbers.
_NO_DOUBT = ("reading", "bifurcation")


@dataclass(frozen=True)
class Outcome:
    """The outcome of a case: its ending, the value that a user reads (SI per width), and the notes."""

    ending: Ending
    value: float = nan
    notes: tuple[str, ...] = ()
    cause: str = ""
    steps: int = 0
    seconds: float = 0.0  # of the processor
    gain: Gain | None = None
    theory: float = nan  # the closed form beside the value in the summary


@dataclass(frozen=True)
class Attempt:
    """The task of running a trial in its own folder, inside another folder."""

    trial: Trial
    within: Path

    def __call__(self) -> Outcome:
        """Run it."""
        with TemporaryDirectory(dir=self.within) as folder:
            return run_text(
                self.trial.text, dict(self.trial.drawn.files), Path(folder), self.trial.drawn.answer.reading
            )


@dataclass(frozen=True)
class Shipped:
    """The task of running a shipped case, for its energies, in a folder within another."""

    name: str
    within: Path

    def __call__(self) -> Outcome:
        """Run it."""
        with TemporaryDirectory(dir=self.within) as folder:
            return _run(self.name, Path(folder) / "out", "largest")


def run_text(text: str, files: dict[str, str], folder: Path, reading: Reading) -> Outcome:
    """Run a case file in a folder, with other files beside it."""
    for name, content in {**files, "case.toml": text}.items():
        (folder / name).write_text(content, encoding="utf-8")
    return _run(folder / "case.toml", folder / "out", reading)


def _run(source: str | Path, out: Path, reading: Reading) -> Outcome:
    began = time.process_time()
    try:
        case = load_case(source)
        result = run_case(case, out, Console(file=StringIO()))
        summary = json.loads((result.folder / "summary.json").read_text("utf-8"))
        stages = case.stages()
        paths = [place.run_file for place in places(case.name, [stage.name for stage in stages], out)]
        runs = [read_run(path) for path in paths if path.exists()]
        gains = [largest_gain(run, stage.problem) for run, stage in zip(runs, stages, strict=False)]
        gains = [
            gain_in_parts(case, number, gain) if gain.forbidden else gain for number, gain in enumerate(gains)
        ]
    except InputError as error:
        return Outcome("refused", cause=f"{error}", seconds=time.process_time() - began)
    except Exception:
        return Outcome("crashed", cause=traceback.format_exc(), seconds=time.process_time() - began)
    found = read(summary, reading)
    if reading == "buckling" and isnan(found.value):
        found = Read(_bifurcation(result.run, summary["units"]))
    failure = summary["failure"]
    return Outcome(
        "completed" if summary["completed"] else "not converged",
        found.value,
        tuple(
            f"{note['subject']}: {note['text']}"
            for note in summary["notes"]
            if note["subject"] not in _NO_DOUBT
        ),
        f"{failure['cause']}: {failure['reason']}" if failure else "",
        sum(len(run.curve) for run in runs),
        time.process_time() - began,
        max(gains, key=lambda gain: gain.share),
        found.theory,
    )


#: The first words of the summary row of each reading.
_ROWS: dict[Reading, tuple[str, ...]] = {
    "plateau": ("steady ", "mean "),
    "largest": ("largest force", "largest moment"),
    "pull-off": ("pull-off force", "largest tension"),
    "push": ("largest push",),
    "buckling": ("buckling",),
}


class Read(NamedTuple):
    """Return a value in a summary and the closed form beside it, in SI units per width; nan if missing."""

    value: float = nan
    theory: float = nan


def read(summary: dict[str, Any], reading: Reading) -> Read:
    """Return the row of a summary that a user of the drive needs."""
    for row in summary["readings"]:
        if row["quantity"].startswith(_ROWS[reading]):
            unit = unit_of(row["unit"], summary["units"], moment="moment" in row["quantity"])
            theory = row["closed_form"]["value"] if row["closed_form"] else nan
            return Read(row["value"] * unit, theory * unit)
    return Read()


def _bifurcation(run: StoredRun, units: dict[str, Any]) -> float:
    """Return the force at the first bifurcation of a curve, from its table; nan if there is none."""
    curve = run.curve
    steps = np.flatnonzero(np.array(KINDS)[curve.kind] == "bifurcation")
    if not len(steps):
        return nan
    raised = curve.parameter_column.name == "force"
    column, values = (
        (curve.parameter_column, curve.parameter) if raised else (curve.reaction_column, curve.reaction)
    )
    return abs(float(values[steps[0]])) * unit_of(column.unit, units, moment=False)


def unit_of(written: str, units: dict[str, Any], *, moment: bool) -> float:
    """Return the SI size of the unit of a reaction, such as E0 L0, N/m, or E0 L0^3 for a width of L0."""
    length, size, powers = float(parse_quantity(units["L0"]).exact), 1.0, Fraction(0)
    for name, dimension, power in re.findall(r"((E0|L0)(?:\^(\d))?)", written):
        size *= float(parse_quantity(units[dimension]).exact) ** int(power or 1)
        powers += int(power or 1) if dimension == "L0" else 0
        written = written.replace(name, "", 1)
    if written.strip():
        quantity = parse_quantity(f"1 {written.strip()}")
        size, powers = size * float(quantity.exact), powers + quantity.length
    extra = powers - (2 if moment else 1)
    if extra not in (0, 1):
        raise ValueError(f"a reaction cannot have the unit {written!r}")
    return size / length ** int(extra)
