"""Compute a fit, and write its tables, figures, fitted case and report."""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

from rich.console import Console

from isopeel.case import Case, load_case
from isopeel.identification.data_set import data_set_of
from isopeel.identification.fit_file import Fit, load_fit, noise_of, parameter_of
from isopeel.identification.measured import Measured, read_measured
from isopeel.identification.model import CurveModel
from isopeel.identification.report import FITTED, make_document
from isopeel.identification.result import FitResult
from isopeel.identification.solve import solve
from isopeel.report.document import write_document
from isopeel.report.folder import RUNS, TABLES, replaced, take_folder
from isopeel.results.curve import write_table
from isopeel.results.files import replacing
from isopeel.results.provenance import Provenance
from isopeel.running.folder import make_folder
from isopeel.running.lock import alone_in
from isopeel.study.execution import Store
from isopeel.study.outcome import Outcome

#: A number of a parameter, as a case file has it.
Written: TypeAlias = str | float


def fit(
    case: Case | str,
    measured: Measured | str | PathLike[str] | Sequence[Measured],
    parameters: Mapping[str, Written | tuple[Written, Written | None, Written | None]],
    *,
    noise: str | None = None,
    starts: int = 1,
    seed: int = 0,
    profile: str = "",
    out: str | PathLike[str] | None = None,
) -> FitResult:
    """Fit parameters of a case to one measured curve, or to several of the same case.

    `case` is a case, a file or a shipped case. `parameters` are keys of the case, each with a start as a case
    file has it, or (start, lower, upper), where None is no bound. `noise` is the standard deviation of a
    measured value: a share of the largest one such as "1 %", or a value with a unit; by default it is
    estimated from the residuals. `starts`, `seed` and `profile` are those of a fit file, which can also fit
    curves of other values of keys. Finished runs are stored in the folder `out`, so that the same call
    continues. Raises InputError.
    """
    base = load_case(case) if isinstance(case, str) else case
    given: Sequence[Any] = [measured] if isinstance(measured, Measured | str | PathLike) else measured
    curves = [one if isinstance(one, Measured) else read_measured(Path(one)) for one in given]
    data = tuple(
        data_set_of(
            f"measured.{number}",
            base,
            one,
            {},
            noise=None if noise is None else noise_of("noise", noise, one),
        )
        for number, one in enumerate(curves, start=1)
    )
    chosen = tuple(
        parameter_of(f"parameter {key}", key, *(given if isinstance(given, tuple) else (given,)))
        for key, given in parameters.items()
    )
    return _solved(Fit(base.name, base, data, chosen, starts, seed, profile), out)


def fit_file(path: str | PathLike[str], out: str | PathLike[str] | None = None) -> FitResult:
    """Compute the fit of a file; finished runs are stored in the folder `out`. Raises InputError."""
    return _solved(load_fit(Path(path)), out)


def _solved(chosen: Fit, out: str | PathLike[str] | None) -> FitResult:
    if out is None:
        return solve(chosen, CurveModel(chosen, None, lambda _: None))
    store = Store(Path(out) / RUNS)
    make_folder(store.folder, "out")
    with alone_in(store.folder, "out"):
        return solve(chosen, CurveModel(chosen, store, lambda _: None))


def run_fit(
    chosen: Fit, out: Path, console: Console, *, force: bool = False, command: str = "isopeel fit"
) -> FitResult:
    """Compute a fit, and write its tables, figures, fitted case and report to a folder.

    Runs that the folder has are not computed again. Raises InputError if the folder cannot be written, or if
    it contains files that are not of a report, unless with `force`; OSError if a file cannot be written.
    """
    folder = take_folder(out, "", lambda _: False, force=force)
    store = Store(out / RUNS)
    make_folder(store.folder)
    if message := replaced(folder):
        console.print(message, soft_wrap=True)
    with alone_in(store.folder, "--out"), console.status(f"{chosen.name}: first run") as status:
        runs = 0

        def finished(outcome: Outcome) -> None:
            nonlocal runs
            runs += 1
            status.update(f"{chosen.name}: {runs} runs, the last took {outcome.seconds:.1f} s")

        result = solve(chosen, CurveModel(chosen, store, finished))
    make_folder(folder / TABLES)
    _write_files(result, folder / TABLES)
    write_document(make_document(result, Provenance.of_this_process(), command), folder)
    for one in result.parameters:
        console.print(f"{one.key} = {one.text}", soft_wrap=True)
    for note in result.notes:
        console.print(f"note: {note.replace('`', '')}", soft_wrap=True)
    console.print(f"the fitted case is {folder / TABLES / FITTED}", soft_wrap=True)
    return result


def _write_files(result: FitResult, folder: Path) -> None:
    write_table(folder / "parameters.csv", result.table())
    for number, curve in enumerate(result.curves, start=1):
        x, y = curve.data.measured.headings
        name, unit = curve.data.measured.columns[1], curve.data.measured.units[1]
        columns = {x: curve.x.tolist(), y: curve.data.measured.y.tolist()}
        for label, values in (
            ("fitted", curve.fitted),
            ("band of", curve.band),
            ("noise of", curve.deviations),
        ):
            columns[f"{label} {name} [{unit}]"] = values.tolist()
        write_table(folder / f"curve-{number}.csv", columns)
    with replacing(folder / FITTED) as part:
        part.write_text(result.case.text, "utf-8", newline="\n")
