"""Last angles of random strips, far from the literature: automatic path control and plain Newton."""

import csv
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import isopeel
import machine
from isopeel.case import Case
from isopeel.common.path_control import PathControl
from isopeel.common.processes import compute_all, cores
from isopeel.paper.study import SPACES
from printing import plain_table, wide_console

LENGTH = 200.0  # nm
#: Ranges of the random parameters: uniform in the logarithm, except for Poisson's ratio.
YOUNGS_MODULUS = (0.2, 200.0)  # GPa
POISSONS_RATIO = (0.0, 0.49)
DISTANCE = (0.2, 1.0)  # nm, r0
HAMAKER = (1e-20, 1e-18)  # J
HEIGHT = (2.0, 40.0)  # nm
ELEMENTS = (10, 480)  # along the length: elements of 20 nm, and of the attraction's width
MOST_ACROSS = 12
#: Largest attraction as a share of Young's modulus; stronger strips are drawn again.
STRONGEST = 0.25

PATH_CONTROLS: tuple[PathControl, ...] = ("newton", "auto")


@dataclass(frozen=True)
class Draw:
    """A strip: its parameters, space and mesh."""

    number: int
    youngs_modulus_gpa: float
    poissons_ratio: float
    distance_nm: float
    hamaker_j: float
    height_nm: float
    space: str
    mesh: str

    @property
    def strength(self) -> float:
        """Largest attraction over Young's modulus: sqrt(5)/(9 pi) A_H/r0^3, at r = r0/5^(1/6)."""
        stress = np.sqrt(5) / (9 * np.pi) * self.hamaker_j / (self.distance_nm * 1e-9) ** 3
        return float(stress / (self.youngs_modulus_gpa * 1e9))

    def case(self, to_deg: float, step_deg: float, path_control: PathControl) -> Case:
        """Return the strip as a case, which `isopeel run` can use too."""
        return Case.parse(self.toml(to_deg, step_deg, path_control))

    def toml(self, to_deg: float, step_deg: float, path_control: PathControl) -> str:
        """Return the text of the case."""
        return f"""\
name = "stress-{self.number}"

[body]
length = "{LENGTH:g} nm"
height = "{self.height_nm!r} nm"

[material]
law = "neo-hooke"
youngs_modulus = "{self.youngs_modulus_gpa!r} GPa"
poissons_ratio = {self.poissons_ratio!r}

[adhesion]
law = "van-der-waals"
hamaker_constant = "{self.hamaker_j!r} J"
equilibrium_distance = "{self.distance_nm!r} nm"
length = "{0.75 * LENGTH:g} nm"

[discretization]
space = "{self.space}"
mesh = "{self.mesh}"
across_degree = 1

[drive]
to = "{to_deg!r} deg"
step = "{step_deg!r} deg"
path_control = "{path_control}"
"""


@dataclass(frozen=True)
class Outcome:
    """The result of a strip under a path control."""

    path_control: PathControl
    reached_deg: float
    steps: int
    jumps: int
    cause: str  # empty where it is complete
    reason: str
    seconds: float


@dataclass(frozen=True)
class Attempt:
    """The task of a draw: its path under each path control."""

    draw: Draw
    to_deg: float
    step_deg: float

    def __call__(self) -> tuple[Outcome, ...]:
        return tuple(self._under(path_control) for path_control in PATH_CONTROLS)

    def _under(self, path_control: PathControl) -> Outcome:
        case = self.draw.case(self.to_deg, self.step_deg, path_control)
        (stage,) = case.stages()
        settings = isopeel.NewtonSettings(path_control=path_control)
        reached, steps, jumps, seconds, cause, reason = 0.0, 0, 0, 0.0, "", ""
        try:
            for step in isopeel.trace(stage.problem, case.space(), stage.parameters, settings):
                reached, steps = float(np.degrees(step.parameter)), steps + 1
                jumps, seconds = jumps + (step.kind == "jump"), seconds + step.seconds
        except isopeel.ConvergenceError as error:
            cause, reason = error.cause, error.reason
        return Outcome(path_control, reached, steps, jumps, cause, reason, seconds)


def draws(seed: int, count: int) -> list[Draw]:
    """Return random strips; the first ones do not depend on the number of strips."""
    found = _stream(seed)
    return [next(found) for _ in range(count)]


def _stream(seed: int) -> Iterator[Draw]:
    random = np.random.default_rng(seed)
    number = 0
    while True:

        def between(ends: tuple[float, float]) -> float:
            return float(f"{np.exp(random.uniform(*np.log(ends))):.4g}")

        height, along = between(HEIGHT), round(between(ELEMENTS))
        across = int(np.clip(round(along * height / LENGTH), 1, MOST_ACROSS))
        draw = Draw(
            number,
            between(YOUNGS_MODULUS),
            round(random.uniform(*POISSONS_RATIO), 3),
            between(DISTANCE),
            between(HAMAKER),
            height,
            SPACES[random.integers(len(SPACES))],
            f"{along}x{across}",
        )
        if draw.strength <= STRONGEST:
            yield draw
            number += 1


def shares(found: Sequence[tuple[Draw, tuple[Outcome, ...]]]) -> Table:
    """Return the table of complete strips, in thirds of each range."""
    table = plain_table(
        "strips that reach the last angle, in percent",
        "",
        "from",
        "to",
        "strips",
        *PATH_CONTROLS,
        *(f"{path_control}\nmedian" for path_control in PATH_CONTROLS),
        caption="thirds of the strips by each parameter; median: of the angles reached, in degrees",
        labels=1,
    )
    sorts: dict[str, Callable[[Draw], float]] = {
        "all": lambda draw: draw.number,
        "Young's modulus, GPa": lambda draw: draw.youngs_modulus_gpa,
        "Poisson's ratio": lambda draw: draw.poissons_ratio,
        "r0, nm": lambda draw: draw.distance_nm,
        "A_H, 1e-20 J": lambda draw: draw.hamaker_j * 1e20,
        "height, nm": lambda draw: draw.height_nm,
        "strength / E": lambda draw: draw.strength,
        "elements along": lambda draw: int(draw.mesh.split("x")[0]),
        "element / r0": lambda draw: LENGTH / int(draw.mesh.split("x")[0]) / draw.distance_nm,
    }
    for name, key in sorts.items():
        ordered = sorted(found, key=lambda one: key(one[0]))
        for part in np.array_split(np.arange(len(ordered)), 1 if name == "all" else 3):
            some = [ordered[k] for k in part]
            if not some:
                continue
            complete = [100 * np.mean([not outcomes[c].cause for _, outcomes in some]) for c in range(2)]
            reached = [np.median([outcomes[c].reached_deg for _, outcomes in some]) for c in range(2)]
            ends = ["", ""] if name == "all" else [f"{key(some[0][0]):.3g}", f"{key(some[-1][0]):.3g}"]
            table.add_row(
                name if part[0] == 0 else "",
                *ends,
                str(len(some)),
                *(f"{share:.1f}" for share in complete),
                *(f"{angle:.1f}" for angle in reached),
            )
    return table


def failures(found: Sequence[tuple[Draw, tuple[Outcome, ...]]]) -> Table:
    """Return the table of strips that stop before the last angle under automatic control, with the causes."""
    table = plain_table(
        "strips that do not reach the last angle under automatic path control",
        "",
        "space",
        *("mesh", "E, GPa", "nu", "r0, nm", "A_H, J", "height, nm", "strength/E", "reached", "cause"),
        labels=2,
    )
    for draw, outcomes in found:
        last = outcomes[PATH_CONTROLS.index("auto")]
        if last.cause:
            table.add_row(
                str(draw.number),
                draw.space,
                draw.mesh,
                f"{draw.youngs_modulus_gpa:g}",
                f"{draw.poissons_ratio:g}",
                f"{draw.distance_nm:g}",
                f"{draw.hamaker_j:g}",
                f"{draw.height_nm:g}",
                f"{draw.strength:.3g}",
                f"{last.reached_deg:.1f}",
                f"{last.cause}: {last.reason}",
            )
    return table


def write(path: Path, found: Sequence[tuple[Draw, tuple[Outcome, ...]]]) -> None:
    """Write one line per strip and path control."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = [
            asdict(draw) | {"strength": draw.strength} | asdict(outcome)
            for draw, outcomes in found
            for outcome in outcomes
        ]
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def main(
    seed: Annotated[int, typer.Option(help="Of the draw.")] = 0,
    count: Annotated[int, typer.Option(min=1, help="Strips.")] = 200,
    only: Annotated[list[int] | None, typer.Option(help="Numbers of strips; repeatable.")] = None,
    to: Annotated[float, typer.Option(min=0, help="Last angle in degrees.")] = 150.0,
    step: Annotated[float, typer.Option(min=1e-3, help="Step in degrees.")] = 1.0,
    processes: Annotated[int | None, typer.Option(min=1, help="All cores when left out.")] = None,
    out: Annotated[Path, typer.Option(help="Table of every strip.")] = Path("out/stress.csv"),
    case: Annotated[bool, typer.Option("--case", help="Print the cases instead of running them.")] = False,
) -> None:
    """Draw random strips, and print the last angles under automatic path control and by plain Newton."""
    chosen = [draw for draw in draws(seed, count) if not only or draw.number in only]
    if case:
        print("\n".join(draw.toml(to, step, "auto") for draw in chosen))
        return
    bar = Progress(console=Console(stderr=True), transient=True)
    with bar:
        task = bar.add_task("strips", total=len(chosen))
        attempts = [Attempt(draw, to, step) for draw in chosen]
        done = compute_all(attempts, processes or cores(), lambda *_: bar.advance(task))
    found = []
    for draw, one in zip(chosen, done, strict=True):
        assert isinstance(one.outcome, tuple)
        found.append((draw, one.outcome))
    write(out, found)
    console = wide_console()
    console.print(shares(found))
    if any(outcomes[1].cause for _, outcomes in found):
        console.print(failures(found))
    console.print(f"seed {seed}; every strip in {out}", soft_wrap=True)
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    typer.run(main)
