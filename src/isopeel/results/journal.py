"""The journal of a run: the steps since its file was saved, one record each, as soon as they have converged.

Writing the whole file at every step would take longer than the step. A record is handed to the operating
system at once, so that a kill loses nothing but the step in flight. The path goes on from the file, not from
the journal: making its steps again gives the same to the last bit, in the time that they took.

Layout: a mark, the identity of the file that it goes on from, and the records: the number of the step, the
numbers of its energy residuals and of its openings, which are left out where all are zero, its row of the
curve, its displacement, its openings, and a checksum of all but the latter two, which is written last. Where
the file has been saved, records are written from the beginning again, over those that it holds by then: what
follows the last whole one is of no meaning.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from isopeel.results.curve import Curve
from isopeel.results.fields import Field
from isopeel.results.files import check_is_file, new_file

_MARK = b"isopeel journal 2\n"
_IDENTITY = 16  # bytes
_HEAD = struct.Struct("<QQQ")
_CHECKSUM = struct.Struct("<Q")


class Record(NamedTuple):
    """A step: its curve of one row, its displacement (functions, 2) and its maximum openings (E, Q)."""

    curve: Curve
    field: Field


def journal_path(run_file: Path) -> Path:
    """Where the journal of a run's file is."""
    return run_file.with_suffix(".journal")


class Journal:
    """The journal of a run that is under way. Raises OSError where it cannot be written."""

    def __init__(self, run_file: Path, identity: str) -> None:
        """Begin an empty one, in place of another."""
        self._path = journal_path(run_file)
        check_is_file(self._path)
        self._path.unlink(missing_ok=True)
        self._file = os.fdopen(new_file(self._path), "wb", buffering=0)
        self._write([_MARK + bytes.fromhex(identity)])
        self._begin = self._file.tell()

    def append(self, number: int, record: Record) -> None:
        """Write a step, the one of this number from zero on."""
        row = record.curve
        u, maximum_openings = (np.ascontiguousarray(array) for array in record.field)
        maximum_openings = maximum_openings if maximum_openings.any() else maximum_openings[:0]
        parts = [_HEAD.pack(number, len(row.energy_residuals), maximum_openings.size)]
        parts += [getattr(row, name).tobytes() for name in _columns()]
        head = b"".join(parts)
        self._write([head, u.data.cast("B"), maximum_openings.tobytes(), _CHECKSUM.pack(zlib.crc32(head))])

    def clear(self) -> None:
        """Forget all records: the run's file holds them now."""
        # without a truncation, which would take longer than to write them
        self._file.seek(self._begin)

    def close(self) -> None:
        """End it."""
        self._file.close()

    def remove(self) -> None:
        """Remove it, once the run's file holds all."""
        self._path.unlink(missing_ok=True)

    def _write(self, parts: list[bytes | memoryview]) -> None:
        try:
            written = os.writev(self._file.fileno(), parts)
            if written < sum(map(len, parts)):
                # a disk that fills up says so at the second try only
                rest = memoryview(b"".join(parts))[written:]
                while rest:
                    rest = rest[self._file.write(rest) or 0 :]
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._path)) from error


def read_journal(run_file: Path, identity: str, curve: Curve, last: Field) -> Iterator[Record]:
    """Yield the whole records that go on from a run's file, whose curve and last field are given."""
    path = journal_path(run_file)
    if not path.is_file():
        return
    columns = _columns()
    types = [getattr(curve, name).dtype for name in columns]
    points = last.maximum_openings.size
    with path.open("rb") as file:
        if file.read(len(_MARK) + _IDENTITY) != _MARK + bytes.fromhex(identity):
            return
        size, expected = path.stat().st_size, len(curve)
        while len(head := file.read(_HEAD.size)) == _HEAD.size:
            number, residuals, opened = _HEAD.unpack(head)
            counts = [residuals if name == "energy_residuals" else 1 for name in columns]
            row_size, rest = 8 * sum(counts), 8 * (last.displacement.size + opened) + _CHECKSUM.size
            if number > expected or file.tell() + row_size + rest > size or opened not in (0, points):
                return
            row, displacement = file.read(row_size), file.read(8 * last.displacement.size)
            history = np.frombuffer(file.read(8 * opened), np.float64) if opened else np.zeros(points)
            if file.read(_CHECKSUM.size) != _CHECKSUM.pack(zlib.crc32(head + row)):
                return
            if number < expected:
                continue  # the file was saved, and the journal not yet begun anew
            places = np.cumsum([0, *counts[:-1]])
            values = {
                name: np.frombuffer(row, dtype, count, 8 * place)
                for name, dtype, count, place in zip(columns, types, counts, places, strict=True)
            }
            yield Record(
                Curve(curve.parameter_column, curve.reaction_column, **values),
                Field(
                    np.frombuffer(displacement, np.float64).reshape(last.displacement.shape),
                    history.reshape(last.maximum_openings.shape),
                ),
            )
            expected += 1


@cache
def _columns() -> tuple[str, ...]:
    """The columns of a curve that hold numbers."""
    return tuple(field.name for field in fields(Curve) if not field.name.endswith("_column"))
