"""The report on the published study: its sections, the runs they need, and their files."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from isopeel.common.errors import InputError
from isopeel.common.processes import cores
from isopeel.paper.execution import Store, execute
from isopeel.paper.monitor import Monitor
from isopeel.paper.record import Record, write_records
from isopeel.paper.results import Results
from isopeel.paper.sections import (
    curves,
    front,
    literature,
    model,
    newton,
    provenance,
    reading,
    shapes,
    spaces,
    table2,
    table3,
)
from isopeel.paper.study import MESHES, Run, with_bases
from isopeel.report.document import Block, Document, Section, Table, Text, print_table, write_document
from isopeel.report.folder import RUNS, replaced, take_folder
from isopeel.running.folder import first_names, make_folder


@dataclass(frozen=True)
class Part:
    """A section of the report: the runs that it needs on some meshes, and its content."""

    title: str
    runs: Callable[[Sequence[str]], list[Run]]
    blocks: Callable[[Results, Sequence[str]], Iterator[Block]]


#: The sections by their names on the command line, in the order of the report.
PARTS: dict[str, Part] = {
    name: Part(module.TITLE, module.runs, module.blocks)
    for name, module in (
        ("table2", table2),
        ("table3", table3),
        ("literature", literature),
        ("curves", curves),
        ("front", front),
        ("newton", newton),
        ("shapes", shapes),
        ("spaces", spaces),
        ("reading", reading),
    )
}


def chosen_parts(names: Sequence[str]) -> list[str]:
    """Return names of parts in the order of the report, by default all; InputError for an unknown one."""
    for name in names:
        if name not in PARTS:
            raise InputError("--only", name, f"the parts are {', '.join(PARTS)}")
    return [name for name in PARTS if not names or name in names]


def chosen_meshes(names: Sequence[str]) -> list[str]:
    """Return names of meshes from the coarsest on, by default all; InputError for an unknown one."""
    for name in names:
        if name not in MESHES:
            raise InputError("--mesh", name, f"the published meshes are {', '.join(MESHES)}")
    return [name for name in MESHES if not names or name in names]


def make_report(
    parts: Sequence[str],
    meshes: Sequence[str],
    out: Path,
    console: Console,
    workers: int | None = None,
    *,
    force: bool = False,
) -> Path:
    """Compute the missing runs, and write the report on the parts and meshes; returns its HTML page.

    Finished runs are in `runs` of the folder and are not computed again. So a study can be interrupted.
    Raises InputError if the folder cannot be written, or if it contains files that are not of a report,
    unless with `force`. Raises OSError if a file cannot be written.
    """
    folder = take_folder(out, _folder(parts, meshes), _is_folder, force=force)
    store = Store(out / RUNS)
    make_folder(store.folder)
    runs = needed_runs(parts, meshes)
    missing = [run for run in runs if store.finished(run) is None]
    if runs:
        console.print(f"{len(runs)} runs, {len(runs) - len(missing)} of them are finished already")
    outdated = [str(path) for run in missing if (path := store.path(run)).exists()]
    if outdated:
        what = f"replaces {first_names(outdated)}: not finished, or computed by other code"
        console.print(what, soft_wrap=True)
    if message := replaced(folder):
        console.print(message, soft_wrap=True)
    with Monitor(console, missing) as monitor:
        execute(missing, store, workers or cores(), monitor)
    # a variant whose base ended before it starts was not computed
    stored = {run: found for run in runs if (found := store.finished(run)) is not None}
    results = Results({run: Record.of(run, found) for run, found in stored.items()}, store)
    document = make_document(results, parts, meshes)
    write_records(folder / "records.h5", results.records)
    write_document(document, folder)
    if len(parts) < len(PARTS):
        for block in document.blocks:
            if isinstance(block, Table) and block.name != "runs":
                print_table(block, console)
    return folder / "report.html"


def _folder(parts: Sequence[str], meshes: Sequence[str]) -> str:
    """Return the folder of a report: one on a selection has its own folder in that of the full report."""
    named = [] if len(parts) == len(PARTS) else [*parts]
    named += [] if len(meshes) == len(MESHES) else [*meshes]
    return "-".join(named)


def _is_folder(name: str) -> bool:
    """Return whether the folder of a report on a selection could have this name."""
    return set(name.split("-")) <= {*PARTS, *MESHES}


def needed_runs(parts: Sequence[str], meshes: Sequence[str]) -> list[Run]:
    """Return all runs of some parts of the report, and the runs that they start from."""
    return with_bases(run for name in parts for run in PARTS[name].runs(meshes))


def make_document(results: Results, parts: Sequence[str], meshes: Sequence[str]) -> Document:
    """Return the report; its figures are drawn when it is written."""
    options = [f"--mesh {mesh}" for mesh in meshes] if len(meshes) < len(MESHES) else []
    sections = [Section(model.TITLE, tuple(model.blocks()))]
    for name in parts:
        command = " ".join(["isopeel paper", f"--only {name}", *options])
        part = PARTS[name]
        sections.append(Section(part.title, tuple(part.blocks(results, meshes)), command))
    sections.append(Section(provenance.TITLE, tuple(provenance.blocks(results))))
    sections.append(Section(model.REFERENCES_TITLE, (Text(model.REFERENCES),)))
    return Document("A published study of peeling, reproduced", Text(model.ABSTRACT), tuple(sections))
