"""Cases with impossible values: one line of error, before any step is made."""

from pathlib import Path

import pytest

from isopeel.case import load_case
from isopeel.cli import main

STRIP, CURVED, TAPE, CYLINDER = (
    load_case(name).text for name in ("strip", "curved-substrate", "tape-angle", "cylinder-pull-off")
)
OF_W_AND_S = 'constants = { W = "0.03 J/m^2", s = "1 nm" }'
LAW = 'law = "van-der-waals"\nhamaker_constant = "1e-19 J"\nequilibrium_distance = "0.4 nm"'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param(
            STRIP.replace(LAW, 'law = "formula"\npotential = "W*exp(-r/s)"\n' + OF_W_AND_S),
            "adhesion.potential: 'W*exp(-r/s)' cannot be used; it must have a minimum",
            id="a law without an equilibrium",
        ),
        pytest.param(
            STRIP.replace(LAW, 'law = "formula"\npotential = "W*(r/s)**2"\n' + OF_W_AND_S),
            "adhesion.potential: 'W*(r/s)**2' cannot be used; its attraction must vanish",
            id="a law that never lets go",
        ),
        pytest.param(
            STRIP + '[substrate]\ngap = "-1 nm"\n',
            "substrate.gap: '-1 at X = (",
            id="a body inside the substrate",
        ),
        pytest.param(
            CURVED.replace('kind = "circle"\nradius = "200 nm"', 'kind = "circle"\nradius = "250 nm"'),
            "the body must not overlap the substrate at the start",
            id="a cylinder that is too wide",
        ),
        pytest.param(
            STRIP
            + '[substrate]\nkind = "formula"\nformula = "sqrt(R**2 - x**2)"\nconstants = { R = "10 nm" }\n',
            "substrate: 'FormulaSubstrate' cannot be used; it must have a closest point to every point",
            id="a substrate that ends",
        ),
        pytest.param(
            STRIP.replace('name = "strip"', 'name = "strip"\nheld = {}'),
            "held: 'a motion along x' cannot be used; nothing prevents this motion of the body",
            id="a free motion",
        ),
        pytest.param(
            CYLINDER.replace("[body]", "[held]\n[body]"),
            "held: 'a motion along x' cannot be used; nothing prevents this motion of the body",
            id="a cylinder that may roll or slide",
        ),
        pytest.param(
            STRIP.replace('name = "strip"', 'name = "strip"\nheld = { right = "x" }'),
            "held: 'right' cannot be used; the drive moves the side right, which shares points with it",
            id="held and driven",
        ),
        pytest.param(
            TAPE.replace('to = "40 nm"', 'to = "40 N/m"'),
            "drive.to: '40 N/m' cannot be used; a length is needed",
            id="a force for a displacement",
        ),
        pytest.param(
            TAPE.replace('side = "right"', 'side = "right"\nfollows = true\npath_control = "jump"'),
            "drive.path_control: 'jump' cannot be used; projected and following forces have no energy",
            id="a jump without an energy",
        ),
        pytest.param(
            TAPE.replace("\nsliding_length", "\nirreversible = true\nsliding_length"),
            "adhesion.sliding_length: '0.3 nm' cannot be used; a joint that holds along the substrate",
            id="damage of a joint that slides",
        ),
        pytest.param(
            CURVED.replace("[substrate]", "symmetric = true\n[substrate]").replace(
                'length = "150 nm"\n\nsymmetric', 'length = "150 nm"\nsymmetric'
            ),
            "adhesion.symmetric: True cannot be used; a body meets its mirror image at a plane",
            id="a curved mirror",
        ),
    ],
)
def test_bad_cases_end_with_2_and_one_line(
    text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(text)
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param("a" * 300_000, "a case has at most 20000 bytes", id="too long"),
        pytest.param("a = " + "[" * 9_000, "it is not TOML", id="nested lists"),
        pytest.param(
            ".".join("a" * 9_000) + " = 1", "a key of a case has at most 20 parts", id="nested tables"
        ),
        pytest.param(f"a = {'9' * 5000}", "it is not TOML", id="a number of many digits"),
        pytest.param(
            '"\\u001b[2J\\u2028" = 1\n' + STRIP, r"\x1b[2J : 1 cannot be used", id="signs of a terminal"
        ),
        pytest.param(
            STRIP.replace('fields_every = "10 deg"', 'fields_every = "1e-9 deg"'),
            "output.fields_every: '1e-09 degrees' cannot be used; the displacements at its multiples need",
            id="fields that fill the memory",
        ),
    ],
)
def test_what_would_fill_memory_or_terminal_ends_with_2_and_one_line(
    text: str,
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Memory:
        available = 200 * 2**20

    monkeypatch.setattr("isopeel.running.checks.virtual_memory", lambda: Memory)
    file = tmp_path / "bad.toml"
    file.write_text(text)
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.splitlines()) == 1
    assert len(error) < 1000
    assert not (tmp_path / "out").exists()
