"""What the report needs of the runs: their curves in short, and where they come from; in one file."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import h5py
import numpy as np

from isopeel.arrays import FloatArray, frozen
from isopeel.errors import InputError
from isopeel.paper.study import STEP, Run
from isopeel.post.front import front_profile, process_zone
from isopeel.results.files import replacing
from isopeel.results.provenance import PACKAGES
from isopeel.results.run_file import StoredRun

_FORMAT = "isopeel paper 1"


#: Where the tractions at the front are looked at, in degrees: on the plateau, and kept in the files.
FRONT_DEG = 100.0


@dataclass(frozen=True)
class Front:
    """The tractions at the front."""

    process_zone: float  # full width at half maximum of the attraction, in L0
    jump: float  # largest jump of the body's traction between two elements, in E0

    @classmethod
    def of(cls, run: Run, stored: StoredRun) -> "Front | None":
        """Look at them at FRONT_DEG; None where the run did not get there."""
        displacement = next(
            (u for angle, u in stored.fields.items() if abs(angle - FRONT_DEG) < STEP / 2), None
        )
        if displacement is None:
            return None
        case = run.case
        profile = front_profile(case.problem(), case.space(), displacement)
        zone = process_zone(profile)
        body = profile.body_traction
        return None if zone is None else cls(zone.length, float(np.abs(body[1:, 0] - body[:-1, -1]).max()))


@dataclass(frozen=True, eq=False)
class Record:
    """A finished run: its curve in E0 L0^3 over degrees, what it cost, how it ended and what computed it."""

    run: Run
    angles_deg: FloatArray  # (steps,)
    moments: FloatArray  # (steps,)
    dofs: int
    corrections: int  # of Newton's method, in all
    seconds: float  # wall time of all steps
    step_seconds: float  # of the median step, which other programs disturb less
    failed_at_deg: float | None  # where no equilibrium was found, if so
    reason: str  # why not; empty where the run is complete
    started: str  # UTC, ISO 8601
    software: str  # versions
    platform: str
    revision: str  # of the source; empty outside of a checkout
    front: Front | None

    @classmethod
    def of(cls, run: Run, stored: StoredRun) -> "Record":
        """Shorten what is stored of a run."""
        attributes = {name: str(value) for name, value in stored.attributes.items()}
        names = ("isopeel", "python", *PACKAGES)
        return cls(
            run,
            stored.curve.parameter,
            stored.curve.reaction,
            int(attributes["dofs"]),
            int(stored.curve.iterations.sum()),
            float(stored.curve.seconds.sum()),
            float(np.median(stored.curve.seconds)) if len(stored.curve) else 0.0,
            stored.failure.parameter if stored.failure else None,
            stored.failure.reason if stored.failure else "",
            attributes["started"],
            ", ".join(f"{name} {attributes[f'version_{name}']}" for name in names),
            attributes["platform"],
            attributes.get("git_revision", ""),
            Front.of(run, stored) if run.base is None else None,
        )

    @property
    def ended(self) -> str | None:
        """Where and why the run ended early, in one line; None where it is complete."""
        if self.failed_at_deg is None:
            return None
        return f"no equilibrium at {self.failed_at_deg:.1f} degrees: {self.reason}"


_TEXTS = ("reason", "started", "software", "platform", "revision")
_NUMBERS = ("dofs", "corrections", "seconds", "step_seconds")


def write_records(path: Path, records: Mapping[Run, Record]) -> None:
    """Write records to one HDF5 file, which has its old content or its new one. Raises OSError."""
    with h5py.File("records.h5", "w", driver="core", backing_store=False) as file:
        file.attrs["format"] = _FORMAT
        for run, record in records.items():
            group = file.create_group(run.name)
            group.attrs.update({"space": run.space, "mesh": run.mesh, "traction": run.traction})
            if run.contact_points is not None:
                group.attrs["contact_points"] = run.contact_points
            if record.failed_at_deg is not None:
                group.attrs["failed_at_deg"] = record.failed_at_deg
            if record.front is not None:
                group.attrs.update({f"front_{name}": value for name, value in asdict(record.front).items()})
            group.attrs.update({name: getattr(record, name) for name in (*_TEXTS, *_NUMBERS)})
            for name in ("angles_deg", "moments"):
                group.create_dataset(name, data=getattr(record, name), compression="gzip", shuffle=True)
        file.flush()
        image = file.id.get_file_image()
    with replacing(path) as part:
        part.write_bytes(image)


def read_records(path: Path) -> dict[Run, Record]:
    """Read the records of a file. Raises InputError where it is not one."""
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != _FORMAT:
                raise InputError("FILE", str(path), "it does not hold the runs of a report")
            records = [_record(group) for group in file.values()]
    except (OSError, KeyError) as error:
        raise InputError("FILE", str(path), f"the runs of a report are needed: {error}") from error
    return {record.run: record for record in records}


def _record(group: h5py.Group) -> Record:
    attributes = group.attrs
    points = attributes.get("contact_points")
    failed = attributes.get("failed_at_deg")
    front = [attributes.get(f"front_{part.name}") for part in fields(Front)]
    return Record(
        run=Run(
            attributes["space"],
            attributes["mesh"],
            attributes["traction"],
            None if points is None else int(points),
        ),
        angles_deg=frozen(group["angles_deg"][()]),
        moments=frozen(group["moments"][()]),
        dofs=int(attributes["dofs"]),
        corrections=int(attributes["corrections"]),
        seconds=float(attributes["seconds"]),
        step_seconds=float(attributes["step_seconds"]),
        failed_at_deg=None if failed is None else float(failed),
        front=Front(*map(float, front)) if all(front) else None,
        **{name: attributes[name] for name in _TEXTS},
    )
