"""The reference of keys: each key has a meaning, and each example is part of a case that is read."""

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from isopeel.case import Case, absent
from isopeel.case.reference import FAMILIES, PARTS, FamilyEntry, KeyEntry, KindEntry, tables
from isopeel.common.errors import InputError

STRIP = {"shape": "strip", "length": "200 nm", "height": "100 nm"}
STEEL = {"law": "neo-hooke", "youngs_modulus": "2 GPa", "poissons_ratio": 0.2}
LAW = {"law": "exponential", "strength": "80 MPa", "work_of_adhesion": "0.03 J/m^2"}
#: A patch, which the example of the key `file` names.
PATCH = {
    "SplineType": "Bezier",
    "para_dim": 2,
    "dim": 2,
    "degrees": [1, 1],
    "control_points": [[0, 0], [1, 0], [0, 1], [1, 1]],
}


def one_body() -> dict[str, Any]:
    return {"name": "one", "body": dict(STRIP), "material": dict(STEEL), "adhesion": dict(LAW)}


def several_bodies() -> dict[str, Any]:
    upper = {"name": "upper", **STRIP, "at": ["0 nm", "100 nm"], "material": dict(STEEL)}
    return {
        "name": "several",
        "body": [upper, {"name": "lower", **STRIP, "material": dict(STEEL)}],
        "interface": [{"between": ["upper.bottom", "lower.top"], **LAW}],
        "support": [{"boundary": "lower.bottom", "holds": "xy"}],
        "drive": {"boundary": "upper.right"},
    }


def with_key(table: str, key: KeyEntry) -> dict[str, Any]:
    """A case with a table that has a key as in its example."""
    several = any(table == name for name, _, _ in PARTS["several bodies"][1:])
    several = several or table in ("drive.on", "load") or (table, key.name) == ("drive", "boundary")
    case = several_bodies() if several else one_body()
    own = {key.name: key.example}
    if table == "":
        return case | own
    if table == "drive.on":
        return case | {"drive": {"on": [{"boundary": "upper.left"}, {"boundary": "lower.right"} | own]}}
    if table == "load":
        return case | {"load": [{"boundary": "upper.top", "force": "0.01 N/m", "angle": "90 deg"} | own]}
    if table == "tie":
        return case | {"tie": [own], "interface": [{"boundary": "lower.bottom", **LAW}]}
    if table == "interface" and key.name in ("scheme", "smoothed", "law", "irreversible", "between"):
        return case | {"interface": [case["interface"][0] | own]}
    if table == "interface":
        return case | {"interface": [{"boundary": "lower.bottom", **LAW} | own]}
    if table == "support":
        return case | {"support": [{"boundary": "lower.bottom", "holds": "xy"} | own]}
    if table == "drive" and not several:
        return case | {"drive": {"side": "right"} | own}
    return case | {table: case.get(table, {}) | own}


def of_body(key: KeyEntry) -> dict[str, Any]:
    """A case of several bodies, whose upper body has a key as in its example."""
    case = several_bodies()
    upper, lower = case["body"]
    if key.name == "on":
        upper.pop("at")
    if key.name == "gap":
        upper = upper | {"on": "lower.top"}
    return case | {"body": [upper | {key.name: key.example}, lower]}


def of_kind(family: FamilyEntry, kind: KindEntry, key: KeyEntry | None) -> dict[str, Any]:
    """A case with a kind, which has its required keys and another one as in their examples."""
    table, chooser = family.chooser.split(".")
    own = {chooser: kind.name} | {one.name: one.example for one in kind.keys if one.is_required}
    if table == "drive" and kind.name != "rotation":
        own |= {"side": "right", "to": "20 nm", "step": "1 nm"}
    if "energy" in own or "potential" in own or "formula" in own:
        own |= {one.name: one.example for one in kind.keys if one.name == "constants"}
    if key is not None:
        own |= {key.name: key.example}
    if table == "interface":
        return several_bodies() | {"interface": [{"between": ["upper.bottom", "lower.top"]} | own]}
    return one_body() | {table: own}


def keys_of_tables() -> Iterator[Any]:
    for part in PARTS:
        for table in tables(part):
            for key in table.keys:
                of_each = (table.name, part) == ("body", "several bodies")
                name = f"{part}: {table.name}.{key.name}"
                yield pytest.param(of_body(key) if of_each else with_key(table.name, key), key, id=name)


def keys_of_kinds() -> Iterator[Any]:
    for family in FAMILIES:
        for kind in family.kinds:
            for key in kind.keys or (None,):
                name = f"{family.chooser} {kind.name}: {key and key.name}"
                yield pytest.param(of_kind(family, kind, key), key, id=name)


@pytest.mark.parametrize(("document", "key"), [*keys_of_tables(), *keys_of_kinds()])
def test_each_key_has_a_meaning_and_an_example_that_is_read(
    document: dict[str, Any], key: KeyEntry | None, tmp_path: Path
) -> None:
    if key is not None:
        assert key.meaning
        # tables of their own have examples of their keys
        assert key.example is not None or key.value.kind == "tables"
        if key.example is None:
            document = {name: value for name, value in document.items() if name != "drive"}
            document |= {"drive": {"on": [{"boundary": "body.right"}]}}
    (tmp_path / "shape.json").write_text(json.dumps({"SplineList": [PATCH]}))
    text = tomli_w.dumps(document)
    assert Case.parse(text, folder=tmp_path).name == document["name"]
    assert tomllib.loads(text) == document


@pytest.mark.parametrize("name", absent.KEYS)
def test_physics_that_is_not_there_is_answered_by_what_there_is(name: str) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(tomli_w.dumps(one_body() | {"adhesion": LAW | {name: "1"}}))
    assert caught.value.field == f"adhesion.{name}"
    assert caught.value.allowed == absent.KEYS[name]
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", absent.KINDS)
def test_kinds_that_are_not_there_are_answered_by_what_there_is(name: str) -> None:
    for family in FAMILIES[:1]:
        assert name not in {kind.name for kind in family.kinds}
    with pytest.raises(InputError) as caught:
        Case.parse(tomli_w.dumps(one_body() | {"material": STEEL | {"law": name}}))
    assert caught.value.allowed.startswith(absent.KINDS[name])


@pytest.mark.parametrize(
    ("table", "wrong", "nearest"),
    [
        ("body", {"heigth": "10 nm"}, "height"),
        ("material", {"poisson_ratio": 0.2}, "poissons_ratio"),
        ("adhesion", {"work_of_adhesions": "1 J/m^2"}, "work_of_adhesion"),
        ("drive", {"stpe": "1 deg"}, "step"),
    ],
)
def test_a_mistyped_key_is_answered_with_the_nearest(table: str, wrong: dict[str, Any], nearest: str) -> None:
    case = one_body()
    with pytest.raises(InputError, match=rf"did you mean {nearest}\?"):
        Case.parse(tomli_w.dumps(case | {table: case.get(table, {}) | wrong}))


def test_a_mistyped_kind_is_answered_with_the_nearest() -> None:
    with pytest.raises(InputError, match=r"did you mean exponential\?"):
        Case.parse(tomli_w.dumps(one_body() | {"adhesion": LAW | {"law": "exponental"}}))
