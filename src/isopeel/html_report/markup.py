"""The texts of the HTML page of a run, which do not need its script. Texts of a run are escaped."""

from collections.abc import Iterable, Sequence
from functools import partial
from html import escape
from typing import Any

from isopeel.html_report.content import column_words, plain
from isopeel.post.figures.reaction import unstable_pieces
from isopeel.post.findings import Findings
from isopeel.post.summary_table import summary_rows
from isopeel.results.run_file import Failure
from isopeel.running.run_reader import StoredStage
from isopeel.solve.step import KINDS


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in HTML, whose first column describes the rows."""
    head = "".join(f'<th scope="col">{escape(heading)}</th>' for heading in headings)
    body = ""
    for first, *rest in rows:
        cells = "".join(f"<td>{escape(cell)}</td>" for cell in rest)
        body += f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>\n'
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table>\n"


def paragraph(text: str, kind: str = "") -> str:
    """Return a paragraph of plain text in HTML."""
    opening = f'<p class="{kind}">' if kind else "<p>"
    return f"{opening}{escape(text)}</p>\n"


def hatched(words: str) -> str:
    """Return the entry of a legend for what pictures hatch, nothing without words."""
    return f'<span class="entry"><span class="key hatched"></span>{escape(words)}</span>' if words else ""


def ending(stored: StoredStage) -> str:
    """Return the ending of a stage, with cause and hint if it was not completed."""
    run, column = stored.run, stored.run.curve.parameter_column
    value = partial(stored.laboratory.parameter, column)
    steps = f"{len(run.curve)} {'step' if len(run.curve) == 1 else 'steps'}"
    if len(run.curve):
        steps += f", to {_units(value(float(run.curve.parameter[-1])))}"
    if run.failure is not None:
        return _box(
            _failure(
                run.failure,
                stored.laboratory.sentence(run.failure.reason),
                _units(value(run.failure.parameter)),
            )
            + paragraph(f"Converged: {steps}.")
        )
    match run.ending:
        case "completed":
            return paragraph(f"Completed: {steps}.")
        case "interrupted":
            words = f"This run was interrupted. Converged: {steps}. `isopeel resume` continues it."
        case _:
            words = (
                f"This run was killed, or is still running: {steps}."
                " If it was killed, `isopeel resume` continues it."
            )
    return _box(paragraph(words))


def _failure(failure: Failure, reason: str, at: str) -> str:
    residuals = ", ".join(f"{measure:.1e}" for measure in failure.iterations)
    lines = [
        f"No equilibrium at {at}: {reason}.",
        f"Cause: {failure.cause}. Remedy: {failure.hint}.",
        *([f"Energy residual per unknown before each correction: {residuals}."] if residuals else []),
    ]
    return "".join(map(paragraph, lines))


def _box(content: str) -> str:
    return f'<div class="ending bad" role="note">\n{content}</div>\n'


def summary(stored: StoredStage, read: dict[str, Any], found: Findings) -> str:
    """Return the summary of a run beside closed forms, with its notes and units."""
    rows = summary_rows(read, stored.run.curve, found)
    columns = 4 if any(row.theory for row in rows) else 2
    headings = ("", "run", "closed form", "deviation")[:columns]
    shown = table(headings, ((row.name, *map(_units, row[1:columns])) for row in rows))
    notes = [f"Note: {note['text']}." for note in read["notes"]]
    notes += [f"{words[0].upper()}{words[1:]}." for words in (found.halves, found.laboratory.note()) if words]
    return shown + "".join(paragraph(note, "legend") for note in notes)


def _units(text: str) -> str:
    return plain(text).replace(" deg", "°")


def states_table(stored: StoredStage, shown: int) -> str:
    """Return the stored states as a table."""
    curve, steps = stored.laboratory.curve(stored.run.curve), [state.step for state in stored.run.states]
    columns = [column_words(column) for column in (curve.parameter_column, curve.reaction_column)]
    headings = ["step", *(f"{column['words']} / {column['unit']}" for column in columns), "iterations"]
    rows = (
        (str(k), f"{curve.parameter[k]:g}", f"{curve.reaction[k]:.6g}", str(curve.iterations[k]))
        for k in steps
    )
    less = f", of which {shown} are shown above, to keep the page small" if shown < len(steps) else ""
    caption = f"{len(steps)} stored states of {len(curve)} steps{less}"
    content = f'<div class="wide">\n{table(headings, rows)}</div>\n'
    return f"<details>\n<summary>{escape(caption)}</summary>\n{content}</details>\n"


def curve_legend(stored: StoredStage, plateau: bool) -> str:
    """Return the legend of the marks on a curve."""
    curve = stored.run.curve
    kinds = {KINDS[kind] for kind in curve.kind[1:]}
    marked = {
        "state": ("stored state", True),
        "chosen": ("selected state", True),
        "unstable": ("unstable", bool(unstable_pieces(curve).any())),
        "jumped": ("jump", "jump" in kinds),
        "limit": ("limit point", "limit point" in kinds),
        "shaded": ("window of the plateau", plateau),
    }
    keys = [(kind, words) for kind, (words, there) in marked.items() if there]
    return " ".join(
        f'<span class="entry"><span class="key {kind}"></span>{words}</span>' for kind, words in keys
    )


def provenance(stages: Sequence[StoredStage]) -> str:
    """Return the provenance of the stages; values that differ between them are listed in order."""
    names = dict.fromkeys(name for stored in stages for name in stored.run.attributes)
    left_out = ("L0", "E0", "stage", "space", "mesh", "dofs", "traction")
    rows = []
    for name in names:
        if name not in left_out:
            values = dict.fromkeys(str(stored.run.attributes.get(name, "-")) for stored in stages)
            rows.append((name.removeprefix("version_").replace("_", " "), "; ".join(values)))
    return f'<div class="wide">\n{table(("", "of this run"), rows)}</div>\n'
