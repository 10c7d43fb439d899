"""The reaction curve: one row per converged step."""

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.problem import Column, Drive
from isopeel.problem.boundary import boundary_names, driven_boundaries
from isopeel.results.files import replacing
from isopeel.solve.step import KINDS, Step


class DifferentiatedBy(NamedTuple):
    """A parameter of sensitivities: its key in the case, its value there, and the unit of this value."""

    key: str
    value: float
    unit: str  # empty for a plain number


@dataclass(frozen=True, eq=False)
class Curve:
    """The reaction over the parameter of the drive, both in the units of their columns.

    If the drive acts on several boundaries, `reactions` has a column for each, with a name as `upper.right`.
    Energies and reactions are for a width of L0, the unit of length of the problem; E0 is its unit of stress.

    `sensitivities` are the derivatives of the reaction, in the unit of its column, by the `sensitive_to`
    parameters, at a fixed parameter of the drive; NaN where there is none, as at a limit point.
    """

    parameter_column: Column
    reaction_column: Column
    parameter: FloatArray
    reaction: FloatArray
    iterations: IntArray
    stored_energy: FloatArray
    adhesive_energy: FloatArray
    dissipated_energy: FloatArray
    released_energy: FloatArray  # in jumps
    seconds: FloatArray
    energy_residuals: FloatArray  # per unknown, of the corrections of all steps, one step after the other
    kind: IntArray  # numbers of KINDS
    negative_eigenvalues: IntArray  # of the tangent: 0 in a stable state, -1 where not counted
    boundaries: tuple[str, ...] = ()
    reactions: FloatArray = field(default_factory=lambda: np.empty((0, 0)))  # (steps, boundaries)
    load_work: FloatArray = field(default_factory=lambda: np.empty(0))  # of held loads; none without any
    sensitive_to: tuple[DifferentiatedBy, ...] = ()
    sensitivities: FloatArray = field(default_factory=lambda: np.empty((0, 0)))  # (steps, parameters)

    @classmethod
    def of(
        cls, steps: Iterable[Step], drive: Drive, sensitive_to: tuple[DifferentiatedBy, ...] = ()
    ) -> "Curve":
        """Tabulate steps, whose sensitivities are those to the given parameters."""
        steps = list(steps)
        rows = [
            (
                s.parameter,
                s.reaction,
                s.stored_energy,
                s.adhesive_energy,
                s.dissipated_energy,
                s.released_energy,
                s.seconds,
                len(s.iterations),
                KINDS.index(s.kind),
                -1 if s.negative_eigenvalues is None else s.negative_eigenvalues,
            )
            for s in steps
        ]
        table = np.array(rows, dtype=np.float64).reshape(len(rows), 10)
        parameter = [drive.parameter_column.shown(value) for value in table[:, 0]]
        names = boundaries_of(drive)
        reactions = np.array([s.reactions for s in steps], dtype=np.float64).reshape(len(steps), len(names))
        rates = np.array([s.sensitivities for s in steps], dtype=np.float64).reshape(
            len(steps), len(sensitive_to)
        )
        work = [s.load_work for s in steps if s.load_work is not None]
        return cls(
            drive.parameter_column,
            drive.reaction_column,
            frozen(np.array(parameter, dtype=np.float64)),
            frozen(table[:, 1] * drive.reaction_column.factor),
            table[:, 7].astype(np.int64),
            frozen(table[:, 2]),
            frozen(table[:, 3]),
            frozen(table[:, 4]),
            frozen(table[:, 5]),
            frozen(table[:, 6]),
            frozen(np.array([residual for s in steps for residual in s.iterations], dtype=np.float64)),
            table[:, 8].astype(np.int64),
            table[:, 9].astype(np.int64),
            names,
            frozen(reactions * drive.reaction_column.factor),
            frozen(np.array(work, dtype=np.float64)),
            sensitive_to,
            frozen(rates * drive.reaction_column.factor),
        )

    def followed_by(self, others: Iterable["Curve"]) -> "Curve":
        """Return the curve with the rows of other curves of the same columns appended."""
        curves = [self, *others]
        joined: dict[str, Any] = {
            name: np.concatenate([getattr(curve, name) for curve in curves]) for name in arrays_of_curve()
        }
        for column in joined.values():
            column.setflags(write=False)
        return replace(self, **joined)

    def __len__(self) -> int:
        """Number of steps."""
        return len(self.parameter)

    @property
    def boundary_columns(self) -> tuple[Column, ...]:
        """How the reactions of the boundaries are tabulated."""
        one = self.reaction_column
        return tuple(replace(one, name=name, words=f"{one.words} at {name}") for name in self.boundaries)

    def residuals_of(self, step: int) -> FloatArray:
        """Return the energy residuals per unknown, |R . dz|/n, before each Newton correction of a step."""
        ends = np.cumsum(self.iterations)
        return self.energy_residuals[ends[step] - self.iterations[step] : ends[step]]

    def table(self) -> tuple[tuple[Column, Any], ...]:
        """Return the columns of the curve and their values (steps,)."""
        energies = ("stored_energy", "adhesive_energy", "dissipated_energy", "released_energy")
        return (
            (self.parameter_column, self.parameter),
            (self.reaction_column, self.reaction),
            *zip(self.boundary_columns, self.reactions.T, strict=True),
            (Column("iterations", "1"), self.iterations),
            *((Column(name, "E0 L0^3"), getattr(self, name)) for name in energies),
            *([(Column("load_work", "E0 L0^3"), self.load_work)] if self.load_work.size else []),
            (Column("kind", "1"), np.array(KINDS)[self.kind]),
            (Column("negative_eigenvalues", "1"), self.negative_eigenvalues),
            (Column("seconds", "s"), self.seconds),
        )


def row_of(step: Step) -> Step:
    """Return a step without its arrays, which would fill the memory: what a curve needs of it."""
    empty = np.empty((0, 2))
    return replace(
        step,
        displacement=empty,
        maximum_openings=empty,
        unknown_values=empty[:, 0],
        accepted_states=(),
        solver_state=None,
    )


def boundaries_of(drive: Drive) -> tuple[str, ...]:
    """Return the names of the boundaries of a drive where it acts on several, else none."""
    driven = driven_boundaries(drive.on)
    return boundary_names([one.boundary for one in driven]) if len(driven) > 1 else ()


@cache
def arrays_of_curve() -> tuple[str, ...]:
    """Return the names of the columns of a curve that hold numbers."""
    return tuple(field.name for field in fields(Curve) if field.type in (FloatArray, IntArray))


def write_table(path: Path, columns: Mapping[str, Sequence[object]]) -> None:
    """Write columns of one length below their headings; None is left empty. Raises OSError."""
    with replacing(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
