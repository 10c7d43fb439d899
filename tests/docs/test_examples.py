"""Each example runs, and a number of each is checked."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

FOLDER = Path(__file__).parents[2] / "examples"


def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_example_is_tested() -> None:
    assert {file.stem for file in FOLDER.glob("*.py")} == {"peel_a_strip", "own_law", "compare_spaces"}


def test_peel_a_strip() -> None:
    moment, closed_form = example("peel_a_strip").main(elements=(200, 4))
    assert moment == pytest.approx(closed_form, rel=3e-3)  # thin-beam theory


def test_own_law() -> None:
    built_in, own = example("own_law").main()
    # the same work of adhesion and small-strain moduli; the materials differ at strains of 10 %
    assert own == pytest.approx(built_in, rel=0.02)
    assert own != built_in


def test_compare_spaces() -> None:
    amplitudes = example("compare_spaces").main()
    # published: N4 2.9e-3, N2.1 in the contact row alone 0.34e-3; with all rows less
    assert amplitudes["N4"] == pytest.approx(2.9e-3, rel=0.1)
    assert amplitudes["Q1N2.1"] == pytest.approx(0.35e-3, rel=0.1)
    assert amplitudes["N2.1"] < 0.3 * amplitudes["Q1N2.1"]
