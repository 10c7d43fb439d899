"""The page on the keys of a case file has all of them."""

import re
from dataclasses import fields
from pathlib import Path
from typing import get_args

import pytest

from isopeel.case import Case, OneBody, SeveralBodies
from isopeel.case.kinds import KindSection
from isopeel.case.values import Section
from isopeel.common.registry import discover

#: Tables of lists, each with its own table on the page.
LISTS = ("body", "interface", "tie", "support", "load")
PAGE = (Path(__file__).parents[2] / "docs" / "keys.md").read_text("utf-8")


def section_of(annotation: object) -> type[Section] | None:
    """The table that a key holds, or each table of a list."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return annotation
    return next(filter(None, map(section_of, get_args(annotation))), None)


def tables(form: type[Case]) -> dict[str, type[Section]]:
    found = {name: section_of(field.annotation) for name, field in form.model_fields.items()}
    return {name: section for name, section in found.items() if section is not None}


@pytest.mark.parametrize(
    "key",
    [
        f"{table}.{key}"
        for table, section in tables(OneBody).items()
        for key in section.model_fields
        if table != "load"
    ],
)
def test_each_key_of_a_table_is_there(key: str) -> None:
    assert f"`{key}`" in PAGE


@pytest.mark.parametrize("family", KindSection.__subclasses__())
def test_each_kind_is_there_with_its_own_keys(family: type[KindSection]) -> None:
    (part,) = re.findall(
        rf"\| `{family.table}\.{family.chooser}` \| keys \|\n.*?\n\n", PAGE + "\n", re.DOTALL
    )
    rows = dict(re.findall(r"^\| `([\w-]+)` \| (.*) \|$", part, re.MULTILINE))
    (package,) = family.packages
    kinds = discover(package)
    assert set(rows) == set(kinds)
    for name, kind in kinds.items():
        own = {field.name for field in fields(kind) if field.init} - family.own
        assert set(re.findall(r"`(\w+)`", rows[name])) == own, name


def test_each_joint_law_is_there_with_its_own_keys() -> None:
    (part,) = re.findall(r"\| `law` between two bodies \| keys \|\n.*?\n\n", PAGE, re.DOTALL)
    rows = dict(re.findall(r"^\| `([\w-]+)` \| (.*) \|$", part, re.MULTILINE))
    kinds = discover("isopeel.physics.joints")
    assert set(rows) == set(kinds)
    for name, kind in kinds.items():
        assert set(re.findall(r"`(\w+)`", rows[name])) == {field.name for field in fields(kind)}, name


@pytest.mark.parametrize("table", LISTS)
def test_each_key_of_a_table_of_a_list_is_there(table: str) -> None:
    (part,) = re.findall(rf"\| key of an? `\[\[{table}\]\]`.*?(?:\n\n|\Z)", PAGE, re.DOTALL)
    keys = set(tables(SeveralBodies)[table].model_fields)
    assert {key for key in keys if f"`{key}`" not in part} == set()
