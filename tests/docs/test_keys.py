"""The page on the keys of a case file, and `isopeel help`, have all keys that the code has."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import pytest

from isopeel.case import OneBody, SeveralBodies
from isopeel.case.kinds import KindSection
from isopeel.case.reference import FAMILIES, PARTS
from isopeel.case.values import Section
from isopeel.cli import main
from isopeel.common.registry import discover
from isopeel.output.key_reference import paths, with_tables

PAGE = (Path(__file__).parents[2] / "docs" / "keys.md").read_text("utf-8")


def section_of(annotation: object) -> type[Section] | None:
    """The table that a key holds, or each table of a list."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return annotation
    return next(filter(None, map(section_of, get_args(annotation))), None)


def keys_in(section: type[Section], table: str = "") -> Iterator[str]:
    """Yield all keys as TABLE.KEY, by the models that check a case."""
    for name, field in section.model_fields.items():
        inner = section_of(field.annotation)
        if inner is None or name in ("between", "material", "substrate"):
            yield f"{table}.{name}".lstrip(".")
        if inner is not None and (table, name) not in (("body", "material"), ("interface", "substrate")):
            yield from keys_in(inner, f"{table}.{name}".lstrip("."))
    if issubclass(section, KindSection) and section.maker is None:
        yield f"{table}.{section.chooser}"
        for name in {name for package in section.packages for name in discover(package)}:
            chosen = section.chosen({section.chooser: name})
            yield from (f"{table}.{key}" for key in chosen.model_fields)


def test_the_tables_of_the_page_are_those_of_the_code() -> None:
    # `python -P -m isopeel.output.key_reference docs/keys.md` writes them anew
    assert with_tables(PAGE) == PAGE
    assert re.findall(r"<!-- keys: (.*?) -->", PAGE) == list(PARTS)
    assert re.findall(r"<!-- kinds: (.*?) -->", PAGE) == [family.title for family in FAMILIES]


@pytest.mark.parametrize("form", [OneBody, SeveralBodies])
def test_each_key_of_the_models_is_in_the_reference(form: type[Section]) -> None:
    sides = re.compile(r"(interface|tie)\.between\.")
    tables = {"material", "substrate"}
    found = {key for key in keys_in(form) if not sides.match(key)} - tables
    assert len(found) > 40
    assert found - set(paths()) == set()


def test_help_shows_a_key_of_each_table_that_has_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["help", "gap"]) == 0
    shown = capsys.readouterr().out
    assert "body.gap" in shown
    assert "substrate.gap" in shown
    assert main(["help", "interface.1.scheme"]) == 0
    assert "unbiased" in capsys.readouterr().out
    assert main(["help"]) == 0
    assert "held: left, right, bottom, top" in capsys.readouterr().out


def test_help_names_the_nearest_key(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["help", "body.heigth"]) == 2
    assert "did you mean 'body.height'?" in capsys.readouterr().err


def test_help_names_the_kinds_that_share_a_key(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["help", "adhesion.strength"]) == 0
    assert "adhesion.strength (dugdale, exponential, trapezoidal)\n" in capsys.readouterr().out
    assert main(["help", "drive"]) == 0
    assert 'drive.kind\n    the kind, with keys of its own\n    "displacement"' in capsys.readouterr().out


def test_help_says_what_there_is_in_place_of_missing_physics(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["help", "drive.rate"]) == 2
    assert "isopeel has no rate effects; give a work_of_adhesion" in capsys.readouterr().err
