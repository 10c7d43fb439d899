"""What a text holds that a terminal would obey is shown, and not obeyed."""

import io
from pathlib import Path
from typing import Any

import h5py
import pytest
from rich.table import Table
from rich.text import Text

from isopeel.cli import main
from isopeel.cli.terminal import PlainConsole
from isopeel.common.errors import visible

#: Colour, clearing, a title with its end, a C1 introducer, backspaces, deletion, and text turned around.
HOSTILE = [
    "\x1b[31mred",
    "\x1b[2J\x1b[Hgone",
    "\x1b]0;title\x07",
    "\x9b31mC1",
    "a\x08\x08b",
    "a\x7fb",
    "\u202eevil\u202c",
    "\u2066x\u2069",
    "a\rb",
    "\x00",
]


def obeyed(text: str) -> set[str]:
    return {one for one in text if not one.isprintable() and one != "\n"}


@pytest.mark.parametrize("text", HOSTILE)
def test_a_console_shows_it_in_any_place(text: str) -> None:
    file = io.StringIO()
    console = PlainConsole(file=file, markup=False, emoji=False, highlight=False, width=100)
    table = Table(text, "", title=text)
    table.add_row(text, Text(text))
    for one in (text, Text(text), table):
        console.print(one)
    console.print(text, soft_wrap=True)
    assert not obeyed(file.getvalue())
    assert file.getvalue().count(visible(text).strip()) >= 5


@pytest.mark.parametrize("text", HOSTILE)
def test_what_is_visible_stays_so(text: str) -> None:
    assert visible(visible(text)) == visible(text)
    assert not obeyed(visible(text))


def test_plain_texts_stay_as_they_are() -> None:
    for text in ("J/m²", "20 µm", "Übergröße", "two\nlines", "粘着"):
        assert visible(text) == text


@pytest.fixture(scope="module")
def stored(without_figures: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run") / "out"
    small = ("--mesh", "10x1", "--space", "L1", "--to", "2", "--step", "1")
    assert main(["run", "strip", *small, "--out", str(folder)]) == 0
    return folder


@pytest.mark.parametrize("attribute", ["L0", "space", "platform", "command_line", "ending"])
@pytest.mark.parametrize("command", ["report", "compare", "export", "resume"])
def test_no_command_lets_a_stored_run_steer_the_terminal(
    stored: Path, attribute: str, command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "run.h5").write_bytes((stored / "run.h5").read_bytes())
    with h5py.File(folder / "run.h5", "r+") as file:
        file.attrs[attribute] = "\x1b]0;owned\x07 \x9b31m \u202e"
    arguments: dict[str, Any] = {"compare": [str(folder), str(stored), "--out", str(tmp_path / "compare")]}
    assert main([command, *arguments.get(command, [str(folder)])]) in (0, 2)
    message = capsys.readouterr()
    assert not obeyed(message.out + message.err)
