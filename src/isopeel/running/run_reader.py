"""Read the folder of a run: each stage with its problem, its space and its stored run."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from isopeel.case import Case, Stage
from isopeel.common.errors import InputError
from isopeel.post.findings import Findings, find
from isopeel.post.laboratory import Laboratory
from isopeel.results.run_file import StoredRun, read_run
from isopeel.running.folder import run_files
from isopeel.splines.rows import RowSpace

_NEEDED = ("L0", "E0", "stage", "space", "mesh", "dofs", "traction")  # attributes of a run


@dataclass(frozen=True, eq=False)
class StoredStage:
    """A stage that was run: its case and problem, its space, and its stored run."""

    title: str
    folder: Path
    case: Case
    stage: Stage
    spaces: Mapping[str, RowSpace]
    run: StoredRun

    @property
    def laboratory(self) -> Laboratory:
        """The units in which its outputs are shown."""
        return Laboratory.of(self.case.units.system(), self.stage.problem, self.case.width)

    def found(self) -> Findings:
        """Read the run."""
        points = self.case.discretization.contact_points
        return find(self.stage.problem, self.spaces, self.run, self.stage.window, self.laboratory, points)


def read_stages(folder: Path) -> tuple[StoredStage, ...]:
    """Return the stages in the folder of a run, or the one in the folder of a stage, in the order of the run.

    The files are not trusted. Raises InputError where the folder holds no run, or a file does not fit the
    case in it.
    """
    return tuple(map(_read_stage, run_files(folder)))


def _read_stage(file: Path) -> StoredStage:
    run = read_run(file)
    try:
        case = Case.parse(run.case_text, str(file))
        stages, spaces = case.stages(), case.spaces()
    except InputError as error:
        raise InputError(
            "DIR", str(file.parent), f"the case in it cannot be read any more: {error}"
        ) from error
    missing = [name for name in _NEEDED if name not in run.attributes]
    name = run.attributes.get("stage")
    # two stages may have the same name, but not the same folder
    numbers = [number for number, stage in enumerate(stages, start=1) if stage.name == name]
    number = _number(file) if _number(file) in numbers else min(numbers, default=0)
    kept = [*(state.displacement for state in run.states), *([] if run.base is None else [run.base])]
    sizes = {len(displacement) for displacement in kept}
    size = sum(space.size for space in spaces.values())
    names = ", ".join(space.name for space in spaces.values())
    meshes = ", ".join("{}x{}".format(*space.elements) for space in spaces.values())
    same = (run.attributes.get("space"), run.attributes.get("mesh")) == (names, meshes)
    if missing or not number or not sizes <= {size} or not same:
        reason = (
            f"lacks {', '.join(missing)}" if missing else "has fields, a space or a stage of another case"
        )
        raise InputError("FILE", str(file), f"the file of a run is needed: it {reason}")
    stage = stages[number - 1]
    columns = stage.problem.drive.parameter_column, stage.problem.drive.reaction_column
    if (run.curve.parameter_column, run.curve.reaction_column) != columns:
        raise InputError("FILE", str(file), "the file of a run is needed: its curve belongs to another drive")
    title = f"{case.name}, stage {number}: {stage.name}" if len(stages) > 1 else case.name
    return StoredStage(title, file.parent, case, stage, spaces, run)


def _number(file: Path) -> int:
    """Return the number at the beginning of the name of a stage's folder, from one; 0 where there is none."""
    number = file.parent.name.partition("-")[0]
    return int(number) if number.isdecimal() else 0
