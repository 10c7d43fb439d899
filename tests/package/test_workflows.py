"""The workflow files: that GitHub would take them, and what they do."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def workflow(name: str) -> Any:
    return YAML(typ="safe").load(ROOT / ".github" / "workflows" / name)


def test_there_are_two() -> None:
    assert [path.name for path in WORKFLOWS] == ["release.yml", "tests.yml"]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_each_is_valid(path: Path) -> None:
    """By the schema that comes with check-jsonschema."""
    schema = ("--builtin-schema", "vendor.github-workflows")
    checked = subprocess.run(
        [sys.executable, "-m", "check_jsonschema", *schema, str(path)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout


def test_tests_run_on_three_systems_and_the_oldest_python() -> None:
    jobs = workflow("tests.yml")["jobs"]
    matrix = jobs["test"]["strategy"]["matrix"]
    assert matrix["os"] == ["ubuntu-latest", "macos-latest", "windows-latest"]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert f">={matrix['python'][0]}" == project["requires-python"]
    commands = [step.get("run", "") for job in jobs.values() for step in job["steps"]]
    assert {"ruff check .", "ruff format --check .", "mypy", "python -m pytest"} <= set(commands)
    # make is not on every system
    assert not any(re.search(r"\bmake\b", command) for command in commands)


def test_tests_ask_for_extras_and_marks_that_there_are() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    extras = settings["project"]["optional-dependencies"]
    marks = {mark.partition(":")[0] for mark in settings["tool"]["pytest"]["ini_options"]["markers"]}
    for path in WORKFLOWS:
        text = path.read_text("utf-8")
        named = {extra for found in re.findall(r'"\.\[([a-z,]+)\]"', text) for extra in found.split(",")}
        assert named
        assert named <= set(extras)
        for expression in re.findall(r'-m "?((?:long|not|posix|or|and| )+)"?', text):
            assert set(expression.split()) - {"not", "and", "or"} <= marks


def test_only_publishing_may_sign_in_and_only_after_the_build() -> None:
    release = workflow("release.yml")
    assert release["on"] == {"push": {"tags": ["v*"]}}
    assert release["permissions"] == {"contents": "read"}
    publish = release["jobs"]["publish"]
    assert (publish["needs"], publish["environment"]["name"]) == ("build", "pypi")
    assert publish["permissions"] == {"id-token": "write"}
    assert "permissions" not in release["jobs"]["build"]
    used = [step["uses"].partition("@")[0] for step in publish["steps"]]
    # what publishes runs no code of the repository
    assert used == ["actions/download-artifact", "pypa/gh-action-pypi-publish"]
    assert not any("run" in step for step in publish["steps"])
