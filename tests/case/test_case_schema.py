"""The JSON schema accepts all shipped cases, and refuses broken ones."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator
from test_case_reference import keys_of_kinds, keys_of_tables

from isopeel.case import Case, load_case, shipped_cases
from isopeel.case.load import shipped_text
from isopeel.case.schema import case_schema
from isopeel.common.errors import InputError

SCHEMA = case_schema()
STRIP, TWO = shipped_text("strip"), shipped_text("t-peel")
#: Texts of the shipped case strip, and what breaks the case in their place.
BROKEN = {
    "an unknown key": (STRIP, 'height = "10 nm"', 'heigth = "10 nm"'),
    "a missing key": (STRIP, 'height = "10 nm"', ""),
    "a quantity without a unit": (STRIP, 'height = "10 nm"', 'height = "10"'),
    "a number for a quantity": (STRIP, 'height = "10 nm"', "height = 10"),
    "a quantity for a number": (STRIP, "poissons_ratio = 0.2", 'poissons_ratio = "0.2"'),
    "an unknown kind": (STRIP, 'law = "neo-hooke"', 'law = "ogden"'),
    "a key of another kind": (STRIP, 'height = "10 nm"', 'height = "10 nm"\nradius = "1 nm"'),
    "an unknown table": (STRIP, "[discretization]", "[mesh]\n[discretization]"),
    "a missing table": (STRIP, "[material]", "[materials]"),
    "a bad choice": (STRIP, "[discretization]", '[held]\nleft = "z"\n[discretization]'),
    "too few values": (STRIP, 'window = ["98 deg", "101.4 deg"]', 'window = ["98 deg"]'),
    "a whole number out of range": (STRIP, "[discretization]", "[discretization]\ncontact_points = 0"),
    "a body without a name": (TWO, 'name = "upper"', ""),
}


def errors(document: dict[str, Any]) -> list[str]:
    return [error.message for error in Draft7Validator(SCHEMA).iter_errors(document)]


def test_it_is_a_schema() -> None:
    Draft7Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("name", shipped_cases())
def test_it_accepts_the_shipped_cases(name: str) -> None:
    assert errors(tomllib.loads(shipped_text(name))) == []


@pytest.mark.parametrize(("document", "_key"), [*keys_of_tables(), *keys_of_kinds()])
def test_it_accepts_each_example_of_the_reference(document: dict[str, Any], _key: object) -> None:
    if document != with_no_empty_values(document):
        pytest.skip("the key has tables of its own, without an example")
    assert errors(document) == []


def with_no_empty_values(document: dict[str, Any]) -> dict[str, Any]:
    """The document without keys that have no example."""
    return {
        name: {key: one for key, one in value.items() if one is not None}
        if isinstance(value, dict)
        else value
        for name, value in document.items()
    }


@pytest.mark.parametrize("kind", BROKEN)
def test_it_refuses_what_a_case_refuses(kind: str) -> None:
    text, old, new = BROKEN[kind]
    assert text.count(old) >= 1
    broken = text.replace(old, new, 1)
    with pytest.raises(InputError):
        Case.parse(broken)
    assert errors(tomllib.loads(broken)) != []


def test_check_jsonschema_reads_the_schema_and_a_case(tmp_path: Path) -> None:
    schema, good, bad = tmp_path / "case.schema.json", tmp_path / "good.toml", tmp_path / "bad.toml"
    schema.write_text(json.dumps(SCHEMA))
    good.write_text(load_case("strip").text)
    bad.write_text(STRIP.replace('height = "10 nm"', 'heigth = "10 nm"'))
    command = [sys.executable, "-P", "-m", "check_jsonschema", "--schemafile", str(schema)]
    assert subprocess.run([*command, str(good)], capture_output=True).returncode == 0
    refused = subprocess.run([*command, str(bad)], capture_output=True, text=True)
    assert refused.returncode == 1
    assert "heigth" in refused.stdout
