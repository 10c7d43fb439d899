"""`isopeel spaces` and `isopeel law`: figures, what is printed, and input that they refuse."""

from pathlib import Path

import pytest
from command_output import the_error

from isopeel.cli import main
from isopeel.output.law import LAWS

pytestmark = pytest.mark.usefixtures("in_own_folder")


def test_spaces_draws_and_prints(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["spaces", "L1+N2.1@2", "--mesh", "20x4", "--out", "figures/space.png"]) == 0
    assert Path("figures/space.png").read_bytes().startswith(b"\x89PNG")
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    # 2 rows of (n - 1)(p - c) + p + 1 = 19 x 2 + 4 cubics on 2 elements each, 3 rows of 20 + 1 hats
    assert "contact 2 3 C1 2 elements 84 168" in lines
    assert "bulk 3 1 C0 2 elements 63 126" in lines
    assert "a displacement field has 294 DOFs on 20x4 elements" in lines
    assert main(["spaces", "H3"]) == 0
    assert Path("out/N2.1.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["L0"], ["NAME", "'L0'"]),
        (["L2", "--mesh", "0x1"], ["--mesh", "'0x1'"]),
        (["L2", "--mesh", "3"], ["--mesh", "'3'"]),
        (["L2", "--out", "a.xyz"], ["--out", "'a.xyz'", ".png"]),
        (["L2", "--out", "file/a.png"], ["file", "written"]),
    ],
)
def test_spaces_refuses_what_makes_no_sense(
    arguments: list[str], message: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("file").touch()
    assert main(["spaces", *arguments]) == 2
    error = the_error(capsys)
    for words in message:
        assert words in error


@pytest.mark.parametrize("name", sorted(set(LAWS) - {"contact"}))
def test_law_draws_and_prints(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["law", name, "--out", "law.svg"]) == 0
    message = capsys.readouterr().out
    # all have the strip's strength and work
    assert "123.57 MPa" in message
    assert "0.030665 J/m^2" in message
    assert Path("law.svg").stat().st_size > 1000


def test_law_shows_that_of_a_case() -> None:
    assert main(["law", "strip"]) == 0
    assert Path("out/strip.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["exponentil"], ["NAME", "'exponentil'", "van-der-waals", "strip"]),
        (["dugdale", "--out", "law.gif"], ["--out", "'law.gif'", ".png"]),
        ([], ["NAME"]),
    ],
)
def test_law_refuses_what_makes_no_sense(
    arguments: list[str], message: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["law", *arguments]) == 2
    error = the_error(capsys)
    for words in message:
        assert words in error
