"""Laws, materials and substrates are found where their files are, and each takes one file."""

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from isopeel import trace
from isopeel.case import Case
from isopeel.case.kinds import KindSection
from isopeel.case.sections import MaterialSection
from isopeel.case.values import key_of
from isopeel.common.errors import InputError
from isopeel.common.quantities import Length
from isopeel.common.registry import discover
from isopeel.output.law import LAWS
from isopeel.physics.batch import evaluate_law, evaluate_material
from isopeel.post.law import law_character

NAMES = {
    "isopeel.physics.adhesion": (
        "bilinear dugdale exponential formula lennard-jones trapezoidal van-der-waals"
    ),
    "isopeel.physics.materials": "formula mooney-rivlin neo-hooke saint-venant-kirchhoff yeoh",
    "isopeel.physics.substrates": "circle flat formula wavy",
    "isopeel.problem.shapes": "curved-strip half-cylinder patch quarter-cylinder strip tapered-strip",
    "isopeel.problem.drives": "displacement force rotation",
}


@pytest.mark.parametrize("package", NAMES)
def test_all_kinds_are_found_by_their_names(package: str) -> None:
    found = discover(package)
    assert set(NAMES[package].split()) <= set(found)
    assert list(found) == sorted(found)
    assert all(kind.name == name and is_dataclass(kind) for name, kind in found.items())
    # every field can be written in a case
    sections = [family for family in KindSection.__subclasses__() if package in family.packages]
    (family,) = sections
    for name, kind in found.items():
        keys = {field.name for field in fields(kind)} - family.own
        assert keys <= set(family.chosen({family.chooser: name}).model_fields)


def test_finding_laws_does_not_load_sympy() -> None:
    packages = [name for name in NAMES if name.startswith("isopeel.physics")]
    script = (
        "import sys; from isopeel.common.registry import discover\n"
        f"for name in {packages!r}: discover(name)\n"
        "sys.exit('sympy' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


@pytest.mark.parametrize("name", sorted(set(LAWS) - {"contact"}))
def test_laws_alike_have_the_same_work_and_gap_and_strength(name: str) -> None:
    law = LAWS[name].like(0.0617849, 0.0153324, 0.2547)
    character = law_character(law)
    # those with two powers of the gap have no strength of their own, and these numbers are van der Waals's
    loose = name in ("van-der-waals", "lennard-jones")
    # round-off, and what a formula leaves beyond its farthest gap
    assert character.work_of_adhesion == pytest.approx(0.0153324, rel=1e-12)
    assert character.equilibrium_gap == pytest.approx(0.2547, rel=1e-12)
    assert character.strength == pytest.approx(0.0617849, rel=1e-4 if loose else 1e-12)


@pytest.mark.parametrize("kind", discover("isopeel.physics.materials").values(), ids=lambda kind: kind.name)
def test_materials_alike_have_the_same_elastic_constants(kind: Any) -> None:
    material = kind.like(2.0, 0.3)
    assert material.youngs_modulus == pytest.approx(2.0, rel=1e-14)  # round-off
    assert material.poissons_ratio == pytest.approx(0.3, rel=1e-14)
    # dP_11/dF_11 = lambda + 2 mu at rest
    _, _, tangent = evaluate_material(material.kernel, material.parameters, np.eye(2)[None])
    assert tangent[0, 0, 0, 0, 0] == pytest.approx(2.0 * 0.7 / (1.3 * 0.4), rel=1e-14)


HEAD = """
from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Literal, Self
import numpy as np
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import *
from isopeel.common.quantities import Length, Number, Stress
"""
# a law, a material and a substrate that the package lacks, each a file
LINEAR_LAW = (
    HEAD
    + """
@dataclass(frozen=True)
class Springs:
    name: ClassVar[str] = "springs"
    stiffness: Number
    reach: Length
    profile: Literal["even"] = "even"
    equilibrium_gap = 0.0
    @property
    def work_of_adhesion(self) -> float: return self.stiffness * self.reach**2 / 2
    @property
    def parameters(self) -> FloatArray: return np.array([self.stiffness, self.reach])
    @property
    def kernel(self) -> BatchFunction: return compile_batch(ADHESION_SIGNATURE, _springs, cache=False)

def _springs(gap, curvature, parameters, count, potential, traction, derivative) -> None:
    k, reach = parameters[0], parameters[1]
    for n in range(count):
        held = gap[n] < reach
        potential[n] = 0.5 * k * (gap[n] ** 2 - reach**2) if held else 0.0
        traction[n] = -k * gap[n] if held else 0.0
        derivative[n] = -k if held else 0.0
"""
)
MATERIAL = (
    HEAD
    + """
from isopeel.physics.materials.neo_hooke import NeoHooke

@dataclass(frozen=True)
class Foam:
    name: ClassVar[str] = "foam"
    stiffness: Stress
    def _solid(self) -> NeoHooke: return NeoHooke(self.stiffness, 0.0)
    youngs_modulus = property(lambda self: self._solid().youngs_modulus)
    poissons_ratio = property(lambda self: 0.0)
    parameters = property(lambda self: self._solid().parameters)
    kernel = property(lambda self: self._solid().kernel)
    def out_of_plane_stress(self, F: FloatArray) -> FloatArray: return self._solid().out_of_plane_stress(F)
"""
)
SUBSTRATE = (
    HEAD
    + """
from dataclasses import replace

@dataclass(frozen=True)
class Slope:
    name: ClassVar[str] = "slope"
    rise: Number
    offset: tuple[Length, Length] = (0.0, 0.0)
    @property
    def parameters(self) -> FloatArray: return np.array([self.rise, *self.offset])
    @property
    def kernel(self) -> BatchFunction: return compile_batch(SUBSTRATE_SIGNATURE, _slope, cache=False)
    @property
    def constant_curvature(self) -> bool: return True
    def receded(self, gap: float) -> Self: return replace(self, offset=(self.offset[0], self.offset[1] - gap))

def _slope(position, parameters, count, gap, normal, curvature) -> None:
    length = np.hypot(1.0, parameters[0])
    for n in range(count):
        x, y = position[0, n] - parameters[1], position[1, n] - parameters[2]
        gap[n] = (y - parameters[0] * x) / length
        normal[0, n], normal[1, n], curvature[n] = -parameters[0] / length, 1.0 / length, 0.0
"""
)
CASE = """
name = "new"
[body]
length = "20 nm"
height = "2 nm"
[material]
law = "foam"
stiffness = "1 GPa"
[adhesion]
law = "springs"
stiffness = 0.5
reach = "2 nm"
[substrate]
kind = "slope"
rise = -0.01
offset = ["1 nm", "0 nm"]
gap = "0.5 nm"
[discretization]
space = "N2"
mesh = "10x2"
[drive]
to = "0.2 deg"
"""


@pytest.fixture
def new_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A law, a material and a substrate in files of their own, next to those of the package."""
    for package, module, text in (
        ("adhesion", "springs", LINEAR_LAW),
        ("materials", "foam", MATERIAL),
        ("substrates", "slope", SUBSTRATE),
    ):
        folder = tmp_path / package
        folder.mkdir()
        (folder / f"{module}.py").write_text(text)
        name = f"isopeel.physics.{package}"
        home = import_module(name)
        monkeypatch.setattr(home, "__path__", [*home.__path__, str(folder)])
    discover.cache_clear()
    yield
    discover.cache_clear()
    for module in ("adhesion.springs", "materials.foam", "substrates.slope"):
        sys.modules.pop(f"isopeel.physics.{module}", None)


@pytest.mark.usefixtures("new_files")
def test_a_new_law_material_and_substrate_need_one_file_each() -> None:
    case = Case.parse(CASE)
    problem = case.problem()
    law, substrate = problem.adhesion.law, problem.adhesion.substrate
    assert [type(part).__name__ for part in (problem.body.material, law, substrate)] == [
        "Foam", "Springs", "Slope",
    ]  # fmt: skip
    assert problem.body.material.parameters.tolist() == [0.25, 0.0]  # E/2 at nu = 0, in 2 GPa
    _, traction, _ = evaluate_law(law.kernel, law.parameters, np.array([0.5, 3.0]), np.zeros(2))
    assert traction.tolist() == [-0.25, 0.0]
    assert substrate.parameters.tolist() == [-0.01, 1.0, -0.5]
    assert Case.parse(case.text) == case
    steps = list(trace(problem, case.space(), case.stages()[0].parameters))
    assert [step.parameter for step in steps] == pytest.approx(np.radians([0.0, 0.1, 0.2]), rel=1e-15)
    with pytest.raises(InputError, match=r"material\.law.*foam, formula, mooney-rivlin"):
        Case.parse(CASE.replace('"foam"', '"sponge"'))
    for old, new, field, allowed in (
        ('reach = "2 nm"', "", "adhesion.reach", "missing; a length is needed"),
        ('stiffness = "1 GPa"', 'stiffness = "1 nm"', "material.stiffness", "a stress is needed"),
        ("reach =", 'profile = "odd"\nreach =', "adhesion.profile", "'even' is needed"),
        ("rise =", "slope =", "substrate.slope", "here the keys are gap, kind, rise, offset"),
    ):
        with pytest.raises(InputError) as caught:
            Case.parse(CASE.replace(old, new))
        assert caught.value.field == field
        assert allowed in caught.value.allowed


def test_two_of_one_name_are_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "twins"
    package.mkdir()
    text = "from dataclasses import dataclass\n@dataclass\nclass {}:\n    name = 'one'\n"
    (package / "__init__.py").write_text("")
    (package / "first.py").write_text(text.format("First"))
    (package / "second.py").write_text(text.format("Second") + "\nfrom twins.first import First\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(ValueError, match="Second and First are both named 'one'"):
        discover("twins")


@pytest.mark.parametrize("hint", [float, complex, list[str], tuple[Length, ...], int | str, dict[str, float]])
def test_types_that_no_case_can_have_are_an_error(hint: object) -> None:
    with pytest.raises(TypeError, match="no values of the type"):
        key_of(hint)


def test_a_field_without_a_dimension_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    @dataclass(frozen=True)
    class Vague:
        name: ClassVar[str] = "vague"
        reach: float

    monkeypatch.setattr("isopeel.case.kinds.discover", lambda _: {"vague": Vague})
    with pytest.raises(TypeError, match=r"Vague\.reach: .*float.*isopeel\.common\.quantities"):
        MaterialSection.chosen({"law": "vague"})


def test_a_field_cannot_have_the_name_of_a_common_key(monkeypatch: pytest.MonkeyPatch) -> None:
    @dataclass(frozen=True)
    class Taken:
        name: ClassVar[str] = "taken"
        prestretch: Length

    monkeypatch.setattr("isopeel.case.kinds.discover", lambda _: {"taken": Taken})
    with pytest.raises(TypeError, match=r"Taken\.prestretch needs another name"):
        MaterialSection.chosen({"law": "taken"})
