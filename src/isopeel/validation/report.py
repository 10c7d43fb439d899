"""The validation: the list of checks, their computation, and the report on them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from isopeel.common.errors import InputError
from isopeel.common.processes import Done, compute_all, cores
from isopeel.report.document import Block, Document, Section, Table, Text, print_table, write_document
from isopeel.report.folder import replaced, take_folder
from isopeel.results.provenance import Provenance
from isopeel.validation import (
    bending,
    cantilever,
    curvature,
    cylinder,
    hertz,
    layers,
    mixed_mode,
    mode_ratios,
    momentum,
    patch,
    separation,
    snap_back,
    tapes,
    two_arms,
    two_cylinders,
)
from isopeel.validation.check import Check, Result, Row

#: The checks by their names on the command line, in the order of the report.
CHECKS: dict[str, Check[Any, Any]] = {
    "tapes": tapes.CHECK,
    "cantilever": cantilever.CHECK,
    "cylinder": cylinder.CHECK,
    "hertz": hertz.CHECK,
    "bending": bending.CHECK,
    "curvature": curvature.CHECK,
    "patch": patch.CHECK,
    "momentum": momentum.CHECK,
    "layers": layers.CHECK,
    "cylinders": two_cylinders.CHECK,
    "arms": two_arms.CHECK,
    "separation": separation.CHECK,
    "mixed-mode": mixed_mode.CHECK,
    "snap-back": snap_back.CHECK,
    "modes": mode_ratios.CHECK,
}

_ABSTRACT = """
Each check below runs problems that have a solution in closed form, and compares the results with it. A row
passes if its deviation is at most the allowed one. Rows without an allowed deviation are for information:
there the closed form is not valid. Forces are per unit width; lengths are in L0, stresses in E0. {summary} is
the summary. The sections describe how each number is computed.
"""


#: The columns that every table has.
_NUMBERS = ("computed", "closed form", "deviation / %", "allowed / %", "verdict")


@dataclass(frozen=True)
class Validation:
    """The results by the names of checks, and the folder that they are written to."""

    results: Mapping[str, Result]
    page: Path

    @property
    def failed(self) -> int:
        """The number of rows that do not pass."""
        return sum(not row.passed for result in self.results.values() for row in result.rows)


def chosen_checks(names: Sequence[str]) -> list[str]:
    """Return names of checks in the order of the report, by default all; InputError for an unknown one."""
    for name in names:
        if name not in CHECKS:
            raise InputError("--only", name, f"the checks are {', '.join(CHECKS)}")
    return [name for name in CHECKS if not names or name in names]


def validate(names: Sequence[str], out: Path, console: Console, *, force: bool = False) -> Validation:
    """Run checks, print their tables, and write the report on them with its figures and tables.

    A report on some of the checks has its own folder in `out`. Raises InputError if the folder cannot be
    written, or if it contains files that are not of a report, unless with `force`. Raises OSError if a file
    cannot be written.
    """
    part = "" if len(names) == len(CHECKS) else "-".join(names)
    folder = take_folder(out, part, lambda name: set(name.split("-")) <= set(CHECKS), force=force)
    if message := replaced(folder):
        console.print(message, soft_wrap=True)
    provenance = Provenance.of_this_process()
    done = _computed(names, console)
    results = {name: CHECKS[name].judge([d.outcome for d in done[name]]) for name in names}
    seconds = {name: sum(d.seconds for d in done[name]) for name in names}
    document = make_document(results, seconds, provenance)
    for name, result in results.items():
        print_table(_brief(name, result), console)
    print_table(_summary(results, seconds), console)
    write_document(document, folder)
    return Validation(results, folder / "report.md")


def _computed(names: Sequence[str], console: Console) -> dict[str, list[Done]]:
    """Return the outcomes of all cases of checks, which are computed in parallel."""
    owners = [name for name in names for _ in CHECKS[name].cases]
    tasks = [partial(CHECKS[name].compute, case) for name in names for case in CHECKS[name].cases]
    bar = Progress(
        TextColumn("{task.description:12s}"),
        BarColumn(bar_width=None),
        TextColumn("{task.completed}/{task.total} runs"),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
    with bar:
        line = bar.add_task("validating", total=len(tasks))
        finished = compute_all(
            tasks,
            min(cores(), len(tasks)),
            lambda number, _: bar.update(line, advance=1, description=owners[number]),
        )
    return {
        name: [done for done, owner in zip(finished, owners, strict=True) if owner == name] for name in names
    }


def make_document(
    results: Mapping[str, Result], seconds: Mapping[str, float], provenance: Provenance
) -> Document:
    """Return the report; its figures are drawn when it is written."""
    sections = [
        Section("Summary", (_summary(results, seconds),)),
        *(
            Section(CHECKS[name].title, tuple(_blocks(name, result)), f"isopeel validate --only {name}")
            for name, result in results.items()
        ),
        Section("Where the numbers come from", (_provenance(provenance),)),
    ]
    return Document("Runs compared with closed forms", Text(_ABSTRACT), tuple(sections))


def _summary(results: Mapping[str, Result], seconds: Mapping[str, float]) -> Table:
    rows = []
    for name, result in results.items():
        judged = [row for row in result.rows if row.allowed is not None]
        worst = max(judged, key=lambda row: row.share_of_allowed)
        rows.append(
            (
                CHECKS[name].title,
                f"{sum(row.passed for row in judged)} of {len(judged)}",
                _percent(worst.deviation),
                _allowed(worst),
                f"{seconds[name]:.0f}",
                "pass" if result.passed else "FAIL",
            )
        )
    return Table(
        "summary",
        "The checks: rows that pass, and the deviation that is nearest to the allowed one.",
        ("check", "rows that pass", "deviation / %", "allowed / %", "seconds of one core", "verdict"),
        tuple(rows),
    )


def _blocks(name: str, result: Result) -> Iterator[Block]:
    yield Text(result.text)
    yield Text("\n".join(f"- {what}: {value}" for what, value in result.settings))
    yield Table(
        name,
        f"{CHECKS[name].title}: {result.quantity}.",
        (*result.columns, *_NUMBERS),
        tuple((*row.details, *_numbers(row)) for row in result.rows),
        result.problems,
    )
    yield from result.pictures


def _brief(name: str, result: Result) -> Table:
    """Return a narrower table for a console: the name of a row in one column, and no further details."""
    named = slice(result.named_by)
    rows = []
    for row in result.rows:
        computed, expected, deviation, allowed, verdict = _numbers(row)
        shown = f"{allowed} %" if allowed else ""
        rows.append((", ".join(row.details[named]), computed, expected, f"{deviation} %", shown, verdict))
    headings = ("computed", "closed form", "deviation", "allowed", "verdict")
    title = f"{CHECKS[name].title}: {result.quantity}"
    return Table(name, title, (", ".join(result.columns[named]), *headings), tuple(rows), result.problems)


def _numbers(row: Row) -> tuple[str, ...]:
    computed, expected = f"{row.computed:.6g}", f"{row.expected:.6g}"
    return computed, expected, _percent(row.deviation), _allowed(row), _verdict(row)


def _percent(share: float) -> str:
    return f"{round(100 * share, 4) + 0.0:+.4f}"  # no minus before a zero


def _allowed(row: Row) -> str:
    return "" if row.allowed is None else f"{100 * row.allowed:.2g}"


def _verdict(row: Row) -> str:
    if row.allowed is None:
        return "for information"
    return "pass" if row.passed else "FAIL"


def _provenance(provenance: Provenance) -> Text:
    versions = ", ".join(f"{name} {version}" for name, version in provenance.versions.items())
    revision = f", source revision {provenance.git_revision}" if provenance.git_revision else ""
    return Text(
        f"Computed by {versions}, on {provenance.platform}{revision}, from {provenance.started} on, with one"
        " process for each core."
    )
