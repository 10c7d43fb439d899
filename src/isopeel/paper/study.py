"""The published study: nine discretizations of the strip on three meshes, one run for each."""

import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import active_children, get_context

import numpy as np

from isopeel.post.closed_form import beam_peeling
from isopeel.post.reading import PlateauReading, read_plateau
from isopeel.problem import strip
from isopeel.results.curve import Curve
from isopeel.solve.newton import ConvergenceError
from isopeel.solve.trace import Step, trace
from isopeel.splines.rows import row_space

#: Elements along x and y of the published meshes.
MESHES = {"m1": (160, 8), "m2": (200, 10), "m3": (240, 12)}
#: The published discretizations, in the order of the published table.
SPACES = ("L1", "L2", "L4", "N2", "N4", "N6", "N8", "N2.1", "N4.1")
#: Where the plateau is read, in degrees. The window of the published table is not known.
WINDOW = (98.0, 101.4)
STEP = 0.1  # degree, as published


@dataclass(frozen=True)
class Run:
    """One discretization of the study on one mesh."""

    space: str
    mesh: str

    def measure(self) -> "Measurement":
        """Trace the strip just beyond the window, and read the plateau there."""
        problem, space = strip(), row_space(self.space, MESHES[self.mesh])
        closed_form = beam_peeling(problem)
        assert closed_form is not None  # it is a strip
        period = closed_form.period_deg(space.elements[0])
        last = int(np.ceil((WINDOW[1] + period / 2) / STEP))
        steps: list[Step] = []
        ended = None
        try:
            steps.extend(trace(problem, space, np.radians(np.arange(last + 1) * STEP)))
        except ConvergenceError as error:
            ended = error.reason
        curve = Curve.of(steps, problem.drive)
        return Measurement(
            run=self,
            dofs=2 * space.size,
            reached=float(curve.parameter[-1]),
            ended=ended,
            plateau=read_plateau(curve, WINDOW, period),
            by_line=read_plateau(curve, WINDOW),
            iterations=float(curve.iterations.mean()),
            seconds=float(curve.seconds.sum()),
        )


@dataclass(frozen=True)
class Measurement:
    """What a run gave. `ended` tells why it stopped early, where it did; then there may be no readings."""

    run: Run
    dofs: int
    reached: float  # degrees
    ended: str | None
    plateau: PlateauReading | None  # drift of the mean over a period taken out
    by_line: PlateauReading | None  # drift of the curve itself taken out
    iterations: float  # Newton corrections per step
    seconds: float


def measure_all(runs: Sequence[Run], workers: int) -> Iterator[Measurement]:
    """Measure runs in processes of their own, yielding each as it is done.

    The processes end at once where it is interrupted, or no more is asked for.
    """
    others = active_children()
    context = get_context("spawn")
    # Ctrl-C goes to the whole group of processes; the first alone should heed it
    with ProcessPoolExecutor(workers, context, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        try:
            for future in as_completed([pool.submit(run.measure) for run in runs]):
                yield future.result()
        except BaseException:
            for process in active_children():
                if process not in others:
                    process.terminate()
            raise
