"""The file of a run, run.h5: its curve, displacements at chosen parameters, the case, and its provenance.

Layout:
* `case`: the TOML text;
* `curve/NAME` (n,) for each column, with its `unit`; among them `curve/energy_residuals` (m,), one for each
  Newton correction of all steps;
* `fields/parameter` (k,) in the unit of the parameter's column, `fields/displacement` (k, functions, 2), and
  `fields/openings` (k, E, Q), the maximum openings of an irreversible joint, unless all are zero;
* `last`, the state of the last step, from which the path continues: `parameter` in the solver's unit,
  `displacement` (functions, 2), `openings` (E, Q);
* `last/past`, the accepted states of the solver: `parameter` (l,), `unknown_values` (l, count), `energies`
  (l, 3), and `polished` (l, count), the fully converged unknowns, nan where there are none;
* `last/memory`, the solver state: the state of its chord tangent, and the L-BFGS pairs (k, count) of
  `corrections` and `changes` since;
* `base` (functions, 2), the displacement at the start of a stage that follows another stage;
* `failure`, where a step found no equilibrium; the attributes of the root hold all else.

While the run is running, and where it was killed, its journal lies beside it (`isopeel.results.journal`).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from errno import EMFILE, ENFILE
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple, get_args
from uuid import uuid4

import h5py
import numpy as np

from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.common.errors import InputError
from isopeel.problem import Column, Problem
from isopeel.results import untrusted
from isopeel.results.curve import Curve
from isopeel.results.fields import Field, Fields
from isopeel.results.files import check_readable, replacing
from isopeel.results.journal import Record, read_journal
from isopeel.results.provenance import Provenance
from isopeel.results.untrusted import UntrustedError
from isopeel.solve.lbfgs import LbfgsPairs
from isopeel.solve.newton import HINTS, Cause
from isopeel.solve.quasi_newton import SolverState
from isopeel.solve.step import KINDS, PARABOLA_POINTS, AcceptedState, State
from isopeel.splines.rows import RowSpace

#: How a run ended; the file of a killed run says "running".
Ending = Literal["running", "completed", "not converged", "interrupted"]

_FORMAT = "isopeel run 6"
_IDENTITY = 16  # bytes
_UNKNOWNS = ("unknown_values", "polished")
#: Maximum openings that are not known.
_UNKNOWN = frozen(np.full((1, 1), np.nan))


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

    `fields` maps the parameter, in the unit of its column, to displacement coefficients (functions, 2): at
    the first step at or beyond each multiple of `field_interval`, and at the last step. `maximum_openings`
    maps it to the maximum openings (E, Q) of an irreversible joint, nan where the file does not hold
    them: those of version 0.1.0 had the openings of the last state alone. `attributes` are those of
    `run_attributes`. Where the run was killed, `journaled` of its steps come from its journal, which is known
    by the `identity` of the file, and `last` is the state before them.
    """

    case_text: str
    curve: Curve
    fields: Mapping[float, FloatArray]
    attributes: Mapping[str, str | int]
    ending: Ending
    failure: Failure | None = None
    last: State | None = None  # from which `trace` continues bit for bit
    base: FloatArray | None = None  # displacement (functions, 2) at the start of a later stage
    field_interval: float = 10.0
    identity: str = field(default_factory=lambda: uuid4().hex)
    journaled: int = 0
    maximum_openings: Mapping[float, FloatArray] = field(default_factory=dict)

    @property
    def states(self) -> dict[float, Field]:
        """The stored displacements with their maximum openings, by parameter."""
        return {at: Field(u, self.maximum_openings.get(at, _UNKNOWN)) for at, u in self.fields.items()}

    def with_states(self, states: Mapping[float, Field]) -> "StoredRun":
        """Return the same run with other displacements and maximum openings."""
        return replace(
            self,
            fields=MappingProxyType({at: one.displacement for at, one in states.items()}),
            maximum_openings=MappingProxyType({at: one.maximum_openings for at, one in states.items()}),
        )

    @property
    def lacks_history(self) -> bool:
        """Whether the maximum openings of a stored field are not known."""
        return any(np.isnan(one.maximum_openings).any() for one in self.states.values())


def run_attributes(problem: Problem, space: RowSpace, provenance: Provenance) -> dict[str, str | int]:
    """Return the attributes of a run: its discretization and provenance; `git_revision` if known."""
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


def write_run(path: Path, run: StoredRun) -> None:
    """Write the file of a run. It has its old content or its new content, never a part. Raises OSError.

    The new content is on the disk before it replaces the old one, also where the machine fails.
    """
    with replacing(path, durable=True) as part:
        part.write_bytes(_image(run))


def read_run(path: Path, *, journal: bool = True) -> StoredRun:
    """Read the file of a run, with the steps of its journal if there are any.

    Neither file is trusted, and nothing outside of them is read. Raises InputError where it is not the file
    of a run.
    """
    try:
        check_readable(path)
        with h5py.File(path, "r") as file:
            if untrusted.attribute(file, "format") != _FORMAT:
                raise UntrustedError("it is not the file of a run of this version")
            run = _stored(file)
        if not journal or run.last is None:
            return run
        maximum_openings = _UNKNOWN if run.last.maximum_openings is None else run.last.maximum_openings
        last = Field(run.last.displacement, maximum_openings)
        return _followed_by(run, read_journal(path, run.identity, run.curve, last))
    except OSError as error:
        if error.errno in (EMFILE, ENFILE):
            raise  # too many open files: not an error of this file
        raise InputError("FILE", str(path), f"the file of a run is needed: {error}") from error
    except (KeyError, ValueError, TypeError, RuntimeError, ArithmeticError) as error:
        raise InputError("FILE", str(path), f"the file of a run is needed: {error}") from error


def _followed_by(run: StoredRun, records: Iterable[Record]) -> StoredRun:
    fields: Fields[Field] = Fields(run.field_interval)
    fields.take_all(run.states)
    rows = []
    for row, taken in records:
        rows.append(row)
        fields.take(float(row.parameter[0]), taken)
    longer = replace(run, curve=run.curve.followed_by(rows), journaled=len(rows))
    return longer.with_states(fields.all())


def _image(run: StoredRun) -> bytes:
    # HDF5 leaves an unreadable file where a disk fills up, so it writes to memory only
    with h5py.File("run.h5", "w", driver="core", backing_store=False) as file:
        file["case"] = run.case_text
        file.attrs.update(
            {"format": _FORMAT, "ending": run.ending, "identity": run.identity, **run.attributes}
        )
        for column, values in _columns(run.curve):
            data = file.create_dataset(f"curve/{column.name}", data=values)
            data.attrs.update({"unit": column.unit, "factor": column.factor, "words": column.words})
        for role in ("parameter", "reaction"):
            file["curve"].attrs[role] = getattr(run.curve, f"{role}_column").name
        file["fields/parameter"] = np.array(list(run.fields), dtype=np.float64)
        file["fields/displacement"] = np.array(list(run.fields.values()) or np.empty((0, 0, 2)))
        maximum_openings = [one.maximum_openings for one in run.states.values()]
        known = [one for one in maximum_openings if not np.isnan(one).any()]
        if any(one.any() for one in known):
            shape = known[0].shape
            file["fields/openings"] = np.array(
                [np.full(shape, np.nan) if np.isnan(one).any() else one for one in maximum_openings]
            )
        file["fields"].attrs["interval"] = run.field_interval
        if run.last is not None:
            _write_state(file.create_group("last"), run.last)
        if run.base is not None:
            file["base"] = run.base
        if run.failure is not None:
            file.create_group("failure").attrs.update(run.failure._asdict())
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def _write_state(group: h5py.Group, state: State) -> None:
    group.attrs["parameter"] = state.parameter
    group["displacement"] = state.displacement
    if state.maximum_openings is not None:
        group["openings"] = state.maximum_openings
    if state.accepted_states:
        parameters, unknowns, *energies, fully_converged = zip(*state.accepted_states, strict=True)
        group["past/parameter"] = np.array(parameters)
        group["past/unknown_values"] = np.array(unknowns)
        group["past/energies"] = np.stack(energies, axis=1)
        # only the last states are ever fully converged
        nothing = np.full_like(unknowns[0], np.nan)
        last = fully_converged[-PARABOLA_POINTS:]
        group["past/polished"] = np.array([nothing if y is None else y for y in last])
    if state.solver_state is not None:
        _write_solver_state(group.create_group("memory"), state.solver_state)


def _state(group: h5py.Group) -> State:
    accepted_states: tuple[AcceptedState, ...] = ()
    if "past" in group:
        stored = untrusted.group(group, "past")
        parameters = untrusted.floats(stored, "parameter", 1).tolist()
        unknowns, fully_converged = ([*map(frozen, untrusted.floats(stored, name, 2))] for name in _UNKNOWNS)
        energies = untrusted.floats(stored, "energies", 2).tolist()
        padded = [np.full(1, np.nan)] * (len(parameters) - len(fully_converged)) + list(fully_converged)
        accepted_states = tuple(
            AcceptedState(parameter, y, energy, rate, adhesive, None if np.isnan(exact).all() else exact)
            for parameter, y, (energy, rate, adhesive), exact in zip(
                parameters, unknowns, energies, padded, strict=True
            )
        )
    return State(
        untrusted.number(group, "parameter"),
        frozen(untrusted.floats(group, "displacement", 2)),
        frozen(untrusted.floats(group, "openings", 2)) if "openings" in group else None,
        accepted_states,
        _solver_state(untrusted.group(group, "memory")) if "memory" in group else None,
    )


def _write_solver_state(group: h5py.Group, solver_state: SolverState) -> None:
    group.attrs.update(
        {"parameter": solver_state.parameter, "steps": solver_state.steps, "slow": solver_state.slow}
    )
    group["unknown_values"] = solver_state.unknown_values
    group["openings"] = solver_state.maximum_openings
    group["corrections"] = solver_state.lbfgs_pairs.corrections.astype(np.float64)
    group["changes"] = solver_state.lbfgs_pairs.changes.astype(np.float64)


def _solver_state(group: h5py.Group) -> SolverState:
    corrections, changes = (untrusted.floats(group, name, 2) for name in ("corrections", "changes"))
    y = untrusted.floats(group, "unknown_values", 1)
    if corrections.shape != changes.shape or corrections.shape[1] != y.size:
        raise UntrustedError(f"{group.name} does not fit together")
    return SolverState(
        y,
        untrusted.number(group, "parameter"),
        frozen(untrusted.floats(group, "openings", 2)),
        LbfgsPairs.of(corrections, changes),
        int(untrusted.number(group, "steps")),
        bool(untrusted.number(group, "slow")),
    )


def _stored(file: h5py.File) -> StoredRun:
    attributes = {name: untrusted.attribute(file, name) for name in file.attrs}
    written_ending, identity = (untrusted.words(file, name) for name in ("ending", "identity"))
    for name in ("format", "ending", "identity"):
        del attributes[name]
    endings: dict[str, Ending] = {ending: ending for ending in get_args(Ending)}
    if written_ending not in endings or len(bytes.fromhex(identity)) != _IDENTITY:
        raise UntrustedError(f"it says that it ended {written_ending!r}, and that it is {identity!r}")
    curve = _stored_curve(untrusted.group(file, "curve"))
    fields = untrusted.group(file, "fields")
    displacements = map(frozen, untrusted.floats(fields, "displacement", 3))
    failure = None
    if "failure" in file:
        found = untrusted.group(file, "failure")
        causes: dict[str, Cause] = {cause: cause for cause in HINTS}
        iterations = np.atleast_1d(untrusted.attribute(found, "iterations")).astype(np.float64)
        failure = Failure(
            untrusted.number(found, "parameter"),
            untrusted.words(found, "reason"),
            tuple(iterations.tolist()),
            causes[untrusted.words(found, "cause")],
        )
    run = StoredRun(
        untrusted.text(file, "case"),
        curve,
        MappingProxyType(
            dict(zip(untrusted.floats(fields, "parameter", 1).tolist(), displacements, strict=True))
        ),
        MappingProxyType(attributes),
        endings[written_ending],
        failure,
        _state(untrusted.group(file, "last")) if "last" in file else None,
        frozen(untrusted.floats(file, "base", 2)) if "base" in file else None,
        untrusted.number(fields, "interval"),
        identity,
    )
    if run.fields:
        run = replace(run, maximum_openings=MappingProxyType(_maximum_openings(fields, run)))
    every = [*run.fields.values(), *([] if run.last is None else [run.last.displacement])]
    if not run.field_interval > 0 or any(u.ndim != 2 or u.shape != (len(every[-1]), 2) for u in every):
        raise UntrustedError("its fields do not fit together")
    return run


def _maximum_openings(group: h5py.Group, run: StoredRun) -> dict[float, FloatArray]:
    """Return the maximum openings (E, Q) by parameter: zero where none are stored, nan where unknown."""
    last = None if run.last is None else run.last.maximum_openings
    if "openings" in group:
        maximum_openings = untrusted.floats(group, "openings", 3)
        if np.isinf(maximum_openings).any() or (
            last is not None and maximum_openings.shape[1:] != last.shape
        ):
            raise UntrustedError("its openings do not fit together")
        return dict(zip(run.fields, map(frozen, maximum_openings), strict=True))
    known = last is not None and not last.any()
    return dict.fromkeys(run.fields, frozen(np.zeros_like(last)) if known else _UNKNOWN)


def _stored_curve(group: h5py.Group) -> Curve:
    columns, main = {}, {}
    for role in ("parameter", "reaction"):
        name = untrusted.words(group, role)
        main[role] = frozen(untrusted.floats(group, name, 1))
        units = group[name]
        unit, words = (untrusted.words(units, key) for key in ("unit", "words"))
        columns[role] = Column(name, unit, untrusted.number(units, "factor"), words)
    iterations = untrusted.whole_numbers(group, "iterations", 1)
    names = ("stored_energy", "adhesive_energy", "dissipated_energy", "released_energy", "seconds")
    others = {name: frozen(untrusted.floats(group, name, 1)) for name in names}
    residuals = frozen(untrusted.floats(group, "energy_residuals", 1))
    kind, negative = (untrusted.whole_numbers(group, name, 1) for name in ("kind", "negative_eigenvalues"))
    lengths = {len(kind), len(negative), len(iterations), *map(len, (*main.values(), *others.values()))}
    if len(lengths) > 1 or (iterations < 0).any() or iterations.sum() != len(residuals):
        raise UntrustedError("the columns of its curve do not fit together")
    if not np.isin(kind, np.arange(len(KINDS))).all():
        raise UntrustedError("a kind of a step is unknown")
    return Curve(
        columns["parameter"],
        columns["reaction"],
        main["parameter"],
        main["reaction"],
        iterations,
        energy_residuals=residuals,
        kind=kind,
        negative_eigenvalues=negative,
        **others,
    )


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
