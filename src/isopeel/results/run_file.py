"""The file of a run, run.h5: its curve, displacements at chosen angles, the case, and where it comes from.

Layout: `case`, the TOML text; `curve/NAME` (n,) for each column, with its `unit`, among them
`curve/energy_residuals` (m,), one for each Newton correction of all steps; `fields/parameter` (k,) in the
unit of the parameter's column, and `fields/displacement` (k, functions, 2); `last`, the states of the last
steps, from which the path goes on: `parameter` (l,) in the solver's unit, `displacement` (l, functions, 2),
`unknown_values` (l, count), and `openings` (E, Q) after the last; `last/memory`, what the solver kept: where
its tangent was made and the pairs (k, count) of `corrections` and `changes` since; `base` (functions, 2), the
displacement that a stage after another began with; `failure`, where there was one; attributes of the root
for all else.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from types import MappingProxyType, TracebackType
from typing import Any, Literal, NamedTuple, Self

import h5py
import numpy as np

from isopeel.arrays import FloatArray, IntArray, frozen
from isopeel.errors import InputError
from isopeel.problem import Column, Drive, Problem
from isopeel.results.curve import Curve
from isopeel.results.files import replacing
from isopeel.results.provenance import Provenance
from isopeel.solve.newton import HINTS, Cause
from isopeel.solve.quasi_newton import Memory, Pair
from isopeel.solve.step import STATES_TO_GO_ON, State, Step
from isopeel.splines.rows import RowSpace

#: How a run ended; "running" is what the file of a killed run says.
Ending = Literal["running", "completed", "not converged", "interrupted"]

_FORMAT = "isopeel run 6"
_SAVE_SECONDS = 1.0
_SAVE_SHARE = 0.02  # of the time may go into saving
_ROUND_OFF = 1e-9


class Failure(NamedTuple):
    """A step without an equilibrium."""

    parameter: float  # in the unit of its column
    reason: str
    iterations: tuple[float, ...]  # energy residual per unknown
    cause: Cause = "iteration limit"

    @property
    def hint(self) -> str:
        """What to try."""
        return HINTS[self.cause]


@dataclass(frozen=True, eq=False)
class StoredRun:
    """What the file of a run holds.

    `fields` maps the parameter, in the unit of its column, to displacement coefficients (functions, 2).
    `attributes` are those of `run_attributes`.
    """

    case_text: str
    curve: Curve
    fields: Mapping[float, FloatArray]
    attributes: Mapping[str, str | int]
    ending: Ending
    failure: Failure | None = None
    last: tuple[State, ...] = ()  # where `trace` goes on bit for bit, the newest at the end
    base: FloatArray | None = None  # displacement that a later stage began with, (functions, 2)


def run_attributes(problem: Problem, space: RowSpace, provenance: Provenance) -> dict[str, str | int]:
    """Describe the discretization and the provenance of a run; `git_revision` only where there is one."""
    revision = provenance.git_revision
    return {
        "space": space.name,
        "mesh": "{}x{}".format(*space.elements),
        "dofs": 2 * space.size,
        "traction": problem.adhesion.traction,
        "platform": provenance.platform,
        "started": provenance.started,
        "command_line": provenance.command_line,
        **{f"version_{name}": version for name, version in provenance.versions.items()},
        **({} if revision is None else {"git_revision": revision}),
    }


class RunWriter:
    """Consumer of steps that keeps the file of a run up to date: about once a second, and when it is closed.

    The first save removes the `outdated` files, which were made from an earlier run; `saved` says that it
    was made.

    The displacement is kept at the first step at or beyond each multiple of `field_interval` (in the
    unit of the parameter's column), and at the last step; `base` is that of the state that a stage begins
    with. Each save replaces the file as a whole, so that it is sound whatever ends the process: an
    exception, a kill, a full disk. Raises OSError where the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        drive: Drive,
        case_text: str,
        attributes: Mapping[str, str | int],
        field_interval: float = 10.0,
        outdated: Sequence[Path] = (),
        base: FloatArray | None = None,
    ) -> None:
        self._path = path
        self._drive = drive
        self._case_text = case_text
        self._attributes = attributes
        self._interval = field_interval
        self._outdated = outdated
        self._base = base
        self._kept = -1.0
        self._rows: list[Step] = []
        self._fields: dict[float, FloatArray] = {}
        self._last: dict[float, FloatArray] = {}
        self._states: deque[State] = deque(maxlen=STATES_TO_GO_ON)
        self._ending: Ending = "running"
        self._failure: Failure | None = None
        self._next_save = 0.0
        self.saved: bool = False

    def __enter__(self) -> Self:
        """Touch nothing yet: the first step replaces an earlier run, and so does an end without one."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Save what has come."""
        if self._rows or self._ending != "running":
            self._save()

    def append(self, step: Step) -> None:
        """Take a step."""
        # the row without its field, which would fill the memory
        empty = np.empty((0, 2))
        self._rows.append(
            replace(step, displacement=empty, openings=empty, unknown_values=empty[:, 0], memory=None)
        )
        self._states.append(step.state)
        parameter = float(self._drive.parameter_column.shown(step.parameter))
        self._last = {parameter: step.displacement}
        passed = np.floor(abs(parameter) / self._interval + _ROUND_OFF)
        if passed != self._kept:
            self._fields |= self._last
            self._kept = passed
        if perf_counter() >= self._next_save:
            self._save()

    @property
    def curve(self) -> Curve:
        """The curve as far as it has come."""
        return Curve.of(self._rows, self._drive)

    def end(self, ending: Ending, failure: Failure | None = None) -> None:
        """Note how the run ended."""
        self._ending, self._failure = ending, failure

    def _save(self) -> None:
        began = perf_counter()
        fields = self._fields | self._last
        states = tuple(self._states)
        run = StoredRun(
            self._case_text,
            self.curve,
            fields,
            self._attributes,
            self._ending,
            self._failure,
            states,
            self._base,
        )
        write_run(self._path, run)
        if not self.saved:
            for path in self._outdated:
                path.unlink(missing_ok=True)
        self.saved = True
        now = perf_counter()
        self._next_save = now + max(_SAVE_SECONDS, (now - began) / _SAVE_SHARE)


def write_run(path: Path, run: StoredRun) -> None:
    """Write the file of a run, in one go: it has its old content or its new one. Raises OSError."""
    with replacing(path) as part:
        part.write_bytes(_image(run))


def read_run(path: Path) -> StoredRun:
    """Read the file of a run. Raises InputError where it is not one."""
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != _FORMAT:
                raise InputError("FILE", str(path), "it is not the file of a run of this version")
            return _stored(file)
    except (OSError, KeyError) as error:
        raise InputError("FILE", str(path), f"the file of a run is needed: {error}") from error


def _image(run: StoredRun) -> bytes:
    # HDF5 leaves an unreadable file where a disk fills up, so it only ever writes to memory
    with h5py.File("run.h5", "w", driver="core", backing_store=False) as file:
        file["case"] = run.case_text
        file.attrs.update({"format": _FORMAT, "ending": run.ending, **run.attributes})
        for column, values in _columns(run.curve):
            data = file.create_dataset(f"curve/{column.name}", data=values)
            data.attrs.update({"unit": column.unit, "factor": column.factor, "words": column.words})
        for role in ("parameter", "reaction"):
            file["curve"].attrs[role] = getattr(run.curve, f"{role}_column").name
        file["fields/parameter"] = np.array(list(run.fields), dtype=np.float64)
        file["fields/displacement"] = np.array(list(run.fields.values()), dtype=np.float64)
        if run.last:
            parameters, displacements, openings, unknowns, memories = zip(*run.last, strict=True)
            file["last/parameter"] = np.array(parameters, dtype=np.float64)
            file["last/displacement"] = np.array(displacements)
            file["last/unknown_values"] = np.array(unknowns)
            file["last/openings"] = openings[-1]
            if memories[-1] is not None:
                _write_memory(file.create_group("last/memory"), memories[-1])
        if run.base is not None:
            file["base"] = run.base
        if run.failure is not None:
            file.create_group("failure").attrs.update(run.failure._asdict())
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def _write_memory(group: h5py.Group, memory: Memory) -> None:
    group.attrs.update({"parameter": memory.parameter, "steps": memory.steps, "slow": memory.slow})
    group["unknown_values"] = memory.unknown_values
    group["openings"] = memory.openings
    empty = np.empty((0, memory.unknown_values.size))
    group["corrections"] = np.array([pair.correction for pair in memory.pairs] or empty)
    group["changes"] = np.array([pair.change for pair in memory.pairs] or empty)


def _memory(group: h5py.Group) -> Memory:
    pairs = map(Pair.of, group["corrections"][()], group["changes"][()])
    return Memory(
        group["unknown_values"][()],
        float(group.attrs["parameter"]),
        frozen(group["openings"][()]),
        tuple(pairs),
        int(group.attrs["steps"]),
        bool(group.attrs["slow"]),
    )


def _stored(file: h5py.File) -> StoredRun:
    attributes = {name: _plain(value) for name, value in file.attrs.items()}
    del attributes["format"]
    ending = attributes.pop("ending")
    data = {name: values[()] for name, values in file["curve"].items()}
    columns = {}
    for role in ("parameter", "reaction"):
        name = file["curve"].attrs[role]
        units = file["curve"][name].attrs
        columns[role] = Column(name, units["unit"], float(units["factor"]), units["words"])
    reals = {
        name: frozen(data[name])
        for name in (
            "stored_energy",
            "adhesive_energy",
            "dissipated_energy",
            "released_energy",
            "seconds",
            "energy_residuals",
        )
    }
    curve = Curve(
        parameter_column=columns["parameter"],
        reaction_column=columns["reaction"],
        parameter=frozen(data[columns["parameter"].name]),
        reaction=frozen(data[columns["reaction"].name]),
        iterations=data["iterations"],
        kind=data["kind"],
        negative_eigenvalues=data["negative_eigenvalues"],
        **reals,
    )
    displacements = map(frozen, file["fields/displacement"][()])
    fields = dict(zip(file["fields/parameter"][()].tolist(), displacements, strict=True))
    failure = None
    if "failure" in file:
        found = file["failure"].attrs
        failure = Failure(
            float(found["parameter"]), found["reason"], tuple(found["iterations"].tolist()), found["cause"]
        )
    last: tuple[State, ...] = ()
    if "last" in file:
        stored = file["last"]
        arrays = (frozen(stored[name][()]) for name in ("displacement", "unknown_values"))
        openings = frozen(stored["openings"][()])
        memory = _memory(stored["memory"]) if "memory" in stored else None
        last = tuple(
            State(parameter, displacement, openings, unknowns, memory)
            for parameter, displacement, unknowns in zip(
                stored["parameter"][()].tolist(), *arrays, strict=True
            )
        )
    return StoredRun(
        file["case"].asstr()[()],
        curve,
        MappingProxyType(fields),
        MappingProxyType(attributes),
        ending,
        failure,
        last,
        frozen(file["base"][()]) if "base" in file else None,
    )


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _columns(curve: Curve) -> tuple[tuple[Column, FloatArray | IntArray], ...]:
    return (
        (curve.parameter_column, curve.parameter),
        (curve.reaction_column, curve.reaction),
        (Column("iterations", "1"), curve.iterations),
        (Column("stored_energy", "E0 L0^3"), curve.stored_energy),
        (Column("adhesive_energy", "E0 L0^3"), curve.adhesive_energy),
        (Column("dissipated_energy", "E0 L0^3"), curve.dissipated_energy),
        (Column("released_energy", "E0 L0^3"), curve.released_energy),
        (Column("seconds", "s"), curve.seconds),
        (Column("energy_residuals", "E0 L0^3"), curve.energy_residuals),
        (Column("kind", "1"), curve.kind),
        (Column("negative_eigenvalues", "1"), curve.negative_eigenvalues),
    )
