"""The site builds, with every cell executed, without a warning, and loads nothing from the network."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
NOTEBOOKS = [
    page for page in DOCS.rglob("*.md") if page.read_text("utf-8").startswith("---\nfile_format: mystnb")
]


@pytest.mark.long
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    site, warnings = tmp_path / "html", tmp_path / "warnings"
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-E", "-w", str(warnings)]
    environment = os.environ | {"ISOPEEL_PLUGINS": ""}
    done = subprocess.run([*command, "-b", "html", str(DOCS), str(site)], check=False, env=environment)
    assert (done.returncode, warnings.read_text("utf-8")) == (0, "")
    pages = sorted(site.rglob("*.html"))
    assert {"index.html", "start.html", "design.html"} <= {page.name for page in pages}
    for page in pages:
        text = page.read_text("utf-8")
        # what a browser fetches by itself; links that a reader follows may lead anywhere
        fetched = re.findall(r"<(?:script|img|link|iframe|source)\b[^>]*?(?:src|href)=\"([^\"]+)\"", text)
        assert [target for target in fetched if re.match(r"(?:https?:)?//", target)] == [], page
        assert not re.search(r"url\([\"']?(?:https?:)?//", text), page
    # each page with code is a notebook, too, with what it printed
    assert len(NOTEBOOKS) > 12
    for page in NOTEBOOKS:
        notebook = tmp_path / "jupyter_execute" / page.relative_to(DOCS).with_suffix(".ipynb")
        cells = [
            cell for cell in json.loads(notebook.read_text("utf-8"))["cells"] if cell["cell_type"] == "code"
        ]
        assert any(cell["outputs"] for cell in cells), page
