"""The cases on the page on several bodies run, and give what the page says of them."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from isopeel import Case
from isopeel.cli import main

PAGE = (Path(__file__).parents[2] / "docs" / "howto" / "bodies.md").read_text("utf-8")
CASES = dict(re.findall(r"^%%writefile (\S+\.toml)\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE))
#: The tables that the page appends, in the order of the page.
APPENDED = re.findall(r"^cat >> \S+ << END\n(.*?)^END", PAGE, re.DOTALL | re.MULTILINE)

pytestmark = pytest.mark.usefixtures("in_own_folder", "without_figures")


def curve(folder: str) -> dict[str, np.ndarray[tuple[int], np.dtype[np.float64]]]:
    with Path(folder, "curve.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {
        name.partition(" [")[0]: np.array([float(row[name] or "nan") for row in rows])
        for name in rows[0]
        if name != "kind"
    }


def test_the_machine_s_force_is_the_sum_of_factor_times_reaction() -> None:
    Path("machine.toml").write_text(CASES["machine.toml"], "utf-8")
    assert main(["run", "machine.toml", "--to", "1 nm"]) == 0
    found = curve("out/machine")
    total = found["first.right"] + 0.5 * found["second.right"]
    np.testing.assert_allclose(found["force"], total, rtol=1e-12)  # a sum of two
    # an arm of 40 nm whose end is propped, by beam theory: from a clamped to a hinged root
    held_down = -found["second.right"][0] / 1e-3
    assert 0.328 < held_down < 0.5
    # both strips are alike: lifted as far, the force grows as much, but for squares of 0.4 nm in 40 nm
    grown = found["second.right"] - found["second.right"][0]
    assert found["displacement"][[2, 4]].tolist() == [0.4, 0.8]
    assert grown[4] == pytest.approx(found["first.right"][2], rel=0.01)


def test_a_body_can_be_added_when_it_is_held(capsys: pytest.CaptureFixture[str]) -> None:
    body, support = APPENDED
    Path("three.toml").write_text(CASES["patches.toml"] + body, "utf-8")
    command = ["run", "three.toml", "--to", "2", "--out", "three"]
    assert main(command) == 2
    assert "a motion along x of the body pad" in capsys.readouterr().err
    Path("three.toml").write_text(CASES["patches.toml"] + body + support, "utf-8")
    assert main(command) == 0
    assert [one.name for one in Case.parse(Path("three.toml").read_text("utf-8")).problem().bodies] == [
        *("strip", "block", "pad")
    ]
    # the new body carries nothing: the moment is that without it
    Path("patches.toml").write_text(CASES["patches.toml"], "utf-8")
    assert main(["run", "patches.toml", "--to", "2", "--out", "two"]) == 0
    moment, without = (curve(folder)["moment"] for folder in ("three", "two"))
    np.testing.assert_allclose(moment, without, rtol=1e-8)  # two systems, to the tolerance of the solver
