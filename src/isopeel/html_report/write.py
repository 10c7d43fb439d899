"""Write the HTML page of a run."""

import json
from base64 import b64encode
from hashlib import sha256
from html import escape
from importlib import resources
from pathlib import Path
from string import Template

import matplotlib as mpl
import numpy as np

import isopeel
from isopeel.html_report import markup
from isopeel.html_report.content import Content, column_words, stage_content
from isopeel.html_report.packing import packed
from isopeel.post.mesh_error import mesh_changes
from isopeel.post.stored_changes import stored_changes
from isopeel.post.style import BLUE, FIELD_MAP, SHADE, SKY, VERMILION
from isopeel.post.summary import summarize
from isopeel.results.files import replacing
from isopeel.running.folder import REPORT, check_overwritten
from isopeel.running.run_reader import StoredStage, read_stages

#: Most bytes of the states of all stages: the page stays below 5 MB, and can be sent by mail.
MOST_BYTES = 4_000_000
_LEVELS = 255  # of the stress, as `packed_stress` has them


def write_html_report(folder: Path, out: Path | None = None, *, force: bool = False) -> Path:
    """Write the run in a folder as one HTML page, by default DIR/report.html; return its path.

    The page loads nothing, and opens without a network. It has all stages in their order. Raises InputError
    if the folder contains no run, and OSError if the page cannot be written.
    """
    stages = read_stages(folder)
    path = out or folder / REPORT
    check_overwritten("--out", [path], force)
    text = html_report(stages)
    with replacing(path) as part:
        part.write_text(text, "utf-8", newline="\n")
    return path


def html_report(stages: tuple[StoredStage, ...]) -> str:
    """Return the page of stages of one run."""
    names = [f"stage-{number}" for number, _ in enumerate(stages, start=1)]
    sections, contents = [], {}
    for name, stored in zip(names, stages, strict=True):
        section, content = _section(name, stored, len(stages) > 1, MOST_BYTES // len(stages))
        sections.append(section)
        if content is not None:
            contents[name] = content
    case, title = stages[-1].case, stages[0].case.name if len(stages) > 1 else stages[0].title
    levels = np.linspace(0.0, 1.0, _LEVELS)
    palette = packed(mpl.colormaps[FIELD_MAP](levels, bytes=True)[:, :3], "u1")
    style, script = _style(), _script()
    policy = (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
    return _template("page.html").substitute(
        policy=policy,
        version=isopeel.__version__,
        title=escape(title),
        about=markup.paragraph(case.about) if case.about else "",
        style=style,
        contents=_contents(names, stages) if len(stages) > 1 else "",
        stages="".join(sections),
        case=escape(stages[-1].run.case_text.strip()),
        provenance=markup.provenance(stages),
        # the text must not end the element that contains it
        content=json.dumps({"palette": palette, "stages": contents}, allow_nan=False).replace("<", "\\u003c"),
        script=script,
    )


def _section(name: str, stored: StoredStage, several: bool, most_bytes: int) -> tuple[str, Content | None]:
    """Return the part of the page for a stage, and the content for its script if there is a state."""
    run, stage = stored.run, stored.stage
    heading = f"<h2>{escape(stored.title)}</h2>\n" if several else ""
    ending = markup.ending(stored)
    if not len(run.curve) or not run.states:
        return f'<section id="{name}">\n{heading}{ending}</section>\n', None
    found = stored.found()
    points = stored.case.discretization.contact_points
    changes = stored_changes(stored.folder / "summary.json", run)
    if changes is None:
        changes = mesh_changes(stage.problem, stored.spaces, run, points)
    content = stage_content(stored, found, most_bytes)
    seconds = float(run.curve.seconds.sum())
    section = _template("stage.html").substitute(
        id=name,
        title=escape(stored.title),
        heading=heading,
        ending=ending,
        parameter=escape(column_words(run.curve.parameter_column)["words"]),
        reaction=escape(column_words(run.curve.reaction_column)["words"]),
        curve_legend=markup.curve_legend(stored, found.plateau is not None),
        shapes="Deformed body" if len(stage.problem.bodies) == 1 else "Deformed bodies",
        hatched=markup.hatched(content["hatched"]),
        summary=markup.summary(stored, summarize(stored.title, run, found, seconds, changes), found),
        table=markup.states_table(stored, len(content["states"])),
    )
    return section, content


def _contents(names: list[str], stages: tuple[StoredStage, ...]) -> str:
    links = "".join(
        f'<li><a href="#{name}">{escape(stored.title)}</a></li>\n'
        for name, stored in zip(names, stages, strict=True)
    )
    return f"<ul>\n{links}</ul>\n"


def _template(name: str) -> Template:
    return Template(_read("html_report", name))


def _style() -> str:
    """Return the style of all documents and that of the page, with the colours of all figures."""
    colors = {"BLUE": BLUE, "SKY": SKY, "VERMILION": VERMILION, "SHADE": SHADE}
    return "\n" + _read("report", "report.css") + _template("page.css").substitute(colors)


def _script() -> str:
    """Return the files of the script, in their order, as one text."""
    files = sorted(
        resources.files("isopeel").joinpath("html_report", "script").iterdir(), key=lambda file: file.name
    )
    parts = [file.read_text("utf-8") for file in files if file.name.endswith(".js")]
    return "\n".join(['\n"use strict";\n', *parts])


def _read(folder: str, name: str) -> str:
    return resources.files("isopeel").joinpath(folder, name).read_text("utf-8")


def _hash(text: str) -> str:
    """Return the hash by which a content security policy allows a text in the page."""
    return "sha256-" + b64encode(sha256(text.encode("utf-8")).digest()).decode("ascii")
