"""Random pairs of strips that peel off each other, far from the literature, under automatic path control."""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import process_time
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import isopeel
import machine
from isopeel.case import Case
from isopeel.common.processes import compute_all, cores
from printing import plain_table, wide_console

LENGTH = 200.0  # nm
#: Ranges of the random parameters: uniform in the logarithm, except for Poisson's ratios.
YOUNGS_MODULUS = (0.2, 20.0)  # GPa, of each strip
POISSONS_RATIO = (0.0, 0.45)
HEIGHT = (4.0, 20.0)  # nm
ELEMENTS = (40, 400)  # along each strip, so that the meshes do not match
MOST_ACROSS = 6
WORK = (3e-3, 0.3)  # J/m^2
#: Largest attraction as a share of the lower Young's modulus.
STRENGTH = (0.003, 0.2)
SPACES = ("L1", "L2", "N2", "N2.1", "N4")
SCHEMES = ("unbiased", "biased")
#: Laws of a strength and a work of adhesion, and the keys that they need besides.
LAWS = {"exponential": "", "bilinear": "rise = 0.2\n", "dugdale": "transition = 0.5\n", "van-der-waals": ""}
#: Drives of the right ends: both turned apart, in degrees, or both moved apart by forces, in nm.
DRIVES = {"rotation": ("deg", 60.0), "force": ("nm", 40.0)}
STEPS = 60


@dataclass(frozen=True)
class Strip:
    """One of the two strips."""

    youngs_modulus_gpa: float
    poissons_ratio: float
    height_nm: float
    space: str
    mesh: str


@dataclass(frozen=True)
class Pair:
    """Two strips, their interface, and what peels them."""

    number: int
    upper: Strip
    lower: Strip
    law: str
    irreversible: bool
    scheme: str
    work: float  # J/m^2
    strength: float  # of the lower Young's modulus
    drive: str

    @property
    def strength_pa(self) -> float:
        """Largest attraction."""
        return self.strength * 1e9 * min(self.upper.youngs_modulus_gpa, self.lower.youngs_modulus_gpa)

    @property
    def kinds(self) -> set[str]:
        """The rows of the table that count it."""
        return {"all", self.law, self.scheme, self.drive, *(["irreversible"] if self.irreversible else [])}

    def toml(self) -> str:
        """Return the text of the case, which `isopeel run` can use too."""
        unit, to = DRIVES[self.drive]
        return f"""\
name = "two-bodies-{self.number}"
{_body("lower", self.lower, "")}{_body("upper", self.upper, 'on = "lower.top"')}
[[interface]]
between = ["upper.bottom", "lower.top"]
scheme = "{self.scheme}"
length = "{0.75 * LENGTH:g} nm"
law = "{self.law}"
irreversible = {str(self.irreversible).lower()}
{self._law_keys()}
[[support]]
boundary = "lower.left"
holds = "xy"

[[support]]
boundary = "upper.left"
holds = "x"

[discretization]
across_degree = 1

[drive]
kind = "{self.drive}"
{'angle = "90 deg"' if self.drive == "force" else ""}
to = "{to:g} {unit}"
step = "{to / STEPS:g} {unit}"
path_control = "auto"

[[drive.on]]
boundary = "upper.right"

[[drive.on]]
boundary = "lower.right"
factor = -1.0
"""

    def _law_keys(self) -> str:
        if self.law != "van-der-waals":
            keys = f'strength = "{self.strength_pa:.6g} Pa"\nwork_of_adhesion = "{self.work!r} J/m^2"\n'
            return keys + LAWS[self.law]
        # A_H and r0 by W = A_H 15^(1/3)/(16 pi r0^2) and the largest attraction sqrt(5) A_H/(9 pi r0^3)
        distance = 16 * np.sqrt(5) / (9 * 15 ** (1 / 3)) * self.work / self.strength_pa
        hamaker = self.work * 16 * np.pi * distance**2 / 15 ** (1 / 3)
        return f'hamaker_constant = "{hamaker:.6g} J"\nequilibrium_distance = "{distance:.6g} m"\n'


def _body(name: str, strip: Strip, place: str) -> str:
    return f"""
[[body]]
name = "{name}"
length = "{LENGTH:g} nm"
height = "{strip.height_nm!r} nm"
material.law = "neo-hooke"
material.youngs_modulus = "{strip.youngs_modulus_gpa!r} GPa"
material.poissons_ratio = {strip.poissons_ratio!r}
space = "{strip.space}"
mesh = "{strip.mesh}"
{place}
"""


@dataclass(frozen=True)
class Outcome:
    """The end of a path; the cause is empty where it is complete."""

    reached: float  # share of the path
    steps: int
    jumps: int
    cause: str
    reason: str
    seconds: float  # of processor time


@dataclass(frozen=True)
class Attempt:
    """The task of a pair: its path, which ends with the first step after a limit of processor time."""

    pair: Pair
    limit: float  # s

    def __call__(self) -> Outcome:
        case = Case.parse(self.pair.toml())
        (stage,) = case.stages()
        settings = isopeel.NewtonSettings(path_control="auto")
        reached, steps, jumps, cause, reason = 0.0, 0, 0, "", ""
        begun = process_time()
        try:
            for step in isopeel.trace(stage.problem, case.spaces(), stage.parameters, settings):
                reached, steps = step.parameter / stage.parameters[-1], steps + 1
                jumps += step.kind == "jump"
                if process_time() - begun > self.limit and reached < 1.0:
                    cause, reason = "time limit", f"{self.limit:g} s of processor time"
                    break
        except isopeel.ConvergenceError as error:
            cause, reason = error.cause, error.reason
        return Outcome(float(reached), steps, jumps, cause, reason, process_time() - begun)


def draws(seed: int, count: int) -> list[Pair]:
    """Return random pairs; the first ones do not depend on the number of pairs."""
    found = _stream(seed)
    return [next(found) for _ in range(count)]


def _stream(seed: int) -> Iterator[Pair]:
    random = np.random.default_rng(seed)

    def between(ends: tuple[float, float]) -> float:
        return float(f"{np.exp(random.uniform(*np.log(ends))):.4g}")

    def one_of(names: Sequence[str]) -> str:
        return names[int(random.integers(len(names)))]

    def strip() -> Strip:
        height, along = between(HEIGHT), round(between(ELEMENTS))
        across = int(np.clip(round(along * height / LENGTH), 1, MOST_ACROSS))
        ratio = round(random.uniform(*POISSONS_RATIO), 3)
        return Strip(between(YOUNGS_MODULUS), ratio, height, one_of(SPACES), f"{along}x{across}")

    number = 0
    while True:
        law = one_of(list(LAWS))
        yield Pair(
            number,
            strip(),
            strip(),
            law,
            bool(random.integers(2)),
            one_of(SCHEMES),
            between(WORK),
            between(STRENGTH),
            one_of(list(DRIVES)),
        )
        number += 1


def summary(found: Sequence[tuple[Pair, Outcome]]) -> Table:
    """Return the table of complete pairs by law, scheme and drive."""
    table = plain_table(
        "pairs of strips that reach the end of the path",
        *("", "pairs", "complete", "steps\nmedian", "jumps\nmedian", "seconds\nmedian", "seconds\nmost"),
        labels=1,
    )
    for kind in ("all", *LAWS, "irreversible", *SCHEMES, *DRIVES):
        some = [outcome for pair, outcome in found if kind in pair.kinds]
        if some:
            seconds = [outcome.seconds for outcome in some]
            table.add_row(
                kind,
                str(len(some)),
                str(sum(not outcome.cause for outcome in some)),
                f"{np.median([outcome.steps for outcome in some]):.0f}",
                f"{np.median([outcome.jumps for outcome in some]):.0f}",
                f"{np.median(seconds):.1f}",
                f"{max(seconds):.1f}",
            )
    return table


def failures(found: Sequence[tuple[Pair, Outcome]]) -> Table:
    """Return the table of pairs whose path stops early, with the causes."""
    table = plain_table(
        "pairs whose path stops early",
        *("", "law", "drive", "scheme", "upper", "lower", "strength/E", "reached", "cause"),
        labels=6,
    )
    for pair, outcome in found:
        if outcome.cause:
            table.add_row(
                *(str(pair.number), pair.law + (", damage" if pair.irreversible else ""), pair.drive),
                *(
                    pair.scheme,
                    f"{pair.upper.space} {pair.upper.mesh}",
                    f"{pair.lower.space} {pair.lower.mesh}",
                ),
                f"{pair.strength:.3g}",
                f"{100 * outcome.reached:.0f} %",
                f"{outcome.cause}: {outcome.reason}",
            )
    return table


def write(path: Path, found: Sequence[tuple[Pair, Outcome]]) -> None:
    """Write one line per pair."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = []
    for pair, outcome in found:
        row = asdict(pair)
        for name in ("upper", "lower"):
            row |= {f"{name}_{key}": value for key, value in row.pop(name).items()}
        rows.append(row | asdict(outcome))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def main(
    seed: Annotated[int, typer.Option(help="Of the draw.")] = 0,
    count: Annotated[int, typer.Option(min=1, help="Pairs.")] = 50,
    only: Annotated[list[int] | None, typer.Option(help="Numbers of pairs; repeatable.")] = None,
    processes: Annotated[int | None, typer.Option(min=1, help="All cores when left out.")] = None,
    out: Annotated[Path, typer.Option(help="Table of every pair.")] = Path("out/stress_two_bodies.csv"),
    limit: Annotated[float, typer.Option(min=0, help="Processor time of a pair, in s.")] = 300.0,
    case: Annotated[bool, typer.Option("--case", help="Print the cases instead of running them.")] = False,
) -> None:
    """Draw random pairs of strips, and print which reach the end of their path, and why others do not."""
    chosen = [pair for pair in draws(seed, count) if not only or pair.number in only]
    if case:
        print("\n".join(pair.toml() for pair in chosen))
        return
    bar = Progress(console=Console(stderr=True), transient=True)
    with bar:
        task = bar.add_task("pairs", total=len(chosen))
        done = compute_all(
            [Attempt(pair, limit) for pair in chosen], processes or cores(), lambda *_: bar.advance(task)
        )
    found = []
    for pair, one in zip(chosen, done, strict=True):
        assert isinstance(one.outcome, Outcome)
        found.append((pair, one.outcome))
    write(out, found)
    console = wide_console()
    console.print(summary(found))
    if any(outcome.cause for _, outcome in found):
        console.print(failures(found))
    console.print(f"seed {seed}; every pair in {out}", soft_wrap=True)
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    typer.run(main)
