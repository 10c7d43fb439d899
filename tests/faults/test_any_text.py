"""Any text of a case is the same after it was stored in run.h5, and other text is refused at once."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path
from time import perf_counter

import h5py
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from isopeel.case import Case, load_case
from isopeel.case.load import LARGEST_FILE
from isopeel.case.text import LARGEST_TEXT, MOST_PARTS
from isopeel.cli import main
from isopeel.common.errors import InputError

STRIP = (
    load_case("strip").text.replace('"200x10"', '"20x1"').replace('"120 deg"', '"1 deg"').replace("0.1", "1")
)
BODY = STRIP[STRIP.index("[body]") :]
PATCH = {
    "SplineList": [
        {
            "SplineType": "Bezier",
            "para_dim": 2,
            "dim": 2,
            "degrees": [1, 1],
            "control_points": [[0, 0], [10, 0], [0, 1], [10, 1]],
        }
    ]
}


def with_about(about: str) -> Case:
    """A case with this text in it."""
    return Case.parse(tomli_w.dumps({"name": "text", "about": about}) + BODY)


@settings(max_examples=50, deadline=None, derandomize=True, database=None)
@given(st.text(max_size=60))
def test_a_case_is_read_back_from_its_text(about: str) -> None:
    case = with_about(about)
    assert case.about == about
    assert Case.parse(case.text) == case


@settings(max_examples=200, deadline=None, derandomize=True, database=None)
@given(
    st.dictionaries(
        st.text(max_size=8),
        st.one_of(
            st.text(max_size=20),
            st.integers(-(10**15), 10**15),
            st.floats(allow_nan=False),
            st.booleans(),
            st.lists(st.text(max_size=5), max_size=3),
            st.dictionaries(st.text(max_size=8), st.text(max_size=8), max_size=3),
        ),
        max_size=5,
    )
)
def test_keys_of_any_text_are_written(document: dict[str, object]) -> None:
    """As a case writes itself, whatever the keys that a later version has."""
    assert tomllib.loads(tomli_w.dumps(document)) == document


@pytest.mark.usefixtures("without_figures")
@pytest.mark.parametrize(
    "about",
    ["\x7f", "\x00\x01\x1b[2J\x9b", "two\nlines\r\nand\ta tab", 'a "quoted" \\ one', "🪟 \u2028 \u202e"],
)
def test_a_run_of_any_text_continues(about: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = tmp_path / "text.toml", str(tmp_path / "out")
    # as a file writes them, by their numbers
    escaped = "".join(f"\\U{ord(character):08x}" for character in about)
    file.write_text(f'name = "text"\nabout = "{escaped}"\n{BODY}', encoding="utf-8")
    assert main(["run", str(file), "--out", out]) == 0
    assert main(["resume", out]) == 0
    assert "\x1b[2J" not in capsys.readouterr().out
    assert main(["report", out]) == 0
    with h5py.File(f"{out}/run.h5") as stored:
        assert Case.parse(stored["case"].asstr()[()]).about == about


@pytest.mark.parametrize("about", ["\ud800", "a\udc80b"])
def test_half_of_a_pair_is_no_text(about: str) -> None:
    with pytest.raises(InputError, match="CASE: 'text' cannot be used; it contains half"):
        Case.parse(f"name = 'text'\nabout = '{about}'\n{BODY}")


def test_a_file_in_a_folder_of_another_encoding_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / os.fsdecode(b"\xff")
    try:
        folder.mkdir()
    except (OSError, UnicodeError):
        pytest.skip("the file system has no such names")
    (folder / "patch.json").write_text(json.dumps(PATCH))
    text = f"""name = "patch"\n[body]\nshape = "patch"\nfile = "patch.json"\nunit_length = "20 nm"
{BODY[BODY.index("[material]") :]}"""
    with pytest.raises(InputError, match=r"body\.file: .*must be UTF-8 text"):
        Case.parse(text, folder=folder)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param(".".join("a" * 60_000) + " = 1", f"at most {LARGEST_TEXT} bytes", id="the given one"),
        pytest.param(
            ".".join("a" * 24_000) + " = 1", f"at most {MOST_PARTS} parts", id="a key of 24,000 parts"
        ),
        pytest.param(
            "[" + " . ".join(7000 * ['"a"']) + "]", f"at most {MOST_PARTS} parts", id="texts as parts"
        ),
        pytest.param(
            "a = {" + ".".join("b" * 9000) + " = 1}", f"at most {MOST_PARTS} parts", id="inside a table"
        ),
        pytest.param("1" * 49_999, "it is not TOML", id="one word"),
        pytest.param('\\"' * 24_000, "it is not TOML", id="texts without an end"),
        pytest.param('"""\\' * 12_000, "it is not TOML", id="texts of lines without an end"),
        pytest.param("a = " + "{a = " * 9_000, "it is not TOML", id="tables in tables"),
    ],
)
def test_what_would_be_read_for_long_is_refused_at_once(text: str, message: str) -> None:
    began = perf_counter()
    with pytest.raises(InputError) as caught:
        Case.parse(text)
    assert message in str(caught.value)
    assert perf_counter() - began < 2  # 0.1 s; a key of 25,000 parts took 10 s


@pytest.mark.parametrize(
    "about", ["1." * 8000, "# " + "a.b." * 2000, "a.b." * 10 + '"' + ".c" * 4000 + '"""' + ".d" * 3000]
)
def test_points_in_texts_are_no_parts_of_keys(about: str) -> None:
    case = with_about(about)
    assert Case.parse(case.text) == case
    three = about.replace('"', "'")
    lines = Case.parse(f'name = "text"\nabout = """{three}"""  # a.{three}\n{BODY}')
    assert lines.about == three
    assert Case.parse(lines.text) == lines


def test_the_longest_file_can_be_stored() -> None:
    """Of the character that grows most when it is written as TOML."""
    quotes = '"' * (LARGEST_FILE - len(BODY.encode()) - 40)
    case = Case.parse(f"name = \"text\"\nabout = '{quotes}'\n{BODY}")
    assert LARGEST_FILE < len(case.text) < LARGEST_TEXT
    assert Case.parse(case.text) == case


@pytest.mark.posix
def test_pipes_devices_and_folders_are_no_files(tmp_path: Path) -> None:
    """Nothing waits for them."""
    pipe, run = tmp_path / "pipe", tmp_path / "run"
    os.mkfifo(pipe)
    run.mkdir()
    os.mkfifo(run / "run.h5")
    device, (case, patch) = Path("/dev/zero"), (tmp_path / name for name in ("case.toml", "patch.json"))
    os.mkfifo(patch)
    rest = BODY[BODY.index("[material]") :]
    case.write_text(f'name = "x"\n[body]\nshape = "patch"\nfile = "patch.json"\nunit_length = "1 nm"\n{rest}')
    commands = [
        *(["run", str(path), "--out", str(tmp_path / "out")] for path in (pipe, device, tmp_path, case)),
        *(["law", str(path), "--out", str(tmp_path / "law.png")] for path in (pipe, device)),
        *([command, str(run)] for command in ("resume", "plot", "report", "export")),
    ]
    code = f"from isopeel.cli import main\nprint([main(command) for command in {commands!r}])"
    # in a process of its own, which can be ended where it waits
    ended = subprocess.run(
        [sys.executable, "-P", "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert ended.stdout == f"{[2] * len(commands)}\n"
    lines = ended.stderr.splitlines()
    assert len(lines) == len(commands)
    assert all(line.startswith("isopeel: ") for line in lines)
