"""Compute a fit, and write its tables, figures, fitted case and report."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from isopeel.case import Case, load_case
from isopeel.identification.data_set import data_set_of
from isopeel.identification.figures import correlation_figure, curve_figure, profile_figure
from isopeel.identification.fit_file import Fit, noise_of, parameter_of
from isopeel.identification.measured import Measured, read_measured
from isopeel.identification.model import CurveModel
from isopeel.identification.result import FitResult, FittedParameter
from isopeel.identification.solve import solve
from isopeel.report.document import Block, Document, Picture, Section, Table, Text, write_document
from isopeel.report.folder import RUNS, TABLES, replaced, take_folder
from isopeel.report.wording import listed
from isopeel.results.curve import write_table
from isopeel.results.files import replacing
from isopeel.results.provenance import Provenance
from isopeel.running.folder import make_folder
from isopeel.running.lock import alone_in
from isopeel.study.execution import Store
from isopeel.study.outcome import Outcome

#: The case with the fitted values, in the folder of tables.
FITTED = "fitted.toml"


def fit(
    case: Case | str,
    measured: Measured | str | PathLike[str] | Sequence[Measured],
    parameters: Mapping[str, str | float | tuple[str | float, str | float | None, str | float | None]],
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
    whole = Fit(base.name, base, data, chosen, starts, seed, profile)
    if out is None:
        return solve(whole, CurveModel(whole, None, lambda _: None))
    store = Store(Path(out) / RUNS)
    make_folder(store.folder, "out")
    with alone_in(store.folder, "out"):
        return solve(whole, CurveModel(whole, store, lambda _: None))


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


def make_document(result: FitResult, provenance: Provenance, command: str) -> Document:
    """Return the report of a fit; its figures are drawn when it is written."""
    count = sum(len(curve.x) for curve in result.curves)
    names = listed([f"`{one.key}`" for one in result.parameters])
    files = listed([f"`{curve.data.name}`" for curve in result.curves])
    abstract = (
        f"{names} of the case {result.fit.case.name} were fitted to {count} measured points of {files} by least"
        " squares."
    )
    sections = [
        Section("Parameters", tuple(_parameters(result)), command),
        Section("Curves", tuple(_curves(result))),
        Section("How well they are determined", tuple(_uncertainty(result))),
        Section("Search", tuple(_search(result))),
        Section("Where the numbers come from", tuple(_provenance(result, provenance))),
    ]
    return Document(f"Fit {result.fit.name}", Text(abstract), tuple(sections))


def _parameters(result: FitResult) -> Iterator[Block]:
    rows = tuple(_row(one) for one in result.parameters)
    title = "The fitted values, and their standard errors."
    headings = (
        "parameter",
        "value",
        "standard error",
        "relative [%]",
        "if the others were known [%]",
        "start",
        "bounds",
    )
    yield Table("parameters", title, headings, rows)
    yield Text(f"The case with these values is `tables/{FITTED}`; `isopeel run` computes it.")
    for note in result.notes:
        yield Text(note)


def _row(one: FittedParameter) -> tuple[str, ...]:
    parameter = one.parameter
    known = not np.isnan(one.standard_error)
    ends = [parameter.text(end, 4) if np.isfinite(end) else "-" for end in (parameter.lower, parameter.upper)]
    return (
        one.key,
        parameter.text(one.value),
        parameter.text(one.standard_error, 3) if known else f"at its {one.bound} bound",
        f"{100 * one.relative_error:.3g}" if known else "-",
        f"{100 * one.alone / abs(one.value or 1.0):.3g}" if known else "-",
        parameter.text(parameter.start, 4),
        " to ".join(ends),
    )


def _curves(result: FitResult) -> Iterator[Block]:
    for number, curve in enumerate(result.curves, start=1):
        caption = (
            f"{curve.data.name}: measured points, the fitted curve, and residuals. The band of the fit has the true"
            " curve with 95 % confidence, if the model is right; it is not that of single measured points."
        )
        yield Picture(f"curve-{number}", caption, partial(curve_figure, curve))


def _uncertainty(result: FitResult) -> Iterator[Block]:
    noise = (
        f"The noise is stated. Chi square is {result.chi_square:.4g} for {result.freedom} degrees of freedom; noise"
        f" alone gives as much with a probability of {result.probability:.2g}."
        if result.noise_is_stated
        else "The noise is estimated from the residuals, as the same share of the largest value of each curve:"
        f" {100 * result.curves[0].deviations[0] / np.abs(result.curves[0].data.measured.y).max():.3g} %."
    )
    yield Text(noise)
    yield Text(
        "The standard errors are those of linear theory: the covariance is the inverse of $J^T J$, with the"
        f" derivatives $J$ in units of the noise. The condition number of $J$ is {result.condition:.3g}, for relative"
        " changes of the parameters: it is large where a combination of parameters hardly changes the curves."
    )
    rows = tuple(
        (
            curve.data.name,
            str(len(curve.x)),
            "-" if curve.runs is None else str(curve.runs.runs),
            "-" if curve.runs is None else f"{curve.runs.expected:.1f}",
            "-" if curve.runs is None else f"{curve.runs.probability:.2g}",
        )
        for curve in result.curves
    )
    headings = ("curve", "points", "runs of one sign", "expected of noise", "probability of so few")
    yield Table(
        "residuals", "Whether the residuals look like noise (test of Wald and Wolfowitz).", headings, rows
    )
    if len(result.parameters) > 1:
        yield Picture("correlation", "Correlation of the parameters.", partial(correlation_figure, result))
    if result.profile is not None:
        profile = result.profile
        ends = [profile.parameter.text(end) if np.isfinite(end) else "not found" for end in profile.interval]
        caption = (
            f"Profile of {profile.parameter.key}: the smallest chi square over all other parameters. Ends of the 95 %"
            f" interval: {ends[0]}, {ends[1]}."
        )
        yield Picture("profile", caption, partial(profile_figure, profile))


def _search(result: FitResult) -> Iterator[Block]:
    yield Text(f"{result.runs} runs were computed; those of an earlier command are not counted.")
    headings = (
        "start",
        *(one.parameter.heading for one in result.parameters),
        "sum of squares",
        "evaluations",
        "",
    )
    rows = tuple(
        (
            str(number),
            *(f"{begin:.4g} -> {end:.6g}" for begin, end in zip(one.start, one.values, strict=True)),
            f"{one.chi_square:.6g}",
            str(one.evaluations),
            one.cause,
        )
        for number, one in enumerate(result.starts, start=1)
    )
    yield Table("starts", "The starts of the search, and where they ended.", headings, rows)


def _provenance(result: FitResult, provenance: Provenance) -> Iterator[Block]:
    versions = ", ".join(f"{name} {version}" for name, version in provenance.versions.items())
    revision = f", source revision {provenance.git_revision}" if provenance.git_revision else ""
    yield Text(
        f"Computed by {versions}{revision}. Between its steps a computed curve is interpolated linearly at the"
        " measured points."
    )
