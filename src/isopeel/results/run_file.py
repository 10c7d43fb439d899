"""The file of a run, run.h5: the curve, fields at selected steps, the case, and the provenance.

`isopeel.results.schema` lists the data sets with their units and descriptions, which are also attributes of
each data set. The file also has the groups `spaces/NAME`, the knots, degrees and control points of the
displacement space of each body (`isopeel.results.spaces`); `history/NAME`, the maximum openings of each
irreversible interface; `last`, the state of the last step, from which the path continues; and in it `solver`,
arrays that only the solver reads (`isopeel.solve.stored_state`). All else are attributes of the root.

While the run is computed, and after it was killed, its journal is beside it (`isopeel.results.journal`).
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from errno import EMFILE, ENFILE
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, get_args
from uuid import uuid4

import h5py
import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.errors import InputError
from isopeel.problem import Column, Problem
from isopeel.results import schema, untrusted
from isopeel.results.curve import Curve, DifferentiatedBy
from isopeel.results.fields import KeptStates, StoredState, nearest
from isopeel.results.files import check_readable, replacing
from isopeel.results.journal import Record, read_journal
from isopeel.results.layout import Layout, read_history
from isopeel.results.provenance import Provenance
from isopeel.results.untrusted import UntrustedError
from isopeel.solve.convergence import HINTS, Cause
from isopeel.solve.step import KINDS, State
from isopeel.solve.stored_state import VERSION, restored, solver_arrays

#: The ending of a run; that of a killed run is "running".
Ending = Literal["running", "completed", "not converged", "interrupted"]

_FORMAT = "isopeel run 7"
_EARLIER = r"isopeel run \d{1,3}"
_IDENTITY = 16  # bytes
#: Arrays that the solver may have.
_MOST_ARRAYS = 20
#: Columns of a curve beside its parameter and reaction.
_OTHERS = (
    *("iterations", "stored_energy", "adhesive_energy", "dissipated_energy", "released_energy"),
    *("seconds", "energy_residuals", "kind", "negative_eigenvalues"),
)


#: Between names of boundaries, and such a name.
_BETWEEN, _NAME = ", ", re.compile(r"[\w-][\w -]*\.[a-z]{1,10}(#\d{1,4})?")
#: Between units of parameters, and the key of one.
_UNITS, _KEY = "; ", re.compile(r"[A-Za-z0-9_-]{1,100}(\.[A-Za-z0-9_-]{1,100}){0,19}")


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
    """The content of the file of a run.

    `states` are those of the first step at or beyond each multiple of `field_interval`, in the unit of the
    parameter's column, and of the last step. `attributes` are those of `run_attributes`. If the run was
    killed, `journaled` of its steps are from its journal, which belongs to the `identity` of the file, and
    `last` is the state before them. The `layout` is written for other programs, and not read.
    """

    case_text: str
    curve: Curve
    states: tuple[StoredState, ...]
    attributes: Mapping[str, str | int]
    ending: Ending
    failure: Failure | None = None
    last: State | None = None  # from which `trace` continues with bit-identical steps
    base: FloatArray | None = None  # displacement that a later stage began with, (functions, 2)
    field_interval: float = 10.0
    identity: str = field(default_factory=lambda: uuid4().hex)
    journaled: int = 0
    layout: Layout = field(default_factory=Layout)

    def nearest(self, parameter: float) -> StoredState:
        """Return the stored state nearest to a parameter, in the unit of the curve's column.

        Of several at one parameter, on different branches, it is the last.
        """
        return nearest(self.states, parameter)


def run_attributes(problem: Problem, space: SpaceOfBodies, provenance: Provenance) -> dict[str, str | int]:
    """Describe the discretization and the provenance of a run, with `git_revision` if there is one.

    Spaces and meshes of several bodies are listed in their order; equal kinds of traction are listed once.
    """
    revision = provenance.git_revision
    spaces = spaces_by_name(problem, space).values()
    return {
        "space": ", ".join(one.name for one in spaces),
        "mesh": ", ".join("{}x{}".format(*one.elements) for one in spaces),
        "dofs": 2 * sum(one.size for one in spaces),
        "traction": ", ".join(dict.fromkeys(interface.traction for interface in problem.interfaces)),
        "platform": provenance.platform,
        "started": provenance.started,
        "command_line": provenance.command_line,
        **{f"version_{name}": version for name, version in provenance.versions.items()},
        **({} if revision is None else {"git_revision": revision}),
    }


def write_run(path: Path, run: StoredRun) -> None:
    """Write the file of a run: at any time it has its old content or its new one. Raises OSError.

    The new content is on the disk before it replaces the old one, so this is also true if the machine fails.
    """
    with replacing(path, durable=True) as part:
        part.write_bytes(_image(run))


def read_run(path: str | Path, *, journal: bool = True) -> StoredRun:
    """Read the file of a run, with the steps of its journal if there are any.

    Both are untrusted, and nothing outside of them is read. Raises InputError if it is not the file of a run.
    """
    path = Path(path)
    try:
        check_readable(path)
        with h5py.File(path, "r") as file:
            _check_format(untrusted.attribute(file, "format"))
            run = _stored(file)
        if not journal or run.last is None:
            return run
        shapes = run.last.displacement.shape, _history_of(run.last).shape
        return _followed_by(run, read_journal(path, run.identity, run.curve, *shapes))
    except OSError as error:
        if error.errno in (EMFILE, ENFILE):
            raise  # which is not the fault of the file
        raise InputError("FILE", str(path), f"the file of a run is needed: {error}") from error
    except (KeyError, ValueError, TypeError, RuntimeError, ArithmeticError) as error:
        raise InputError("FILE", str(path), f"the file of a run is needed: {error}") from error


def _check_format(stated: object) -> None:
    if stated == _FORMAT:
        return
    if isinstance(stated, str) and re.fullmatch(_EARLIER, stated):
        raise UntrustedError(f"it was written by another version of isopeel ({stated}): run its case again")
    raise UntrustedError("it is not the file of a run")


def _history_of(state: State) -> FloatArray:
    return np.empty((0, 0)) if state.maximum_openings is None else state.maximum_openings


def _followed_by(run: StoredRun, records: Iterable[Record]) -> StoredRun:
    kept = KeptStates(run.field_interval, run.states)
    rows = []
    for row, state in records:
        rows.append(row)
        kept.take(state)
    longer = replace(run, curve=run.curve.followed_by(rows), journaled=len(rows))
    return replace(longer, states=kept.all())


def _image(run: StoredRun) -> bytes:
    # HDF5 leaves an unreadable file where a disk fills up, so it only ever writes to memory
    with h5py.File("run.h5", "w", driver="core", backing_store=False) as file:
        file.attrs.update(
            {
                "format": _FORMAT,
                "ending": run.ending,
                "identity": run.identity,
                "field_interval": run.field_interval,
                **run.attributes,
            }
        )
        schema.write(file, "case", run.case_text)
        _write_curve(file, run.curve)
        states = run.states
        schema.write(file, "fields/step", np.array([one.step for one in states], dtype=np.int64))
        u = [one.displacement for one in states]
        functions = 0 if run.last is None else len(run.last.displacement)
        schema.write(file, "fields/displacement", np.array(u or np.empty((0, functions, 2))))
        if any(one.maximum_openings.any() for one in states):
            run.layout.write_history(file, [one.maximum_openings for one in states])
        if run.last is not None:
            _write_state(file, run.last)
        if run.base is not None:
            schema.write(file, "base", run.base)
        if run.failure is not None:
            schema.write(file, "failure/iterations", np.array(run.failure.iterations, np.float64))
            stated = run.failure
            file["failure"].attrs.update(
                {"parameter": stated.parameter, "reason": stated.reason, "cause": stated.cause}
            )
        run.layout.write_spaces(file)
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def _write_curve(file: h5py.File, curve: Curve) -> None:
    for role in ("parameter", "reaction"):
        column: Column = getattr(curve, f"{role}_column")
        schema.write(file, f"curve/{role}", getattr(curve, role), **asdict(column))
    for name in _OTHERS:
        schema.write(file, f"curve/{name}", getattr(curve, name))
    if curve.boundaries:
        names, unit = _BETWEEN.join(curve.boundaries), curve.reaction_column.unit
        schema.write(file, "curve/reactions", curve.reactions, names=names, unit=unit)
    if curve.sensitive_to:
        keys, values, units = zip(*curve.sensitive_to, strict=True)
        unit = curve.reaction_column.unit
        schema.write(file, "curve/sensitivities", curve.sensitivities, unit=unit)
        listed = {"names": _BETWEEN.join(keys), "unit": _UNITS.join(units)}
        schema.write(file, "curve/sensitive_to", np.array(values, dtype=np.float64), **listed)
    if curve.load_work.size:
        schema.write(file, "curve/load_work", curve.load_work)


def _write_state(file: h5py.File, state: State) -> None:
    schema.write(file, "last/displacement", state.displacement)
    file["last"].attrs["parameter"] = state.parameter
    if state.maximum_openings is not None:
        schema.write(file, "last/maximum_openings", state.maximum_openings)
    file["last"].create_group("solver").attrs["version"] = VERSION
    for name, values in solver_arrays(state).items():
        schema.write_described(file, f"last/solver/{name}", values)


def _state(file: h5py.File, read: schema.Read) -> State | None:
    displacement = read.get("last/displacement")
    if displacement is None:
        return None
    last = untrusted.group(file, "last")
    state = State(untrusted.number(last, "parameter"), displacement, read.get("last/maximum_openings"))
    solver = untrusted.group(last, "solver")
    if untrusted.number(solver, "version") != VERSION:
        # without the solver state the path also continues, with steps to the tolerance of the solver
        return state
    arrays: dict[str, FloatArray] = {}
    for name in list(solver)[:_MOST_ARRAYS]:
        arrays[name] = untrusted.floats(solver, name)
        schema.check_values(solver[name], arrays[name], finite=False)
    return restored(state, arrays)


def _stored(file: h5py.File) -> StoredRun:
    attributes = {name: untrusted.attribute(file, name) for name in file.attrs}
    stated, identity = (untrusted.words(file, name) for name in ("ending", "identity"))
    interval = untrusted.number(file, "field_interval")
    for name in ("format", "ending", "identity", "field_interval"):
        del attributes[name]
    if any(isinstance(value, np.ndarray) for value in attributes.values()):
        raise UntrustedError("an attribute is an array")
    endings: dict[str, Ending] = {ending: ending for ending in get_args(Ending)}
    if stated not in endings or len(bytes.fromhex(identity)) != _IDENTITY:
        raise UntrustedError("its ending or its identity is unknown")
    if not 0 < interval < np.inf:
        raise UntrustedError(f"its field_interval is {interval}")
    read = schema.read(file)
    curve = _stored_curve(file, read)
    last = _state(file, read)
    return StoredRun(
        read.case,
        curve,
        _states(file, read, curve, last),
        MappingProxyType(attributes),
        endings[stated],
        _failure(file, read),
        last,
        read.get("base"),
        interval,
        identity,
    )


def _failure(file: h5py.File, read: schema.Read) -> Failure | None:
    iterations = read.get("failure/iterations")
    if iterations is None:
        return None
    found = untrusted.group(file, "failure")
    causes: dict[str, Cause] = {cause: cause for cause in HINTS}
    return Failure(
        untrusted.number(found, "parameter"),
        schema.text_attribute(found, "reason"),
        tuple(iterations.tolist()),
        causes[untrusted.words(found, "cause")],
    )


def _states(file: h5py.File, read: schema.Read, curve: Curve, last: State | None) -> tuple[StoredState, ...]:
    steps, displacement = read.integers("fields/step"), read.floats("fields/displacement")
    if (steps < 0).any() or (steps >= len(curve)).any() or (np.diff(steps) <= 0).any():
        raise UntrustedError("its fields are of steps that its curve does not have")
    shape = np.empty((0, 0)).shape if last is None else _history_of(last).shape
    maximum_openings = read_history(file, len(steps), shape)
    if maximum_openings is None:
        maximum_openings = np.zeros((len(steps), *shape))
    return tuple(
        StoredState(step, float(curve.parameter[step]), u, opening)
        for step, u, opening in zip(steps.tolist(), displacement, map(frozen, maximum_openings), strict=True)
    )


def _stored_curve(file: h5py.File, read: schema.Read) -> Curve:
    columns = {}
    for role in ("parameter", "reaction"):
        data = file[f"curve/{role}"]
        name, unit, words = (schema.label(data, key) for key in ("name", "unit", "words"))
        columns[role] = Column(name, unit, untrusted.number(data, "factor"), words)
    iterations, kind = (read.integers(f"curve/{name}") for name in ("iterations", "kind"))
    if (iterations < 0).any() or iterations.sum() != len(read.arrays["curve/energy_residuals"]):
        raise UntrustedError("the columns of its curve do not fit together")
    if not np.isin(kind, np.arange(len(KINDS))).all():
        raise UntrustedError("a kind of a step is unknown")
    values: dict[str, Any] = {
        name: read.arrays[f"curve/{name}"] for name in ("parameter", "reaction", *_OTHERS)
    }
    for name in ("reactions", "load_work", "sensitivities"):
        if f"curve/{name}" in read.arrays:
            values[name] = read.arrays[f"curve/{name}"]
    if "reactions" in values:
        values["boundaries"] = _boundaries(file["curve/reactions"])
    if "sensitivities" in values:
        values["sensitive_to"] = _sensitive_to(file, read)
    return Curve(columns["parameter"], columns["reaction"], **values)


def _sensitive_to(file: h5py.File, read: schema.Read) -> tuple[DifferentiatedBy, ...]:
    values, data = read.floats("curve/sensitive_to").tolist(), file["curve/sensitive_to"]
    keys = schema.text_attribute(data, "names").split(_BETWEEN)
    units = [schema.plain(unit) for unit in schema.text_attribute(data, "unit").split(_UNITS)]
    if not len(keys) == len(units) == len(values) or not all(_KEY.fullmatch(key) for key in keys):
        raise UntrustedError("the parameters of its sensitivities do not fit")
    return tuple(DifferentiatedBy(*one) for one in zip(keys, values, units, strict=True))


def _boundaries(reactions: h5py.Dataset) -> tuple[str, ...]:
    names = tuple(schema.text_attribute(reactions, "names").split(_BETWEEN))
    if len(names) != reactions.shape[1] or not all(_NAME.fullmatch(name) for name in names):
        raise UntrustedError("the names of its boundaries do not fit")
    return names
