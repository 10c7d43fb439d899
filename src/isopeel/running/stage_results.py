"""The results of a stage that was run: its curve, summary and figures, and its table on the terminal."""

import json

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.common.interrupts import check
from isopeel.post.figures import reaction_figure, save, sensitivities_figure, shapes_figure
from isopeel.post.shown import in_laboratory
from isopeel.post.summary_table import summary_rows
from isopeel.post.table import write_curve
from isopeel.results.files import replacing
from isopeel.results.run_file import StoredRun
from isopeel.running.folder import FIGURES, make_folder
from isopeel.running.stage_run import StageRun
from isopeel.running.stage_summary import Results, results_of


def write_results(one: StageRun, run: StoredRun, wall_time: float) -> Results:
    """Write curve, summary and, unless the run was interrupted, figures."""
    out, problem = one.place.folder, one.stage.problem
    results = results_of(one, run, wall_time)
    found = results.findings
    write_curve(out / "curve.csv", run.curve, problem, found.laboratory, found.fronts, found.flows)
    text = json.dumps(results.summary, indent=2, allow_nan=False)
    with replacing(out / "summary.json") as part:
        part.write_text(text + "\n", encoding="utf-8")
    # after Ctrl-C figures would take too long
    if len(run.curve) and run.ending != "interrupted":
        curve, plateau, closed_form, _ = in_laboratory(run.curve, found)
        for name, figure in (
            ("curve.png", reaction_figure(curve, plateau, closed_form)),
            ("shapes.png", shapes_figure(problem, one.spaces, run.states, found.laboratory)),
        ):
            check()
            with replacing(out / name) as part:
                save(figure, part)
        if curve.sensitive_to:
            make_folder(out / FIGURES)
            with replacing(out / FIGURES / "sensitivities.png") as part:
                save(sensitivities_figure(curve), part)
    return results


def print_results(one: StageRun, results: Results, console: Console) -> None:
    """Print the summary in a few lines, with the closed forms beside the values."""
    run, found, summary = results
    rows = summary_rows(summary, run.curve, found)
    columns = 4 if any(row.theory for row in rows) else 2
    heading = ("", "run", "closed form", "deviation")[:columns]
    table = Table(*heading, title=summary["case"], box=SIMPLE_HEAD)
    for row in rows:
        table.add_row(*row[:columns])
    console.print(table)
    if found.halves:
        console.print(found.halves, soft_wrap=True)
    for note in summary["notes"]:
        console.print(f"note: {note['text']}", soft_wrap=True)
    console.print(found.laboratory.note(), soft_wrap=True)
    console.print(f"files in {one.place.folder}", soft_wrap=True)
