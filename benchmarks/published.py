"""A run of the published study, computed by a separate process, which returns only its costs."""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import isopeel
from isopeel.common.processes import compute_all
from isopeel.paper.study import Run
from machine import peak_megabytes


@dataclass(frozen=True)
class Cost:
    """The costs of a run, and its last angle."""

    run: Run
    steps: int
    corrections: int
    seconds: float  # of the load steps alone
    peak: float  # MB of the process, with what it computed before
    last_deg: float
    began: float  # seconds since the epoch
    process: int


@dataclass(frozen=True)
class Follow:
    """The task of a run, up to an angle in degrees, or until it finds no equilibrium."""

    run: Run
    to_deg: float

    def __call__(self) -> Cost:
        began = time.time()
        case = self.run.case
        angles = self.run.angles_deg
        angles = angles[angles <= self.to_deg + 1e-9]
        steps = corrections = 0
        seconds, last = 0.0, float("nan")
        try:
            for step in isopeel.trace(case.problem(), case.space(), np.radians(angles)):
                steps, corrections = steps + 1, corrections + len(step.iterations)
                seconds, last = seconds + step.seconds, float(angles[step.number])
        except isopeel.ConvergenceError:
            pass  # the run ends early
        return Cost(self.run, steps, corrections, seconds, peak_megabytes(), last, began, os.getpid())


class Study(NamedTuple):
    """Runs and their costs, in the order in which they were started."""

    costs: list[Cost]
    seconds: list[float]  # of each run, with its tables
    wall: float
    started: list[float]  # seconds until each process began with its first run


def follow_all(
    runs: Sequence[Run], to_deg: float, workers: int, finished: Callable[[], None] = lambda: None
) -> Study:
    """Compute runs in separate processes, the costliest first."""
    ordered = sorted(runs, key=lambda run: -run.cost)
    began, clock = time.time(), time.perf_counter()
    done = compute_all([Follow(run, to_deg) for run in ordered], workers, lambda *_: finished())
    wall = time.perf_counter() - clock
    costs = [one.outcome for one in done if isinstance(one.outcome, Cost)]
    first: dict[int, float] = {}
    for cost in costs:
        first[cost.process] = min(cost.began - began, first.get(cost.process, np.inf))
    return Study(costs, [one.seconds for one in done], wall, sorted(first.values()))
