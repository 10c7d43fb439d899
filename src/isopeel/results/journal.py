"""The journal of a run: the steps since its file was saved, one record each, written when they converge.

To write the whole file at every step would take longer than the step. A record is passed to the operating
system at once, so that a kill loses only the step that is being computed. A resumed path continues from the
file, not from the journal: it computes the journaled steps again, with the same result to the last bit.

Layout: a mark, the identity of the last saved file, and the records. A record has the number of the step,
how many energy residuals and maximum openings it has (no openings if all are zero), the row of the curve, the
displacement, the maximum openings, and a checksum of the record without displacement and openings. After the
file has been saved, new records overwrite the old ones from the beginning; the bytes after the last whole
record have no meaning.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import replace
from math import prod
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from isopeel.results.curve import Curve, arrays_of_curve
from isopeel.results.fields import StoredState
from isopeel.results.files import check_is_file, new_file

_MARK = b"isopeel journal 2\n"
_IDENTITY = 16  # bytes
_HEAD = struct.Struct("<QQQ")
_CHECKSUM = struct.Struct("<Q")


class Record(NamedTuple):
    """A step: its curve of one row, and its state."""

    curve: Curve
    state: StoredState


def journal_path(run_file: Path) -> Path:
    """Return the path of the journal of a run's file."""
    return run_file.with_suffix(".journal")


class Journal:
    """The journal of a run while it is computed. Raises OSError where it cannot be written."""

    def __init__(self, run_file: Path, identity: str) -> None:
        """Begin an empty journal, which replaces an older one."""
        self._path = journal_path(run_file)
        check_is_file(self._path)
        self._path.unlink(missing_ok=True)
        self._file = os.fdopen(new_file(self._path), "wb", buffering=0)
        self._write([_MARK + bytes.fromhex(identity)])
        self._begin = self._file.tell()

    def append(self, record: Record) -> None:
        """Write a step."""
        row, state = record
        u, maximum_openings = map(np.ascontiguousarray, (state.displacement, state.maximum_openings))
        maximum_openings = maximum_openings if maximum_openings.any() else maximum_openings[:0]
        parts = [_HEAD.pack(state.step, len(row.energy_residuals), maximum_openings.size)]
        parts += [getattr(row, name).tobytes() for name in arrays_of_curve()]
        head = b"".join(parts)
        self._write([head, u.data.cast("B"), maximum_openings.tobytes(), _CHECKSUM.pack(zlib.crc32(head))])

    def clear(self) -> None:
        """Delete all records, because the file of the run has these steps now."""
        # truncation would take longer than to write them
        self._file.seek(self._begin)

    def close(self) -> None:
        """Close the journal."""
        self._file.close()

    def remove(self) -> None:
        """Remove the journal, after the file of the run has got all steps."""
        self._path.unlink(missing_ok=True)

    def _write(self, parts: list[bytes | memoryview]) -> None:
        try:
            written = os.writev(self._file.fileno(), parts)
            if written < sum(map(len, parts)):
                # a full disk is reported at the second try only
                rest = memoryview(b"".join(parts))[written:]
                while rest:
                    rest = rest[self._file.write(rest) or 0 :]
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._path)) from error


def read_journal(
    run_file: Path,
    identity: str,
    curve: Curve,
    displacement_shape: tuple[int, ...],
    opening_shape: tuple[int, ...],
) -> Iterator[Record]:
    """Yield the complete records after the file of a run, whose curve and shapes of fields are given."""
    path = journal_path(run_file)
    if not path.is_file():
        return
    columns = arrays_of_curve()
    types = [getattr(curve, name).dtype for name in columns]
    points, size_of_u = prod(opening_shape), prod(displacement_shape)
    # of those that have other than one number in a step
    tables = {"reactions": len(curve.boundaries), "sensitivities": len(curve.sensitive_to)}
    numbers = {**tables, "load_work": min(curve.load_work.size, 1)}
    with path.open("rb") as file:
        if file.read(len(_MARK) + _IDENTITY) != _MARK + bytes.fromhex(identity):
            return
        size, expected = path.stat().st_size, len(curve)
        while len(head := file.read(_HEAD.size)) == _HEAD.size:
            number, numbers["energy_residuals"], opened = _HEAD.unpack(head)
            counts = [numbers.get(name, 1) for name in columns]
            row_size, rest = 8 * sum(counts), 8 * (size_of_u + opened) + _CHECKSUM.size
            if number > expected or file.tell() + row_size + rest > size or opened not in (0, points):
                return
            row, displacement = file.read(row_size), file.read(8 * size_of_u)
            history = np.frombuffer(file.read(8 * opened), np.float64) if opened else np.zeros(points)
            if file.read(_CHECKSUM.size) != _CHECKSUM.pack(zlib.crc32(head + row)):
                return
            if number < expected:
                continue  # the file was saved, and the journal not yet begun anew
            places = np.cumsum([0, *counts[:-1]])
            values: dict[str, Any] = {
                name: np.frombuffer(row, dtype, count, 8 * place)
                for name, dtype, count, place in zip(columns, types, counts, places, strict=True)
            }
            values |= {name: values[name].reshape(1, width) for name, width in tables.items()}
            row_read = replace(curve, **values)
            yield Record(
                row_read,
                StoredState(
                    number,
                    float(row_read.parameter[0]),
                    np.frombuffer(displacement, np.float64).reshape(displacement_shape),
                    history.reshape(opening_shape),
                ),
            )
            expected += 1
