"""The journal of a run: the steps since its file was saved, one record each, as soon as they have converged.

Writing the whole file at every step would take longer than the step. A record is handed to the operating
system at once, so that a kill loses nothing but the step in flight; what was cut off in the middle of its
last record is recognised by length and checksum. The path goes on from the file, not from the journal:
making its steps again gives the same to the last bit, in the time that they took.

Layout: a mark, the identity of the file that it goes on from, and the records: their length and checksum;
the number of the step, the number of its energy residuals, its row of the curve, its displacement.
"""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import NamedTuple

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.results.curve import Curve

_MARK = b"isopeel journal 1\n"
_IDENTITY = 16  # bytes
_FRAME = struct.Struct("<QI")
_HEAD = struct.Struct("<QQ")


class Record(NamedTuple):
    """A step: its curve of one row, and its displacement (functions, 2)."""

    curve: Curve
    displacement: FloatArray


def journal_path(run_file: Path) -> Path:
    """Where the journal of a run's file is."""
    return run_file.with_suffix(".journal")


class Journal:
    """The journal of a run that is under way. Raises OSError where it cannot be written."""

    def __init__(self, run_file: Path, identity: str) -> None:
        """Begin an empty one, in place of another."""
        self._path = journal_path(run_file)
        self._file = self._path.open("wb")
        self._begin = len(_MARK) + _IDENTITY
        self._file.write(_MARK + bytes.fromhex(identity))
        self._file.flush()

    def append(self, number: int, record: Record) -> None:
        """Write a step, the one of this number from zero on."""
        row = record.curve
        parts = [_HEAD.pack(number, len(row.energy_residuals))]
        parts += [np.ascontiguousarray(getattr(row, name)).tobytes() for name in _columns(row)]
        parts.append(record.displacement.tobytes())
        payload = b"".join(parts)
        try:
            self._file.write(_FRAME.pack(len(payload), zlib.crc32(payload)) + payload)
            self._file.flush()
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._path)) from error

    def clear(self) -> None:
        """Forget all records: the run's file holds them now."""
        self._file.seek(self._begin)
        self._file.truncate()

    def remove(self) -> None:
        """End it."""
        try:
            self._file.close()
        finally:
            self._path.unlink(missing_ok=True)


def read_journal(run_file: Path, identity: str, curve: Curve, functions: int) -> Iterator[Record]:
    """Yield the whole records that go on from a run's file, whose curve and number of functions are given."""
    path = journal_path(run_file)
    if not path.is_file():
        return
    with path.open("rb") as file:
        if file.read(len(_MARK) + _IDENTITY) != _MARK + bytes.fromhex(identity):
            return
        size, expected = path.stat().st_size, len(curve)
        while len(frame := file.read(_FRAME.size)) == _FRAME.size:
            length, checksum = _FRAME.unpack(frame)
            if length < _HEAD.size or file.tell() + length > size:
                return
            payload = file.read(length)
            if len(payload) < length or zlib.crc32(payload) != checksum:
                return
            number, residuals = _HEAD.unpack_from(payload)
            if number < expected:
                continue  # the file was saved, and the journal not yet cleared
            record = _record(payload[_HEAD.size :], residuals, curve, functions)
            if number > expected or record is None:
                return
            yield record
            expected += 1


def _record(payload: bytes, residuals: int, curve: Curve, functions: int) -> Record | None:
    """Take a record apart; None where its length is another one."""
    columns = _columns(curve)
    counts = [residuals if name == "energy_residuals" else 1 for name in columns]
    types = [getattr(curve, name).dtype for name in columns]
    if len(payload) != 8 * (sum(counts) + 2 * functions):
        return None
    values, place = {}, 0
    for name, count, dtype in zip(columns, counts, types, strict=True):
        values[name] = np.frombuffer(payload, dtype, count, place)  # read-only, as the payload is
        place += 8 * count
    displacement = np.frombuffer(payload, np.float64, 2 * functions, place)
    row = Curve(curve.parameter_column, curve.reaction_column, **values)
    return Record(row, displacement.reshape(functions, 2))


def _columns(curve: Curve) -> list[str]:
    return [field.name for field in fields(curve) if isinstance(getattr(curve, field.name), np.ndarray)]
