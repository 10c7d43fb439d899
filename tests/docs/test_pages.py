"""The pages of the documentation: their code is run, their commands and names exist."""

import re
import shlex
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
import typer.main

import isopeel
from isopeel.cli import app
from isopeel.post.closed_form import beam_peeling

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if "runs" not in path.parts)
#: These show the commands that made them, which take minutes.
REPORTS = (DOCS / "paper/report.md", DOCS / "validation/report.md")
TEXTS = {str(path.relative_to(ROOT)): path.read_text("utf-8") for path in (ROOT / "README.md", *PAGES)}

FENCE = re.compile(r"^```(\S*)[^\n]*\n(.*?)^```", re.DOTALL | re.MULTILINE)
#: What is no code; a cell is executed when the site is built.
NO_CODE = {"{toctree}", "{eval-rst}", "{include}"}
#: In blocks and in the midst of a line.
COMMAND = re.compile(r"^ *(isopeel [^#|>&\n]*)", re.MULTILINE)
SPAN = re.compile(r"`(isopeel [^`\n]*)`")


def test_every_block_of_code_in_the_pages_is_executed() -> None:
    kinds = {
        kind for page in PAGES if page not in REPORTS for kind, _ in FENCE.findall(page.read_text("utf-8"))
    }
    assert kinds == {"{code-cell}", *NO_CODE}


def test_the_python_of_the_readme_runs(capsys: pytest.CaptureFixture[str]) -> None:
    namespace: dict[str, Any] = {}
    (code,) = [text for kind, text in FENCE.findall(TEXTS["README.md"]) if kind == "python"]
    exec(code, namespace)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 91
    closed_form = beam_peeling(namespace["problem"])
    assert closed_form is not None
    assert float(lines[-1].split()[1]) == pytest.approx(closed_form.moment, rel=3e-3)  # thin-beam theory


#: Options that a command without an argument has, and which do something when they are read.
IMMEDIATE = ("--help", "--version", "--install-completion", "--show-completion")


@pytest.mark.parametrize("page", TEXTS)
def test_commands_exist_with_their_options(page: str) -> None:
    text = TEXTS[page]
    blocks = [*(code for _, code in FENCE.findall(text)), *re.findall(r"^ {4}(\S.*)$", text, re.MULTILINE)]
    command: Any = typer.main.get_command(app)
    for line in (*(line for block in blocks for line in COMMAND.findall(block)), *SPAN.findall(text)):
        words = [word for word in shlex.split(line)[1:] if word not in IMMEDIATE]
        if words:
            name, chosen, rest = command.resolve_command(command.make_context("isopeel", words), words)
            # a command that is only named has no arguments
            if rest:
                chosen.make_context(name, rest)


def test_what_the_pages_refer_to_is_there() -> None:
    found = [name for text in TEXTS.values() for name in re.findall(r"\{py:obj\}`~?([\w.]+)`", text)]
    assert len(found) > 80
    for name in found:
        module = name
        attributes: list[str] = []
        while True:
            try:
                part: object = import_module(module)
                break
            except ModuleNotFoundError:
                module, _, last = module.rpartition(".")
                attributes.insert(0, last)
        for attribute in attributes:
            part = getattr(part, attribute)


def test_the_reference_has_every_module_and_every_public_name() -> None:
    package = Path(isopeel.__file__).parent
    parts = {
        path.stem for path in package.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()
    }
    pages = "".join(path.read_text("utf-8") for path in (DOCS / "api").glob("*.md"))
    named = [part for line in re.findall(r"<!-- modules: (.*?) -->", pages) for part in line.split()]
    # the study and the validation are programs
    assert sorted(named) == sorted(parts - {"__init__", "__main__", "paper", "validation"})
    listed = re.findall(r"^   ~(isopeel\.\S+)$", pages, re.MULTILINE)
    assert sorted(name.rpartition(".")[2] for name in listed) == sorted(isopeel.__all__)
