"""The data sets of run.h5: their types, shapes, units, descriptions and checksums.

The writer and the reader use one table. The writer stores the unit and the description with each data set;
the reader rejects a file that differs from the table. A checksum (CRC-32) of each data set detects bits that
have changed.
"""

import re
import zlib
from collections.abc import Mapping
from typing import Literal, NamedTuple

import h5py
import numpy as np

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.results import untrusted
from isopeel.results.untrusted import UntrustedError

#: Attribute of each data set.
_CHECKSUM = "checksum"
#: Characters that names, units and labels may not contain: a figure could read them as mathematics, or a
#: terminal as a command. They are removed on reading, because the drive of a plug-in may have them.
_FORBIDDEN = re.compile(r"[^\w ,.()'/%^*°·-]")
#: A label: words and one symbol.
_LABEL = re.compile(r"[\w ,.()'/-]*(\$\\?[A-Za-z_]{1,20}\$)?")
_LONGEST = 1000  # characters of an attribute


class DataSet(NamedTuple):
    """One data set: its type, the names of its sizes, unit and meaning.

    Sizes of the same name are the same in all data sets of a file. Values are finite, unless declared
    otherwise.
    """

    type: Literal["float", "integer", "text"]
    shape: tuple[str | int, ...]
    unit: str
    description: str
    required: bool = True
    finite: bool = True


#: All data sets but those of the solver, the spaces and the histories of interfaces, whose number varies.
SCHEMA: dict[str, DataSet] = {
    "case": DataSet("text", (), "", "the case file, in TOML"),
    "curve/parameter": DataSet("float", ("steps",), "", "parameter of the drive"),
    "curve/reaction": DataSet("float", ("steps",), "", "reaction to the drive, for a width of L0"),
    "curve/reactions": DataSet(
        "float",
        ("steps", "boundaries"),
        "",
        "reaction of each boundary, of a drive that acts on several",
        required=False,
    ),
    "curve/iterations": DataSet("integer", ("steps",), "1", "corrections of the step"),
    "curve/stored_energy": DataSet("float", ("steps",), "E0 L0^3", "strain energy of the body"),
    "curve/adhesive_energy": DataSet("float", ("steps",), "E0 L0^3", "energy of the interface, 0 far away"),
    "curve/dissipated_energy": DataSet("float", ("steps",), "E0 L0^3", "energy dissipated by damage"),
    "curve/released_energy": DataSet("float", ("steps",), "E0 L0^3", "energy released by jumps"),
    "curve/load_work": DataSet(
        "float", ("steps",), "E0 L0^3", "work of the loads that are held", required=False
    ),
    "curve/sensitivities": DataSet(
        "float",
        ("steps", "parameters"),
        "",
        "derivatives of the reaction by parameters of the case, of its unit per units of these; NaN: none",
        required=False,
        finite=False,
    ),
    "curve/sensitive_to": DataSet(
        "float", ("parameters",), "", "values of these parameters, in their units in the case", required=False
    ),
    "curve/seconds": DataSet("float", ("steps",), "s", "wall time of the step"),
    "curve/energy_residuals": DataSet(
        "float", ("corrections",), "E0 L0^3", "energy residual per unknown before each correction, all steps"
    ),
    "curve/kind": DataSet(
        "integer", ("steps",), "1", "0 requested, 1 between, 2 limit point, 3 jump, 4 bifurcation"
    ),
    "curve/negative_eigenvalues": DataSet(
        "integer", ("steps",), "1", "negative eigenvalues of the tangent, -1 where not counted"
    ),
    "fields/step": DataSet("integer", ("fields",), "1", "number of the step, its row in the curve"),
    "fields/displacement": DataSet(
        "float", ("fields", "functions", 2), "L0", "displacement coefficients in the `spaces` of the bodies"
    ),
    "last/displacement": DataSet(
        "float", ("functions", 2), "L0", "displacement coefficients of the last step", required=False
    ),
    "last/maximum_openings": DataSet(
        "float",
        ("elements", "points"),
        "L0",
        "maximum openings at the last step; with a joint law, its variables in their units",
        required=False,
    ),
    "base": DataSet(
        "float", ("functions", 2), "L0", "displacement that this stage began with", required=False
    ),
    "failure/iterations": DataSet(
        "float",
        ("attempts",),
        "E0 L0^3",
        "energy residual per unknown before each correction of the step that failed",
        required=False,
        finite=False,
    ),
}


def checksum(values: FloatArray | IntArray | bytes) -> int:
    """CRC-32 of numbers in memory, or of a text in UTF-8."""
    return zlib.crc32(values if isinstance(values, bytes) else np.ascontiguousarray(values).data.cast("B"))


def write(
    file: h5py.Group, path: str, values: FloatArray | IntArray | str, **attributes: str | float
) -> None:
    """Write a data set of the schema with its unit, description, checksum and further attributes."""
    one = SCHEMA[path]
    write_described(file, path, values, **{"unit": one.unit, "description": one.description, **attributes})


def write_described(
    file: h5py.Group, path: str, values: FloatArray | IntArray | str, **attributes: str | float
) -> None:
    """Write any data set with its checksum and attributes."""
    data = file.create_dataset(path, data=values)
    bits = values.encode() if isinstance(values, str) else values
    data.attrs.update({**attributes, _CHECKSUM: checksum(bits) if len(bits) else 0})


class Read(NamedTuple):
    """The content of a file by the schema: its arrays by their paths, and its case."""

    arrays: Mapping[str, FloatArray | IntArray]
    case: str

    def floats(self, path: str) -> FloatArray:
        """Numbers of double precision."""
        return np.asarray(self.arrays[path], dtype=np.float64)

    def get(self, path: str) -> FloatArray | None:
        """The same, None where the file has none."""
        return self.floats(path) if path in self.arrays else None

    def integers(self, path: str) -> IntArray:
        """Whole numbers."""
        return np.asarray(self.arrays[path], dtype=np.int64)


def read(file: h5py.File) -> Read:
    """Read all data sets of the schema. Raises UntrustedError if one is missing or does not fit."""
    arrays: dict[str, FloatArray | IntArray] = {}
    sizes: dict[str, int] = {}
    case = ""
    for path, one in SCHEMA.items():
        parent, name = _parent(file, path, one)
        if parent is None:
            continue
        if one.type == "text":
            case = untrusted.text(parent, name)
            _check_bits(parent[name], case.encode())
            continue
        take = untrusted.floats if one.type == "float" else untrusted.whole_numbers
        values = take(parent, name, len(one.shape))
        for size, wanted in zip(values.shape, one.shape, strict=True):
            expected = wanted if isinstance(wanted, int) else sizes.setdefault(wanted, size)
            if size != expected:
                raise UntrustedError(f"{path} has the shape {values.shape}, where {wanted} is {expected}")
        check_values(parent[name], values, finite=one.finite)
        values.setflags(write=False)
        arrays[path] = values
    return Read(arrays, case)


def check_values(data: h5py.Dataset, values: FloatArray | IntArray, *, finite: bool) -> None:
    """Check the bits of numbers, and that they are finite. Raises UntrustedError."""
    _check_bits(data, values)
    if finite and not np.isfinite(values).all():
        raise UntrustedError(f"{data.name} has numbers that are not finite")


def label(of: h5py.Group | h5py.Dataset, name: str) -> str:
    """Return an attribute that is a name, a unit or a label, without characters that are not allowed."""
    value = text_attribute(of, name)
    return value if _LABEL.fullmatch(value) else plain(value)


def plain(text: str) -> str:
    """Return a text without characters that are not allowed in names and units."""
    return _FORBIDDEN.sub("", text)


def text_attribute(of: h5py.Group | h5py.Dataset, name: str) -> str:
    """Return an attribute that is a text of some length. Raises UntrustedError."""
    value = untrusted.words(of, name)
    if len(value) > _LONGEST:
        raise UntrustedError(f"{name} of {of.name} is too long")
    return value


def _parent(file: h5py.File, path: str, one: DataSet) -> tuple[h5py.Group | None, str]:
    """Return the group of a data set, None if it is missing and may be, and the name in the group."""
    *groups, name = path.split("/")
    parent: h5py.Group = file
    for part in groups:
        if not one.required and part not in parent:
            return None, name
        parent = untrusted.group(parent, part)
    return (None if not one.required and name not in parent else parent), name


def _check_bits(data: h5py.Dataset, values: FloatArray | IntArray | bytes) -> None:
    if untrusted.number(data, _CHECKSUM) != (checksum(values) if len(values) else 0):
        raise UntrustedError(f"the bits of {data.name} have changed: its checksum differs")
