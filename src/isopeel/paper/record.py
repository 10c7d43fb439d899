"""The records of runs that the report needs: short curves and provenance, in one file."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import radians
from pathlib import Path

import h5py
import numpy as np

from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.errors import InputError
from isopeel.paper.study import SPACES, STEP, VARIANT_MESH, Run
from isopeel.post.front import front_profile, process_zone
from isopeel.results.files import replacing
from isopeel.results.provenance import PACKAGES
from isopeel.results.run_file import StoredRun
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import State
from isopeel.solve.trace import trace

_FORMAT = "isopeel paper 2"


#: The angle at which the tractions at the front are evaluated, in degrees: on the plateau, with stored
#: fields.
FRONT_DEG = 100.0
_NEAR = 10.0  # L0: the traction is stored up to this distance on both sides of the peak


@dataclass(frozen=True, eq=False)
class Front:
    """The tractions at the front of one state, in E0 and L0."""

    process_zone: float  # full width at half maximum of the attraction
    jump: float  # largest jump of the body's traction between two elements
    half_wave: float  # behind the front, from the second to the third zero of the adhesive traction
    position: FloatArray  # (n,) along the face, around the peak
    traction: FloatArray  # (n,) adhesive

    @classmethod
    def of(cls, run: Run, stored: StoredRun) -> "Front | None":
        """Return the front at FRONT_DEG; None if the run ended before, or is not compared."""
        if run.base is not None or run.space not in SPACES or run.mesh != VARIANT_MESH:
            return None
        if not stored.states:
            return None
        case, state = run.case, stored.nearest(FRONT_DEG)
        if abs(state.parameter - FRONT_DEG) >= STEP / 2:
            return None
        profile = front_profile(case.problem(), case.space(), state.displacement)
        zone = process_zone(profile)
        if zone is None:
            return None
        body, position, traction = (
            profile.body_traction,
            profile.position.ravel(),
            profile.adhesive_traction.ravel(),
        )
        zeros = _zeros(position, traction)
        near = np.abs(position - zone.position) < _NEAR
        return cls(
            zone.length,
            float(np.abs(body[1:, 0] - body[:-1, -1]).max()),
            float(zeros[-2] - zeros[-3]),
            frozen(position[near]),
            frozen(traction[near]),
        )


def _zeros(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the places at which a curve crosses zero, by linear interpolation."""
    k = np.flatnonzero(y[:-1] * y[1:] < 0)
    zeros: FloatArray = x[k] - y[k] * (x[k + 1] - x[k]) / (y[k + 1] - y[k])
    return zeros


@dataclass(frozen=True, eq=False)
class Record:
    """A finished run: its curve in E0 L0^3 over degrees, its cost, its ending and its provenance.

    Its angles are the first ones of the run.
    """

    run: Run
    angles_deg: FloatArray  # (steps,)
    moments: FloatArray  # (steps,)
    dofs: int
    corrections: int  # of Newton's method, in all
    seconds: float  # wall time of all steps
    step_seconds: float  # median of the steps, which other programs disturb less than the mean; nan if none
    step_corrections: float  # mean of the steps; nan if none
    failed_at_deg: float | None  # the angle at which no equilibrium was found
    reason: str  # of the failure; empty if the run is complete
    started: str  # UTC, ISO 8601
    software: str  # versions
    platform: str
    revision: str  # of the source; empty outside of a checkout
    front: Front | None
    continues: bool | None  # after a failure: whether the same step converges from the last state alone

    @classmethod
    def of(cls, run: Run, stored: StoredRun) -> "Record":
        """Return the record of a stored run."""
        attributes = {name: str(value) for name, value in stored.attributes.items()}
        names = ("isopeel", "python", *PACKAGES)
        curve = stored.curve
        return cls(
            run,
            curve.parameter,
            curve.reaction,
            int(attributes["dofs"]),
            int(curve.iterations.sum()),
            float(curve.seconds.sum()),
            float(np.median(curve.seconds)) if len(curve) else np.nan,
            float(curve.iterations.mean()) if len(curve) else np.nan,
            stored.failure.parameter if stored.failure else None,
            stored.failure.reason if stored.failure else "",
            attributes["started"],
            ", ".join(f"{name} {attributes[f'version_{name}']}" for name in names),
            attributes["platform"],
            attributes.get("git_revision", ""),
            Front.of(run, stored),
            _continues(run, stored),
        )

    @property
    def ended(self) -> str | None:
        """Place and reason of an early end, in one line; None if the run is complete."""
        if self.failed_at_deg is None:
            return None
        return f"no equilibrium was found at {self.failed_at_deg:.1f} degrees: {self.reason}"

    @property
    def reached_deg(self) -> float:
        """The last angle; if there is no step, the angle before the first one."""
        return float(self.angles_deg[-1]) if len(self.angles_deg) else self.run.range_deg[0]


def _continues(run: Run, stored: StoredRun) -> bool | None:
    """Return whether the failed step converges from the last state, without an extrapolation."""
    if stored.failure is None or not stored.states:
        return None
    case, last = run.case, stored.states[-1]
    start = [State(radians(last.parameter), last.displacement)]
    points = case.discretization.contact_points
    angle, settings = radians(stored.failure.parameter), NewtonSettings(plain=True)
    try:
        list(trace(case.problem(), case.space(), [angle], settings, start=start, contact_points=points))
    except ConvergenceError:
        return False
    return True


_COMPRESSED = {"compression": "gzip", "shuffle": True}
_TEXTS = ("reason", "started", "software", "platform", "revision")
_NUMBERS = ("dofs", "corrections", "seconds", "step_seconds", "step_corrections")


def write_records(path: Path, records: Mapping[Run, Record]) -> None:
    """Write records to one HDF5 file, which has its old content or its new one. Raises OSError."""
    with h5py.File("records.h5", "w", driver="core", backing_store=False, libver="latest") as file:
        file.attrs["format"] = _FORMAT
        for run, record in records.items():
            group = file.create_group(run.name)
            group.attrs.update({"space": run.space, "mesh": run.mesh, "traction": run.traction})
            group.attrs.update({"timed": run.timed, "plain": run.plain})
            if run.contact_points is not None:
                group.attrs["contact_points"] = run.contact_points
            if record.failed_at_deg is not None:
                group.attrs["failed_at_deg"] = record.failed_at_deg
            if record.continues is not None:
                group.attrs["goes_on"] = record.continues
            if record.front is not None:
                front = group.create_group("front")
                for part in fields(Front):
                    value = getattr(record.front, part.name)
                    front.create_dataset(part.name, data=value, **(_COMPRESSED if np.ndim(value) else {}))
            group.attrs.update({name: getattr(record, name) for name in (*_TEXTS, *_NUMBERS)})
            group.create_dataset("moments", data=record.moments, **_COMPRESSED)
        file.flush()
        image = file.id.get_file_image()
    with replacing(path) as temporary:
        temporary.write_bytes(image)


def read_records(path: Path) -> dict[Run, Record]:
    """Read the records of a file. Raises InputError where it is not one."""
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != _FORMAT:
                raise InputError("FILE", str(path), "it has no runs of a report")
            records = [_record(group) for group in file.values()]
    except (OSError, KeyError) as error:
        raise InputError("FILE", str(path), f"the runs of a report are needed: {error}") from error
    return {record.run: record for record in records}


def _record(group: h5py.Group) -> Record:
    attributes = group.attrs
    points = attributes.get("contact_points")
    failed = attributes.get("failed_at_deg")
    front = group.get("front")
    run = Run(
        attributes["space"],
        attributes["mesh"],
        attributes["traction"],
        None if points is None else int(points),
        bool(attributes["timed"]),
        bool(attributes["plain"]),
    )
    moments = frozen(group["moments"][()])
    return Record(
        run=run,
        angles_deg=frozen(run.angles_deg[: len(moments)]),
        moments=moments,
        dofs=int(attributes["dofs"]),
        corrections=int(attributes["corrections"]),
        seconds=float(attributes["seconds"]),
        step_seconds=float(attributes["step_seconds"]),
        step_corrections=float(attributes["step_corrections"]),
        failed_at_deg=None if failed is None else float(failed),
        front=None if front is None else Front(*(front[part.name][()] for part in fields(Front))),
        continues=bool(attributes["goes_on"]) if "goes_on" in attributes else None,
        **{name: attributes[name] for name in _TEXTS},
    )
