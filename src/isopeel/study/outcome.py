"""One run of a study: a task that needs no files, and what is kept of it."""

import json
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from hashlib import sha256
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import h5py
import numpy as np

from isopeel.case import Case
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.fingerprint import code_fingerprint
from isopeel.post.shown import in_laboratory
from isopeel.results.curve import Curve
from isopeel.results.files import replacing
from isopeel.running.in_memory import stage_results
from isopeel.running.stage_summary import Results
from isopeel.study.design import Point

_FORMAT = "isopeel study run 1"
#: The ending of a run whose case cannot be computed, and of one whose process was lost more than once.
REFUSED, LOST = "refused", "lost"


class Amount(NamedTuple):
    """A value and its unit."""

    value: float
    unit: str


class Line(NamedTuple):
    """The curve of a stage: parameters and reactions (steps,), with their names and units.

    `sensitivities` (steps, parameters) are derivatives of the reaction, if they were computed.
    """

    stage: str
    parameter: FloatArray
    reaction: FloatArray
    names: tuple[str, str]
    units: tuple[str, str]
    sensitivities: FloatArray = np.empty((0, 0))

    @classmethod
    def of(cls, stage: str, curve: Curve) -> "Line":
        """Return the curve of a stage, in the units of its columns."""
        columns = curve.parameter_column, curve.reaction_column
        return cls(
            stage,
            curve.parameter,
            curve.reaction,
            (columns[0].name.removesuffix("_deg"), columns[1].name),
            (columns[0].unit, columns[1].unit),
            curve.sensitivities,
        )


@dataclass(frozen=True)
class Outcome:
    """What is kept of a run.

    `ending` is that of its last stage, or REFUSED or LOST; `cause` says why a run did not complete. If there
    are several stages, the names of `readings` begin with that of their stage.
    """

    ending: str
    cause: str = ""
    readings: Mapping[str, Amount] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    lines: tuple[Line, ...] = ()
    steps: int = 0
    corrections: int = 0
    seconds: float = 0.0
    host: str = ""


@dataclass(frozen=True)
class Task:
    """A run to compute: the text of a case, and other values of some of its keys."""

    case_text: str
    values: Point

    @property
    def digest(self) -> str:
        """The name of its outcome: a digest of the case, the values, and the code that computes them."""
        defined_by = [self.case_text, dict(sorted(self.values.items())), code_fingerprint("running")]
        return sha256(json.dumps(defined_by).encode()).hexdigest()[:32]

    def __call__(self) -> Outcome:
        """Compute the run. What is wrong with it is part of the outcome."""
        began = perf_counter()
        stages: list[Results] = []
        refused = ""
        try:
            for results in stage_results(Case.parse(self.case_text).with_values(self.values)):
                stages.append(results)  # noqa: PERF402 (those before an error stay)
        except InputError as error:
            refused = str(error)
        except MemoryError:
            refused = "there is not enough memory; use a coarser mesh"
        return _outcome(stages, refused, perf_counter() - began)


def _outcome(stages: list[Results], refused: str, seconds: float) -> Outcome:
    readings: dict[str, Amount] = {}
    notes: dict[str, None] = {}
    lines = []
    ending, cause = REFUSED, refused
    for run, found, summary in stages:
        stage = str(run.attributes.get("stage", ""))
        prefix = f"{stage}: " if len(stages) > 1 else ""
        for one in summary["readings"]:
            if one["value"] is not None and isfinite(one["value"]):
                readings.setdefault(prefix + one["quantity"], Amount(one["value"], one["unit"]))
        notes |= dict.fromkeys(prefix + note["text"] for note in summary["notes"])
        lines.append(Line.of(stage, in_laboratory(run.curve, found).curve))
        if not refused:
            ending = run.ending
            cause = "" if run.failure is None else f"{summary['failure']['reason']} ({run.failure.cause})"
    return Outcome(
        ending,
        cause,
        readings,
        tuple(notes),
        tuple(lines),
        sum(len(one.run.curve) for one in stages),
        sum(int(one.run.curve.iterations.sum()) for one in stages),
        seconds,
        platform.node(),
    )


def write_outcome(outcome: Outcome, path: Path) -> None:
    """Write an outcome as HDF5; the file has its old content or its new one. Raises OSError."""
    described = asdict(replace(outcome, lines=()))
    described["lines"] = [(line.stage, line.names, line.units) for line in outcome.lines]
    with replacing(path) as part, h5py.File(part, "w") as file:
        file.attrs["format"] = _FORMAT
        file["outcome"] = json.dumps(described)
        for number, line in enumerate(outcome.lines):
            file[f"curve/{number}"] = np.stack([line.parameter, line.reaction, *line.sensitivities.T])


def read_outcome(path: Path) -> Outcome | None:
    """Read an outcome; None if the file does not exist, or is not what `write_outcome` writes."""
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != _FORMAT:
                return None
            described = json.loads(file["outcome"].asstr()[()])
            lines = []
            for number, (stage, names, units) in enumerate(described.pop("lines")):
                parameter, reaction, *rates = file[f"curve/{number}"][()]
                table = np.stack(rates, axis=1) if rates else np.empty((len(parameter), 0))
                lines.append(Line(stage, parameter, reaction, tuple(names), tuple(units), table))
            readings = {name: Amount(*amount) for name, amount in described.pop("readings").items()}
            notes = tuple(described.pop("notes"))
            return Outcome(readings=readings, lines=tuple(lines), notes=notes, **described)
    except (OSError, KeyError, TypeError, ValueError, AttributeError):
        return None
