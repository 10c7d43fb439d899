"""The site: pages of this folder, executed, and the reference from docstrings. Built by `make docs`."""

import atexit
import json
import os
import re
import sys
from importlib.metadata import version as version_of
from importlib.resources import files
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util.math import get_node_equation_number
from sphinx.writers.html5 import HTML5Translator

from isopeel.case.schema import case_schema

# commands in the pages are those of this environment, in one thread
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
os.environ.setdefault("OMP_NUM_THREADS", "1")
# kernels start with `startup.py`
_home = TemporaryDirectory()
atexit.register(_home.cleanup)
_startup = Path(_home.name) / "profile_default/startup"
_startup.mkdir(parents=True)
copy(Path(__file__).with_name("startup.py"), _startup)
os.environ["IPYTHONDIR"] = _home.name
# the output of a cell is no terminal, whatever its kernel says
os.environ |= {"TTY_COMPATIBLE": "0", "_TYPER_FORCE_DISABLE_TERMINAL": "1", "COLUMNS": "84"}

_package = Path(str(files("isopeel")))

project = "isopeel"
author = "The isopeel developers"
copyright = author
version = release = version_of("isopeel")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.autosummary"]
exclude_patterns = ["paper/runs/**"]
# many systems have no font for formulas
# the schema of case files is a file of the site
_extra = Path(_home.name) / "extra"
_extra.mkdir()
(_extra / "case.schema.json").write_text(json.dumps(case_schema(), indent=1), "utf-8")
html_extra_path = [str(_extra)]
html_static_path = ["_static", str(files("ziamath") / "fonts/STIXTwoMath-Regular.ttf")]
html_css_files = ["site.css"]
html_theme = "furo"
html_title = "isopeel"
html_math_renderer = "mathml"
html_copy_source = False
math_numfig = False

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
# what a page shows is what its code prints while the site is built, in an empty folder
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
nb_execution_show_tb = True

autosummary_generate = False
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True, "ignore-module-all": True}
default_role = "code"


def setup(app: Sphinx) -> None:
    """Formulas as MathML, which browsers draw themselves, and docstrings as plain text."""
    app.add_html_math_renderer("mathml", (_inline_formula, None), (_formula, None))
    app.connect("source-read", _with_modules)
    app.connect("autodoc-process-docstring", _plain)
    app.connect("autodoc-process-signature", _short)


def _with_modules(_app: Sphinx, page: str, source: list[str]) -> None:
    """A section for each module of the files and folders that a page of the reference names."""

    def sections(named: re.Match[str]) -> str:
        text = ""
        for part in named[1].split():
            files_of_part = sorted((_package / part).rglob("*.py")) or [_package / f"{part}.py"]
            for file in files_of_part:
                module = ".".join(["isopeel", *file.relative_to(_package).with_suffix("").parts])
                module = module.removesuffix(".__init__")
                text += f"## `{module}`\n\n```{{eval-rst}}\n.. automodule:: {module}\n```\n\n"
        return text

    if page.startswith("api/"):
        source[0] = re.sub(r"<!-- modules: (.*?) -->", sections, source[0])


def _inline_formula(self: HTML5Translator, node: nodes.math) -> None:
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _formula(self: HTML5Translator, node: nodes.math_block) -> None:
    self.body.append(self.starttag(node, "div", CLASS="formula"))
    self.body.append(convert(node.astext(), display="block"))
    if node["number"]:
        self.body.append(f'<span class="eqno">({get_node_equation_number(self, node)})')
        self.add_permalink_ref(node, "Link to this equation")
        self.body.append("</span>")
    self.body.append("</div>\n")
    raise nodes.SkipNode


def _short(
    _app: Sphinx,
    _what: str,
    _name: str,
    _of: object,
    _options: object,
    arguments: str | None,
    returned: str | None,
) -> tuple[str | None, str | None]:
    """The names that arrays have in the code."""
    texts = [arguments, returned]
    for kind, name in (("float64", "FloatArray"), ("int64", "IntArray")):
        array = re.compile(rf"~?(?:\w+\.)*ndarray\[tuple\[[^]]*\], ~?(?:\w+\.)*dtype\[~?(?:\w+\.)*{kind}\]\]")
        texts = [text and array.sub(name, text) for text in texts]
    return texts[0], texts[1]


def _plain(_app: Sphinx, _what: str, _name: str, _of: object, _options: object, lines: list[str]) -> None:
    """Keep formulas in docstrings from being read as markup, and what is indented as it is written."""
    plain: list[str] = []
    literal = False
    for line in lines:
        indented = line.startswith(" ")
        if indented and not literal:
            plain += ["", "::", ""]
            literal = True
        elif literal and line and not indented:
            plain.append("")
            literal = False
        parts = re.split(r"(`[^`]*`)", line)
        if not literal:
            parts[::2] = [re.sub(r"([*_|\\])", r"\\\1", part) for part in parts[::2]]
        plain.append("".join(parts))
    lines[:] = plain
