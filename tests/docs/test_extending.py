"""Components of docs/extending.md and of two how-to pages, each written to a file, run, and checked."""

import re
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from isopeel import InputError, trace
from isopeel.assembly.system import System
from isopeel.case import Case
from isopeel.case.kinds import KindSection
from isopeel.common.arrays import FloatArray
from isopeel.common.registry import PLUG_INS, discover
from isopeel.matrix.factorize import factorize
from isopeel.physics.batch import evaluate_law, evaluate_material, evaluate_substrate

DOCS = Path(__file__).parents[2] / "docs"
TEXT = "".join(
    (DOCS / page).read_text(encoding="utf-8")
    for page in ("howto/adhesion-law.md", "extending.md", "howto/shape.md")
)
(PAGE_CASE,) = re.findall(r"^%%writefile own-plugins.toml\n(.*?)^```", TEXT, re.DOTALL | re.MULTILINE)
# all components in one
CASE = PAGE_CASE.replace('"strip"', '"bevelled-strip"\ntop_length = "62 nm"').replace(
    '"exponential"', '"power-law"'
)
# folder, module, and the text of the file
FILES = re.findall(r"^%%writefile plugins/(\w+)/(\w+)\.py\n(.*?)^```", TEXT, re.DOTALL | re.MULTILINE)
FAMILIES = {family.packages[0].rpartition(".")[2]: family for family in KindSection.__subclasses__()}


@pytest.fixture(scope="module")
def components(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Any]]:
    """The classes of the pages, by their names, found in a folder that ISOPEEL_PLUGINS names."""
    home = tmp_path_factory.mktemp("plugins")
    packages = {folder: FAMILIES[folder].packages[0] for folder, _, _ in FILES}
    modules = {f"{packages[folder]}.{module}" for folder, module, _ in FILES}
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(PLUG_INS, str(home))
        for folder, module, code in FILES:
            (home / folder).mkdir(exist_ok=True)
            (home / folder / f"{module}.py").write_text(code, encoding="utf-8")
        for package in packages.values():
            # undone at the end
            patch.setattr(import_module(package), "__path__", import_module(package).__path__)
        discover.cache_clear()
        yield {
            name: kind
            for package in packages.values()
            for name, kind in discover(package).items()
            if kind.__module__ in modules
        }
    discover.cache_clear()
    for module in modules:
        package, _, name = module.rpartition(".")
        sys.modules.pop(module)
        delattr(import_module(package), name)


def test_the_pages_have_a_component_of_each_kind(components: dict[str, Any]) -> None:
    assert list(components) == ["power-law", "blatz-ko", "step", "hinge", "bevelled-strip"]


def test_a_folder_of_plug_ins_must_exist(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(PLUG_INS, "nowhere")
    with pytest.raises(
        InputError, match="ISOPEEL_PLUGINS: 'nowhere' cannot be used; it must be the path of folders"
    ):
        discover.__wrapped__("isopeel.physics.adhesion")


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("x = 1\nclass A(\n", "SyntaxError in line 2: '(' was never closed"),
        ("x = 1\n\ny = unknown\n", "NameError in line 3: name 'unknown' is not defined"),
        ("from isopeel import nothing\n", "ImportError in line 1: cannot import name 'nothing'"),
    ],
)
def test_a_plug_in_that_python_cannot_run_is_reported_with_its_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, code: str, reason: str
) -> None:
    package = "isopeel.physics.substrates"
    monkeypatch.setenv(PLUG_INS, str(tmp_path))
    monkeypatch.setattr(import_module(package), "__path__", import_module(package).__path__)
    file = tmp_path / "substrates" / "broken.py"
    file.parent.mkdir()
    file.write_text(code, encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(f"{PLUG_INS}: {str(file)!r} cannot be used; {reason}")):
        discover.__wrapped__(package)


def test_the_case_of_the_document_runs(components: dict[str, Any]) -> None:
    case = Case.parse(CASE)
    (stage,) = case.stages()
    problem = stage.problem
    made = {problem.body.material, problem.adhesion.law, problem.adhesion.substrate, problem.drive}
    assert {type(one) for one in made} == {kind for name, kind in components.items() if "strip" not in name}
    steps = list(trace(problem, case.space(), stage.parameters))
    assert len(steps) == 11
    assert steps[-1].dissipated_energy > 0
    # corners go around the hinge, (40, 2)
    right = steps[-1].displacement[case.space().side_functions("right")]
    corners = np.array([[60.0, 0.0], [62.0, 4.0]]) + right[[0, -1]]
    radii = np.hypot(*(corners - [40.0, 2.0]).T)
    np.testing.assert_allclose(radii, np.hypot([20.0, 22.0], 2.0), rtol=1e-14)
    with pytest.raises(InputError, match=r"adhesion\.strength: '0 MPa' cannot be used; it must be positive"):
        Case.parse(CASE.replace("4 MPa", "0 MPa")).problem()


def test_tangent_of_the_components_is_the_derivative_of_the_residual(components: dict[str, Any]) -> None:
    case = Case.parse(CASE.replace("60x2", "20x2"))
    system = System(case.problem(), case.space())
    rng = np.random.default_rng(3)
    y, direction = 0.02 * rng.standard_normal((2, system.count))
    system = system.after(0.04 * rng.random(system.maximum_openings.shape))

    def residual(values: FloatArray) -> FloatArray:
        return system.equilibrium(system.state(values, 0.01)[0]).residual

    change = (residual(y + 1e-5 * direction) - residual(y - 1e-5 * direction)) / 2e-5
    factor = factorize(system.linearize(system.state(y, 0.01)[0], "general")[1])
    # central differences of step 1e-5 leave 1e-10 of the third derivative, which the solution enlarges
    np.testing.assert_allclose(factor.solve(change), direction, rtol=0, atol=1e-6 * np.abs(direction).max())


def test_closed_forms_of_the_components(components: dict[str, Any]) -> None:
    law = components["power-law"].like(0.04, 0.015, 0.25)
    length = 3**1.5 / 8 * 0.015 / 0.04
    gap = 0.25 + length * np.array([0.0, 3**-0.5])
    potential, traction, derivative = evaluate_law(law.kernel, law.parameters, gap, np.zeros(2))
    assert potential[0] == -0.015
    np.testing.assert_allclose(traction, [0.0, -0.04], rtol=1e-14, atol=1e-17)
    np.testing.assert_allclose(derivative, [-2 * 0.015 / length**2, 0.0], rtol=1e-14, atol=1e-15)

    material = components["blatz-ko"](2.0, 0.3)
    stretch = 1.4
    F = np.diag([stretch, stretch ** (-0.3 / 0.7)])  # free faces
    _, P, A = evaluate_material(material.kernel, material.parameters, np.stack([F, np.eye(2)]))
    # by P_22 = 0, P_11 = mu (a - b^2/a)/J^2
    pull = 2.0 / 2.6 * (1 / (stretch * F[1, 1] ** 2) - stretch**-3)
    np.testing.assert_allclose(P[0], [[pull, 0.0], [0.0, 0.0]], rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(P[1], 0.0, atol=1e-15)
    # lambda + 2 mu and lambda
    np.testing.assert_allclose(A[1, 0, 0, :, :].diagonal(), [2.0 * 0.7 / 0.52, 2.0 * 0.3 / 0.52], rtol=1e-14)

    step = components["step"](drop=1.0, place=10.0, width=2.0)
    gap, normal, curvature = evaluate_substrate(
        step.kernel, step.parameters, np.array([[10.0, -0.5], [-90.0, 3.0], [110.0, 3.0]])
    )
    np.testing.assert_allclose(gap, [0.0, 3.0, 4.0], rtol=1e-14, atol=1e-15)
    # in the middle the slope is drop/(2 width)
    np.testing.assert_allclose(normal[0], np.array([0.25, 1.0]) / np.hypot(0.25, 1.0), rtol=1e-14)
    np.testing.assert_allclose(curvature, 0.0, atol=1e-15)

    surface = components["bevelled-strip"](60.0, 62.0, 4.0).surface()
    assert surface.boundary("right").length() == pytest.approx(np.hypot(2.0, 4.0), rel=1e-14)

    drive = components["hinge"]("right", (40.0, 2.0))
    points = np.array([[60.0, 0.0], [62.0, 4.0]])
    # a half turn is a point reflection
    np.testing.assert_allclose(drive.prescribed(points, np.pi), 2 * ([40.0, 2.0] - points), rtol=1e-14)
    difference = (drive.prescribed(points, 0.7 + 1e-6) - drive.prescribed(points, 0.7 - 1e-6)) / 2e-6
    np.testing.assert_allclose(drive.rate(points, 0.7), difference, rtol=1e-8)  # round-off over the step
