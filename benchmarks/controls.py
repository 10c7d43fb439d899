"""The runs of the published study with each path control: last angle, time, and agreement."""

import argparse
from collections import defaultdict
from time import process_time
from typing import NamedTuple

import numpy as np

import isopeel
from isopeel.common.path_control import PathControl
from isopeel.paper.study import MESHES, SPACES, Run

#: Allowed time of a step by continuation over that of plain Newton, where plain Newton converges.
ALLOWED = 1.5


class Outcome(NamedTuple):
    """The result of a run."""

    moments: dict[float, list[float]]  # by the angle in degrees; several if the curve turns back
    reached: float  # degrees
    steps: int
    limit_points: int
    seconds: float  # processor time, which other programs disturb less than the wall time
    ending: str


def followed(run: Run, path_control: PathControl, to: float) -> Outcome:
    """Trace a run up to an angle in degrees; compilation and the first step are not timed."""
    case = run.case
    angles = run.angles_deg[run.angles_deg <= to + 1e-9]
    settings = isopeel.NewtonSettings(path_control=path_control)
    moments: defaultdict[float, list[float]] = defaultdict(list)
    steps, limit_points, ending, began, reached = 0, 0, "complete", process_time(), 0.0
    try:
        for step in isopeel.trace(case.problem(), case.space(), np.radians(angles), settings):
            if steps == 0:
                began = process_time()
            steps += 1
            limit_points += step.kind == "limit point"
            reached = float(np.degrees(step.parameter))
            if step.kind == "requested":
                moments[round(reached, 6)].append(step.reaction)
    except isopeel.ConvergenceError as error:
        ending = error.cause
    return Outcome(moments, reached, steps, limit_points, process_time() - began, ending)


def main() -> None:
    """Print a line for each run and path control."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", nargs="+", choices=MESHES, default=[*MESHES])
    parser.add_argument("--space", nargs="+", choices=SPACES, default=[*SPACES])
    parser.add_argument("--to", type=float, default=150.0, help="degrees")
    chosen = parser.parse_args()
    path_controls: tuple[PathControl, ...] = ("newton", "continuation", "jump")
    print("run          control       reached  steps  limits  seconds  ms/step  ratio  difference  ending")
    for mesh in chosen.mesh:
        for space in chosen.space:
            plain: Outcome | None = None
            for path_control in path_controls:
                found = followed(Run(space, mesh), path_control, chosen.to)
                plain = plain or found
                each = found.seconds / max(found.steps - 1, 1)
                ratio = each * max(plain.steps - 1, 1) / plain.seconds
                common = found.moments.keys() & plain.moments.keys()
                difference = max(
                    min(abs(moment - plain.moments[a][0]) for moment in found.moments[a]) for a in common
                )
                print(
                    f"{space + ' ' + mesh:12} {path_control:12} {found.reached:8.1f} {found.steps:6d}"
                    f" {found.limit_points:7d} {found.seconds:8.1f} {1e3 * each:8.2f} {ratio:6.2f}"
                    f"{' ' if ratio <= ALLOWED else '!'} {difference:10.1e}  {found.ending}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
