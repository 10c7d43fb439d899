"""`isopeel cases`: the table of the shipped cases, and copies of them; `isopeel schema`."""

import json
from pathlib import Path

import pytest
from command_output import the_error

from isopeel.case import load_case, shipped_cases
from isopeel.case.load import shipped_text
from isopeel.case.schema import case_schema
from isopeel.cli import main

pytestmark = pytest.mark.usefixtures("in_own_folder")


@pytest.mark.parametrize("name", shipped_cases())
def test_a_copy_is_the_shipped_file(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cases", name, "--copy", "mine.toml"]) == 0
    assert "isopeel run mine.toml" in capsys.readouterr().out
    assert Path("mine.toml").read_text("utf-8") == shipped_text(name)
    assert load_case("mine.toml").text == load_case(name).text


def test_a_copy_replaces_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine.toml").write_text("mine")
    assert main(["cases", "strip", "--copy", "mine.toml"]) == 2
    assert "'mine.toml' cannot be used; it exists" in the_error(capsys)
    assert Path("mine.toml").read_text() == "mine"
    assert main(["cases", "strip", "--copy", "none/mine.toml"]) == 2
    assert "cannot be written" in the_error(capsys)


def test_a_case_is_printed_and_an_unknown_one_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cases", "t-peel"]) == 0
    assert capsys.readouterr().out == shipped_text("t-peel").rstrip() + "\n"
    assert main(["cases", "peel"]) == 2
    assert "the shipped cases are curved-substrate" in the_error(capsys)
    assert main(["cases", "--copy", "mine.toml"]) == 2
    assert "NAME" in the_error(capsys)


def test_the_schema_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == case_schema()
