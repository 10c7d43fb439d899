"""The wheel and the source distribution: what is in them, and whether the wheel works where it is put."""

import os
import shutil
import subprocess
import sys
import tarfile
import venv
from email import message_from_bytes
from email.message import Message
from pathlib import Path
from zipfile import ZipFile

import pytest

import isopeel
from isopeel.case import shipped_cases

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "isopeel"
NAME = f"isopeel-{isopeel.__version__}"
WITHOUT = "PYTHONPATH", "PYTHONHOME"


def packaged() -> set[str]:
    """The files of the package, as seen from `src`."""
    files = (path for path in SOURCE.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {path.relative_to(SOURCE.parent).as_posix() for path in files}


def output_of(*command: str | Path, folder: Path, **environment: str) -> str:
    """What a command prints in a folder; it must succeed."""
    kept = {name: value for name, value in os.environ.items() if name not in WITHOUT}
    ended = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        cwd=folder,
        env={**kept, "PYTHONIOENCODING": "utf-8", **environment},
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the source distribution, and the wheel that was built from that."""
    folder = tmp_path_factory.mktemp("dist")
    # what builds is among the dependencies of developers: nothing is loaded
    output_of(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, ROOT, folder=folder)
    assert {path.name for path in folder.iterdir()} == {f"{NAME}-py3-none-any.whl", f"{NAME}.tar.gz"}
    return folder


@pytest.fixture(scope="module")
def wheel(built: Path) -> Path:
    return built / f"{NAME}-py3-none-any.whl"


def metadata(wheel: Path) -> Message:
    with ZipFile(wheel) as archive:
        return message_from_bytes(archive.read(f"{NAME}.dist-info/METADATA"))


def test_the_wheel_holds_the_package_and_nothing_else(wheel: Path) -> None:
    with ZipFile(wheel) as archive:
        names = set(archive.namelist())
        entries = archive.read(f"{NAME}.dist-info/entry_points.txt").decode().split("\n")
    own = {name for name in names if not name.startswith(f"{NAME}.dist-info/")}
    assert own == packaged()
    assert "isopeel/py.typed" in own
    for case in ("strip", "curved-substrate"):
        assert {f"isopeel/cases/{case}/{file}" for file in ("case.toml", "picture.png")} <= own
    assert {"isopeel/report/report.css", "isopeel/paper/table2.csv"} <= own
    assert f"{NAME}.dist-info/licenses/LICENSE" in names
    assert entries[:2] == ["[console_scripts]", "isopeel = isopeel.cli:main"]


def test_the_metadata_are_those_of_the_project(wheel: Path) -> None:
    found = metadata(wheel)
    assert (found["Name"], found["Version"]) == ("isopeel", isopeel.__version__)
    assert found["Requires-Python"] == ">=3.11"
    assert "Typing :: Typed" in found.get_all("Classifier", [])
    assert {"dev", "benchmark"} <= set(found.get_all("Provides-Extra", []))
    # who only uses the package gets no tool of its developers
    needed = [line for line in found.get_all("Requires-Dist", []) if "extra ==" not in line]
    assert any(line.startswith("numba") for line in needed)
    assert not any(line.startswith(("pytest", "vtk", "build", "hatchling")) for line in needed)


def test_the_source_distribution_can_be_tested_and_built(built: Path) -> None:
    with tarfile.open(built / f"{NAME}.tar.gz") as archive:
        names = {name.removeprefix(f"{NAME}/") for name in archive.getnames()}
    assert {f"src/{name}" for name in packaged()} <= names
    assert {"pyproject.toml", "README.md", "LICENSE", "CHANGELOG.md", "CITATION.cff", "Makefile"} <= names
    assert {"tests/package/test_package.py", "docs/cases.md", "examples/own_law.py"} <= names
    assert not any("__pycache__" in name or name.startswith((".git/", "out/", ".venv/")) for name in names)


def test_the_wheel_works_without_its_sources(wheel: Path, tmp_path: Path) -> None:
    """From a folder that it is unpacked to, with the dependencies of this environment."""
    place = tmp_path / "installed"
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-deps")
    output_of(*pip, "--no-index", "--no-compile", "--target", place, wheel, folder=tmp_path)
    python = (sys.executable, "-c")
    start = "import sys; from isopeel.cli import main; sys.exit(main())"
    where = output_of(
        *python, "import isopeel; print(isopeel.__file__)", folder=tmp_path, PYTHONPATH=str(place)
    )
    assert Path(where.strip()) == place / "isopeel" / "__init__.py"
    version = output_of(*python, start, "--version", folder=tmp_path, PYTHONPATH=str(place))
    assert version == f"isopeel {isopeel.__version__}\n"
    cases = output_of(*python, start, "cases", folder=tmp_path, PYTHONPATH=str(place))
    assert all(name in cases for name in shipped_cases())


@pytest.mark.skipif(shutil.which("bash") is None or os.name == "nt", reason="it takes bash")
def test_bash_completes(tmp_path: Path) -> None:
    """The script that is shown, used by a shell."""
    program = tmp_path / "isopeel"
    program.write_text(f"#!{sys.executable}\nimport sys\nfrom isopeel.cli import main\nsys.exit(main())\n")
    program.chmod(0o755)
    path = {"PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(SOURCE.parent)}
    script = output_of("bash", "-c", "isopeel --show-completion bash; true", folder=tmp_path, **path)
    assert "complete -o default -F _isopeel_completion isopeel" in script
    for words, at, expected in (
        ("isopeel ex", 1, ["export"]),
        ("isopeel run --co", 2, ["--contact-points", "--control"]),
    ):
        ask = f'COMP_WORDS=({words}); COMP_CWORD={at}; _isopeel_completion isopeel; echo "${{COMPREPLY[@]}}"'
        assert output_of("bash", "-c", f"{script}\n{ask}", folder=tmp_path, **path).split() == expected


@pytest.mark.long
def test_the_wheel_works_in_a_clean_environment(wheel: Path, tmp_path: Path) -> None:
    """With its dependencies as they are found today."""
    venv.create(tmp_path / "venv", with_pip=True)
    programs = tmp_path / "venv" / ("Scripts" if os.name == "nt" else "bin")
    pip = (programs / "python", "-m", "pip", "--disable-pip-version-check", "install", "--quiet")
    output_of(*pip, wheel, folder=tmp_path)
    command = programs / "isopeel"
    assert output_of(command, "--version", folder=tmp_path) == f"isopeel {isopeel.__version__}\n"
    assert "curved-substrate" in output_of(command, "cases", folder=tmp_path)
    small = ("--mesh", "20x2", "--space", "L1", "--to", "2", "--step", "1")
    shown = output_of(command, "run", "strip", *small, folder=tmp_path)
    assert "L1, 20x2, 126 DOFs" in shown
    run = tmp_path / "out" / "strip"
    assert {"run.h5", "curve.csv", "summary.json", "curve.png", "shapes.png"} <= {
        p.name for p in run.iterdir()
    }
    output_of(command, "export", run, folder=tmp_path)
    assert (run / "paraview" / "body.pvd").exists()
    for tool in ("pytest", "vtk", "mypy"):
        missing = f"import importlib.util as found; print(found.find_spec({tool!r}))"
        assert output_of(programs / "python", "-c", missing, folder=tmp_path) == "None\n"
