"""Errors of units, files and folders are reported in one line that names the cause."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

import isopeel
from isopeel.cli import main
from isopeel.common.errors import InputError
from isopeel.common.units import parse_quantity

STRIP = isopeel.load_case("strip").text


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.count("\n") == 1
    return error


@pytest.mark.parametrize("unit", ["mil", "mils", "MPA", "furlongs per nm", "hogshead_of_nm", "Nanometer"])
def test_an_unknown_unit_is_named_with_those_that_are_known(unit: str) -> None:
    with pytest.raises(InputError) as caught:
        isopeel.Case.parse(STRIP.replace('length = "200 nm"', f'length = "1 {unit}"'))
    assert caught.value.field == "body.length"
    message = str(caught.value)
    assert "is not a known unit" in message or "is not a number and a unit" in message
    if "_" not in unit:
        assert "known units are nm, um, mm, m, in, thou, Pa" in message
    if unit.startswith("mil"):
        assert "a thousandth of an inch is 'thou'" in message


@pytest.mark.parametrize(
    ("written", "kind"),
    [
        ("3 deg", "an angle"),
        ("2 GPa", "a stress"),
        ("5 N", "a force"),
        ("5 N/25 mm", "a force per width or an energy per area"),
        ("1 nm2", "an area"),
        ("1e-19 J", "an energy"),
        ("1 Pa/m", "something else"),
    ],
)
def test_a_quantity_of_another_kind_is_reported_what_it_is(written: str, kind: str) -> None:
    with pytest.raises(InputError, match=f"a length is needed, such as '200 nm', and this is {kind}"):
        isopeel.Case.parse(STRIP.replace('length = "200 nm"', f'length = "{written}"'))


@pytest.mark.parametrize(
    ("written", "newtons_per_metre"),
    [
        ("5 N/25 mm", Fraction(200)),
        ("5 N/25mm", Fraction(200)),
        ("5 N/(25 mm)", Fraction(200)),
        ("1.5 N / 10 mm", Fraction(150)),
        ("250 cN/2.5 cm", Fraction(100)),
        ("10 N/1 in", Fraction(10) / Fraction("0.0254")),
    ],
)
def test_a_peel_force_is_read_per_width_of_the_tape(written: str, newtons_per_metre: Fraction) -> None:
    quantity = parse_quantity(written)
    assert [quantity.exact, quantity.stress, quantity.length] == [
        newtons_per_metre,
        Fraction(1),
        Fraction(1),
    ]  # rational


@pytest.mark.parametrize(
    "written", ["5 N/0 mm", "5 N/25 mm2", "5 N/25 m", "5 N/m/25 mm", "5 N/(25 mm", "5 /25 mm"]
)
def test_another_number_in_a_unit_is_refused(written: str) -> None:
    with pytest.raises(ValueError, match="it is not a number and a unit"):
        parse_quantity(written)


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_a_case_may_begin_with_the_mark_of_its_encoding(ends: str, tmp_path: Path) -> None:
    file = tmp_path / "marked.toml"
    file.write_bytes(b"\xef\xbb\xbf" + STRIP.replace("\n", ends).encode())
    assert isopeel.load_case(file).text == STRIP
    assert isopeel.Case.parse("\ufeff" + STRIP).text == STRIP


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (STRIP.encode("utf-16"), "it is UTF-16, to be saved as UTF-8"),
        (b"\xfe\xff" + STRIP.encode("utf-16-be"), "it is UTF-16, to be saved as UTF-8"),
        (b"about = '\xb5m'", "byte 9 is not"),
    ],
)
def test_another_encoding_is_named(
    content: bytes, why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "case.toml"
    file.write_bytes(content)
    assert main(["run", str(file)]) == 2
    assert f"a TOML file is UTF-8 text; {why}" in the_error(capsys)


def a_dangling_link(path: Path) -> str:
    path.symlink_to("nowhere")
    return f"{path} is a link to nowhere, where there is no folder"


def a_link_to_itself(path: Path) -> str:
    path.symlink_to(path.name)
    return f"{path} is a link to {path.name}, where there is no folder"


def a_link_to_a_file(path: Path) -> str:
    path.with_name("file").write_text("mine")
    path.symlink_to("file")
    return f"{path} is a link to file, where there is no folder"


def a_file(path: Path) -> str:
    path.write_text("mine")
    return f"{path} is not a folder"


@pytest.mark.posix
@pytest.mark.parametrize("below", ["", "in/it"])
@pytest.mark.parametrize("make", [a_dangling_link, a_link_to_itself, a_link_to_a_file, a_file])
def test_what_is_in_the_way_of_a_folder_is_named(
    make: Callable[[Path], str],
    below: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    why, out = make(Path("way")), Path("way", below)
    for command in (
        ["run", "strip", "--mesh", "10x1", "--space", "L1", "--to", "1", "--step", "1", "--out", str(out)],
        ["law", "exponential", "--out", str(out / "law.png")],
        ["paper", "--only", "table3", "--out", str(out)],
        ["validate", "--only", "bending", "--out", str(out)],
    ):
        assert main(command) == 2
        assert f"a folder that can be written is needed: {why}" in the_error(capsys)
