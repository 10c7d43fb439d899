"""Runs of several bodies, interfaces and supports, from their case files to the end."""

import json
import signal
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from rich.console import Console

import isopeel
from isopeel import InputError
from isopeel.case import Case, with_options
from isopeel.cli import main
from isopeel.results.run_file import read_run
from isopeel.running.resume import resume_case
from isopeel.running.run import run_case
from isopeel.running.run_reader import read_stages
from isopeel.solve.trace import trace

QUIET = Console(quiet=True)

pytestmark = pytest.mark.usefixtures("without_figures")

LAWS = {
    "upper": 'law = "van-der-waals"\nhamaker_constant = "1e-19 J"\nequilibrium_distance = "0.4 nm"',
    "lower": 'law = "exponential"\nstrength = "60 MPa"\nwork_of_adhesion = "0.03 J/m^2"\nirreversible = true',
}
STIFFNESS = {"upper": "2 GPa", "lower": "1 GPa"}
MESH = {"upper": 'space = "N2"\nmesh = "20x2"', "lower": 'space = "L2"\nmesh = "16x1"'}
DRIVE = 'to = "12 deg"\nstep = "1 deg"\n'


def material(name: str) -> str:
    return f'law = "neo-hooke"\nyoungs_modulus = "{STIFFNESS[name]}"\npoissons_ratio = 0.2'


def tables(held: str = "") -> str:
    """Two tapes side by side on one substrate; one may be held at its right end."""
    text = 'name = "both"\n'
    for name, at in (("upper", "0 nm"), ("lower", "100 nm")):
        table = material(name).replace("\n", ", ")
        text += f'[[body]]\nname = "{name}"\nlength = "20 nm"\nheight = "2 nm"\nat = ["{at}", "0 nm"]\n'
        text += f"material = {{ {table} }}\n{MESH[name]}\n"
        text += f'[[interface]]\nboundary = "{name}.bottom"\nlength = "15 nm"\n{LAWS[name]}\n'
        text += 'substrate = { kind = "flat" }\n'
        text += f'[[support]]\nboundary = "{name}.left"\nholds = "x"\n'
        if name == held:
            text += f'[[support]]\nboundary = "{name}.right"\nholds = "xy"\n'
    return text


def both(driven: str) -> Case:
    """A drive on one of the tapes, while the other one is held."""
    (held,) = {"upper", "lower"} - {driven}
    return Case.parse(f'{tables(held)}[drive]\nboundary = "{driven}.right"\n{DRIVE}')


def alone(name: str) -> Case:
    """One of them in the short form."""
    return Case.parse(
        f'name = "alone"\n[body]\nlength = "20 nm"\nheight = "2 nm"\n[material]\n{material(name)}\n'
        f'[adhesion]\nlength = "15 nm"\n{LAWS[name]}\n[discretization]\n{MESH[name]}\n[drive]\n{DRIVE}'
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of both."""
    place = tmp_path_factory.mktemp("both")
    (place / "case.toml").write_text(both("lower").text)
    assert main(["run", str(place / "case.toml"), "--out", str(place / "out")]) == 0
    return place / "out"


def test_two_tapes_in_one_run_have_the_curves_of_two_runs(folder: Path, tmp_path: Path) -> None:
    run_case(both("upper"), tmp_path / "upper", QUIET)
    for name, place in (("lower", folder), ("upper", tmp_path / "upper")):
        run_case(alone(name), tmp_path / "alone" / name, QUIET)
        expected = read_run(tmp_path / "alone" / name / "run.h5").curve.reaction
        found = read_run(place / "run.h5").curve.reaction
        # both are converged; what the other tape relaxes by at first works on nothing that is driven
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())
        assert np.abs(expected).max() > 0


def test_the_file_has_the_space_of_each_body_and_the_history_of_each_interface(folder: Path) -> None:
    run = read_run(folder / "run.h5")
    (stage,) = read_stages(folder)
    assert run.ending == "completed"
    assert (run.attributes["space"], run.attributes["mesh"]) == ("N2, L2", "20x2, 16x1")
    sizes = {name: space.size for name, space in stage.spaces.items()}
    with h5py.File(folder / "run.h5") as file:
        assert set(file["spaces"]) == {"upper", "lower"}
        assert [file[f"spaces/{name}"].attrs["first"] for name in ("upper", "lower")] == [0, sizes["upper"]]
        assert file["fields/displacement"].shape[1] == sum(sizes.values())
        # 12 of 16 elements of degree 2, and 15 of 20
        shapes = [file[f"history/{name}.bottom/maximum_openings"].shape[1:] for name in ("upper", "lower")]
        assert shapes == [(15, 3), (12, 3)]
        opened = file["history/lower.bottom/maximum_openings"][-1]
        # only the joint that is damaged has a history
        assert opened.max() > 0.01
        assert file["history/upper.bottom/maximum_openings"][-1].max() == 0
    np.testing.assert_array_equal(run.states[-1].maximum_openings.ravel()[-opened.size :], opened.ravel())
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["completed"]
    assert summary["mesh"] == "20x2, 16x1"


def test_an_interrupted_run_continues_bit_for_bit(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*arguments: Any, **options: Any) -> Iterator[isopeel.Step]:
        yield from islice(trace(*arguments, **options), 5)
        signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr("isopeel.running.stage_trace.trace", interrupted)
        assert run_case(both("lower"), tmp_path, QUIET).run.ending == "interrupted"
    assert len(read_run(tmp_path / "run.h5").curve) == 5
    assert resume_case(tmp_path, QUIET).run.ending == "completed"
    whole, continued = read_run(folder / "run.h5"), read_run(tmp_path / "run.h5")
    np.testing.assert_array_equal(continued.curve.reaction, whole.curve.reaction)
    np.testing.assert_array_equal(continued.curve.dissipated_energy, whole.curve.dissipated_energy)
    for one, other in zip(continued.states, whole.states, strict=True):
        np.testing.assert_array_equal(one.displacement, other.displacement)
        np.testing.assert_array_equal(one.maximum_openings, other.maximum_openings)


def test_a_second_stage_begins_where_the_first_one_ended(tmp_path: Path) -> None:
    """It drives the other tape, which only its adhesion has held in the first one."""
    stages = "".join(
        f'[[drive]]\nname = "{name}"\nboundary = "{name}.right"\nto = "3 deg"\nstep = "1 deg"\n'
        for name in ("lower", "upper")
    )
    run_case(Case.parse(tables() + stages), tmp_path / "both", QUIET)
    run_case(with_options(alone("upper"), to="3"), tmp_path / "alone", QUIET)
    found = read_run(tmp_path / "both" / "2-upper" / "run.h5").curve.reaction
    expected = read_run(tmp_path / "alone" / "run.h5").curve.reaction
    # both are converged
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("value", "table"),
    [
        ("body.2.height='3 nm'", "body"),
        ("interface.1.length='10 nm'", "interface"),
        ("load=[{ boundary = 'upper.top', force = '1e-3 N/m', angle = '90 deg' }]", "load"),
    ],
)
def test_a_run_of_other_bodies_is_not_replaced(
    value: str, table: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = folder.parent / "case.toml"
    assert main(["run", str(case), "--set", value, "--out", str(folder)]) == 2
    assert f"a run of another case 'both', with other values in [{table}]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("values", "field", "message"),
    [
        # the lower tape slides along its substrate
        (
            {"support": [{"boundary": "upper.left", "holds": "x"}]},
            "support",
            "nothing prevents this motion",
        ),
        (
            {"interface.2.substrate.height": "1 nm"},
            "interface.2.substrate.gap",
            "must not overlap the substrate",
        ),
        (
            {"support.1.holds": "y", "support.1.boundary": "upper.top"},
            "support.1.boundary",
            "'upper.top' cannot be used; the drive moves the side upper.right,",
        ),
        (
            {"load": [{"boundary": "upper.left", "force": "1 mN/m", "angle": "0 deg"}]},
            "support.1.boundary",
            "'upper.left' cannot be used; a load that is held acts on the side upper.left along x",
        ),
        (
            {"body.1.shape": "curved-strip", "body.1.radius": "50 nm", "body.1.space": "L1"},
            "body.1.space",
            "a rotation would strain the body",
        ),
        ({"discretization.contact_points": 10_000}, "discretization.contact_points", "on an element"),
    ],
)
def test_what_only_the_system_finds_is_named_by_the_keys_of_the_case(
    values: dict[str, Any], field: str, message: str, tmp_path: Path
) -> None:
    case = Case.parse(f'{tables()}[drive]\nboundary = "upper.right"\n{DRIVE}').with_values(values)
    with pytest.raises(InputError) as caught:
        run_case(case, tmp_path / "out", QUIET)
    assert caught.value.field == field
    assert message in str(caught.value)
    assert not (tmp_path / "out").exists()
