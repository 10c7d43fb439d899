"""Data flows one way through the layers of the package: read from the imports of all modules."""

import ast
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import isopeel
from isopeel.common.layers import LAYERS, left_of

PACKAGE = Path(isopeel.__file__).parent
ROOT = PACKAGE.parents[1]
MODULES = [
    path.relative_to(PACKAGE.parent) for path in sorted(PACKAGE.rglob("*.py")) if path.parent != PACKAGE
]
#: What any layer may import from the package itself: its folder, and its version.
OF_THE_PACKAGE = {"__file__", "__version__"}
#: The import against the order inside a folder: `Case.parse` chooses one of the subclasses of `Case`.
OF_A_SUBCLASS = ("isopeel.case.case", "isopeel.case.forms")
#: The name of a module, as `discover` and `import_module` take it.
NAME = re.compile(r"isopeel(?:\.\w+)+")


def imported(source: str, package: str) -> Iterator[str]:
    """The full names that the source of a module in a package imports from isopeel, wherever it does."""
    for node in ast.walk(ast.parse(source)):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            names = [f"{module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and NAME.fullmatch(node.value):
            names = [node.value]
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            names = [f"{node.value.id}.{node.attr}"]
        yield from (name for name in names if name.startswith("isopeel."))


def against_the_flow(source: str, module: Path) -> list[str]:
    """What a module imports that does not lie left of its layer."""
    layer, package = module.parts[1], ".".join(module.parts[:-1])
    allowed = {layer, *left_of(layer), *OF_THE_PACKAGE}
    return [name for name in imported(source, package) if name.split(".")[1] not in allowed]


def test_every_module_imports_only_from_layers_to_its_left() -> None:
    found = {
        module.as_posix(): names
        for module in MODULES
        if (names := against_the_flow((PACKAGE.parent / module).read_text("utf-8"), module))
    }
    assert found == {}


@pytest.mark.parametrize("layer", LAYERS)
def test_modules_of_a_folder_import_each_other_one_way(layer: str) -> None:
    """Raises CycleError where two modules import each other, also for type checkers only."""
    own = {".".join(path.with_suffix("").parts): path for path in MODULES if path.parts[1] == layer}
    left: dict[str, set[str]] = {}
    for module, path in own.items():
        source = (PACKAGE.parent / path).read_text("utf-8")
        for name in imported(source, ".".join(path.parts[:-1])):
            for other in {name, name.rpartition(".")[0]} & own.keys() - {module}:
                if (module, other) != OF_A_SUBCLASS:
                    left.setdefault(module, set()).add(other)
    TopologicalSorter(left).prepare()


@pytest.mark.parametrize(
    "source",
    [
        "from isopeel.solve.trace import trace",
        "from isopeel.solve import trace",
        "from isopeel import solve",
        "import isopeel.solve.trace",
        "import isopeel.solve.trace as t",
        "from ..solve import trace",
        "from .. import solve",
        "from ..solve.trace import trace",
        "def f():\n    from isopeel.solve import trace",
        "if TYPE_CHECKING:\n    from isopeel.solve import trace",
        "import_module('isopeel.solve.trace')",
    ],
)
def test_every_way_to_import_is_noticed(source: str) -> None:
    # one import, which lies right of one layer and left of another
    assert len(against_the_flow(source, Path("isopeel/problem/problem.py"))) == 1
    assert len(against_the_flow(source, Path("isopeel/results/curve.py"))) == 0


def test_the_public_names_of_the_package_are_not_for_its_layers() -> None:
    for source in ("from isopeel import trace", "import isopeel\nisopeel.trace"):
        # not even for a layer that may import solve.trace, from which it is
        assert against_the_flow(source, Path("isopeel/results/curve.py")) == ["isopeel.trace"]
    for source in ("from isopeel import __version__", "import isopeel\nisopeel.__file__"):
        assert against_the_flow(source, Path("isopeel/common/errors.py")) == []


def test_layers_are_the_folders_with_modules_and_nothing_lies_beside_them() -> None:
    folders = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert set(LAYERS) == folders
    assert {path.name for path in PACKAGE.glob("*.py")} == {"__init__.py", "__main__.py"}


def test_the_order_of_layers_is_one_from_left_to_right() -> None:
    names = list(LAYERS)
    for number, layer in enumerate(names):
        assert left_of(layer) <= set(names[:number])
    # the command line is the last one, and reaches all others
    assert left_of(names[-1]) == set(names[:-1])


def test_the_picture_of_the_flow_shows_all_layers() -> None:
    picture = (ROOT / "docs" / "_static" / "flow.svg").read_text("utf-8")
    assert set(re.findall(r'font-weight="bold"[^>]*>([a-z_]+)<', picture)) == set(LAYERS)
