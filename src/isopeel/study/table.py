"""The table of a study: one row for each run, with its factors, its readings, and how it ended."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.dataframes import dataframe
from isopeel.common.units import measured_as
from isopeel.results.curve import write_table
from isopeel.results.files import replacing
from isopeel.study.factors import Factor
from isopeel.study.outcome import Amount, Outcome
from isopeel.study.study import Study

#: Columns that differ if the same study is computed again.
OF_THE_MACHINE = ("seconds", "host")


@dataclass(frozen=True)
class Output:
    """A reading of all runs, in one unit; nan where a run has none."""

    name: str
    unit: str
    values: FloatArray  # (runs,)

    @property
    def heading(self) -> str:
        """The heading of its column."""
        return heading_of(self.name, self.unit)


@dataclass(frozen=True)
class StudyResults:
    """A study and the outcomes of its runs, in their order."""

    study: Study
    outcomes: tuple[Outcome, ...]

    def factor_values(self, factor: Factor) -> list[Any]:
        """Return the values of a factor (runs,): numbers in its unit, or names."""
        scale = factor.scale
        numbers = [(point[factor.key], scale.number(point[factor.key])) for point in self.study.points]
        return [str(value) if number is None else number for value, number in numbers]

    @property
    def outputs(self) -> list[Output]:
        """The readings that the study names, or all that a run has."""
        return [output_of(name, self.outcomes) for name in self.study.outputs or self.reading_names]

    @property
    def reading_names(self) -> list[str]:
        """The names of the readings that a run has."""
        return list(dict.fromkeys(name for outcome in self.outcomes for name in outcome.readings))

    @property
    def missing_outputs(self) -> list[str]:
        """Named readings that no run has."""
        return [one.name for one in self.outputs if np.isnan(one.values).all()]

    def to_dataframe(self) -> Any:
        """Return the table as a DataFrame of pandas: a row for each run, by its number from 1 on.

        Columns and units are those of the file runs.csv, such as `largest force [N/m]`. Raises ImportError
        if pandas is not installed.
        """
        numbers = {one.heading: one.values for one in self.outputs}
        return dataframe(columns_of(self) | numbers).set_index("run")

    def curves_to_dataframe(self) -> Any:
        """Return the curves as a DataFrame of pandas: a row for each step of each run.

        The columns are the number of the run, the stage, and the parameter and the reaction with their
        units. Raises ImportError if pandas is not installed.
        """
        columns: dict[str, list[Any]] = {"run": [], "stage": []}
        for number, outcome in enumerate(self.outcomes, start=1):
            for line in outcome.lines:
                length, before = len(line.parameter), len(columns["run"])
                columns["run"] += [number] * length
                columns["stage"] += [line.stage] * length
                for name, unit, values in zip(
                    line.names, line.units, (line.parameter, line.reaction), strict=True
                ):
                    column = columns.setdefault(heading_of(name, unit), [])
                    # curves of other stages may have other columns
                    column += [np.nan] * (before - len(column)) + values.tolist()
        longest = len(columns["run"])
        return dataframe(
            {name: column + [np.nan] * (longest - len(column)) for name, column in columns.items()}
        )


def heading_of(name: str, unit: str) -> str:
    """Return the heading of a column: a name, and its unit in brackets if it has one."""
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def output_of(name: str, outcomes: Sequence[Outcome]) -> Output:
    """Return a reading of all runs, in the unit of the first run that has it."""
    amounts = [outcome.readings.get(name) for outcome in outcomes]
    unit = next((amount.unit for amount in amounts if amount is not None), "")
    values = np.array(
        [np.nan if amount is None else _in(amount, unit) for amount in amounts], dtype=np.float64
    )
    return Output(name, unit, values)


def _in(amount: Amount, unit: str) -> float:
    return amount.value if amount.unit == unit else measured_as(f"{amount.value!r} {amount.unit}", unit)


def columns_of(results: StudyResults) -> dict[str, list[Any]]:
    """Return the columns of the table by their headings; None where a run has no value."""
    study, outcomes = results.study, results.outcomes
    columns: dict[str, list[Any]] = {"run": list(range(1, len(outcomes) + 1))}
    columns |= {factor.heading: results.factor_values(factor) for factor in study.factors}
    columns |= {
        one.heading: [None if np.isnan(value) else value for value in one.values.tolist()]
        for one in results.outputs
    }
    return columns | {
        "ending": [outcome.ending for outcome in outcomes],
        "cause": [outcome.cause for outcome in outcomes],
        "notes": ["; ".join(outcome.notes) for outcome in outcomes],
        "steps": [outcome.steps for outcome in outcomes],
        "corrections": [outcome.corrections for outcome in outcomes],
        "seconds": [round(outcome.seconds, 3) for outcome in outcomes],
        "host": [outcome.host for outcome in outcomes],
    }


def write_tables(results: StudyResults, folder: Path) -> list[Path]:
    """Write runs.csv, curves.h5 and, where pandas and pyarrow are installed, runs.parquet.

    Returns their paths. Raises OSError if a file cannot be written.
    """
    columns = columns_of(results)
    files = [folder / "runs.csv", folder / "curves.h5"]
    write_table(files[0], columns)
    _write_curves(results, files[1])
    if _write_parquet(columns, folder / "runs.parquet"):
        files.append(folder / "runs.parquet")
    return files


def _write_parquet(columns: Mapping[str, list[Any]], path: Path) -> bool:
    """Write the table as Parquet; return whether the packages for it are installed."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        return False
    with replacing(path) as part:
        parquet.write_table(pyarrow.table(dict(columns)), part)
    return True


def _write_curves(results: StudyResults, path: Path) -> None:
    """Write the curves of all runs: a group for each, with its factors as attributes."""
    with replacing(path) as part, h5py.File(part, "w") as file:
        file.attrs["format"] = "isopeel study curves 1"
        for number, (point, outcome) in enumerate(
            zip(results.study.points, results.outcomes, strict=True), start=1
        ):
            group = file.create_group(f"run-{number:06d}")
            group.attrs["ending"] = outcome.ending
            for key, value in point.items():
                group.attrs[key] = value if isinstance(value, str | int | float) else str(value)
            for line in outcome.lines:
                stage = group.create_group(line.stage) if len(outcome.lines) > 1 else group
                for name, unit, values in zip(
                    line.names, line.units, (line.parameter, line.reaction), strict=True
                ):
                    stage[name] = values
                    stage[name].attrs["unit"] = unit
