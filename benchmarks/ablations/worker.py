"""A process that computes paths without one method: it reads runs from standard input, one a line."""

import json
import sys
from time import process_time

import numpy as np

from ablations.methods import METHODS


def main(name: str) -> None:
    """Switch a method off, unless the name is empty; then compute the requested runs."""
    for method in METHODS:
        if method.name == name:
            method.switch_off()
    # the package after the switch: some of its functions are compiled with what they call
    import isopeel
    from isopeel.paper.study import Run

    for line in sys.stdin:
        space, mesh, to = json.loads(line)
        run = Run(space, mesh)
        angles = run.angles_deg[run.angles_deg <= to + 1e-9]
        case = run.case
        steps, corrections, moment = 0, 0, float("nan")
        began = process_time()
        try:
            for step in isopeel.trace(case.problem(), case.space(), np.radians(angles)):
                steps, corrections, moment = steps + 1, corrections + len(step.iterations), step.reaction
        except isopeel.ConvergenceError:
            pass  # as far as it goes
        print(json.dumps([process_time() - began, steps, corrections, moment]), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
