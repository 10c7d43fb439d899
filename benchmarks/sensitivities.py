"""Sensitivities of shipped cases to all their scalar parameters, against central differences of runs."""

import argparse
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from isopeel.case import Case, load_case
from isopeel.case.parameters import parameter_of
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.results.curve import Curve
from isopeel.running.sensitivities import Differentiation
from isopeel.running.stage_run import stage_runs
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings

#: Tolerance of the runs for the differences: reactions are otherwise known to 5e-9 only.
TOLERANCE = 1e-28
#: Multiples of the shift of a parameter that a sensitivity is computed with. The larger one has more error by
#: truncation and by kinks of the law, the smaller one by round-off: the deviation from the nearer one is
#: printed, and their difference, which is the error of the differences.
MULTIPLES = (1.0, 0.05)
#: Runs whose fastest one is the cost.
PASSES = 3
#: Coarser meshes and shorter paths, so that each case takes some minutes.
SHORT: dict[str, dict[str, Any]] = {
    "strip": {"discretization.mesh": "60x2", "drive.to": "30 deg", "drive.step": "1 deg", "reading": None},
    "curved-substrate": {"discretization.mesh": "60x2", "drive.to": "20 deg", "drive.step": "1 deg"},
    "spatula": {"discretization.mesh": "60x2", "drive.to": "10 nm", "drive.step": "0.5 nm"},
    "tape-angle": {
        "discretization.mesh": "80x2",
        "drive.to": "8 nm",
        "drive.step": "0.4 nm",
        "reading": None,
    },
    "double-cantilever": {"discretization.mesh": "60x2", "drive.to": "0.5 mm", "drive.step": "0.02 mm"},
    "press-and-peel": {"discretization.mesh": "60x2", "drive.2.to": "20 deg", "drive.2.step": "1 deg"},
    "cylinder-pull-off": {
        "discretization.mesh": "40x8",
        "drive.1.step": "0.05 nm",
        "drive.2.step": "0.05 nm",
    },
    "t-peel": {"discretization.mesh": "48x1", "drive.to": "3 mm", "drive.step": "0.3 mm"},
    "laminate": {"body.1.mesh": "60x1", "body.2.mesh": "60x1", "drive.to": "2 mm", "drive.step": "0.2 mm"},
    "tape-on-soft-substrate": {
        **{"body.1.mesh": "56x2", "body.2.mesh": "48x1", "drive.to": "2 mm", "drive.step": "0.2 mm"}
    },
    "mixed-mode-bending": {"discretization.mesh": "50x2", "drive.to": "0.5 mm", "drive.step": "0.05 mm"},
    "transfer-printing": {
        **{"body.1.mesh": "80x1", "body.2.mesh": "60x1", "drive.to": "2 mm", "drive.step": "0.2 mm"}
    },
}


class Compared(NamedTuple):
    """Sensitivities of a stage to a parameter: their scale, deviation and error of the differences."""

    scale: float
    deviation: float
    error: float
    steps: int


def keys_of(case: Case) -> list[str]:
    """Return the keys of all scalar parameters of a case that are not zero."""
    found = []
    for key in _leaves(tomllib.loads(case.text)):
        try:
            found.append(parameter_of(case, key).key)
        except InputError:
            continue
    return found


def _leaves(value: Any, key: str = "") -> Iterator[str]:
    if isinstance(value, dict | list):
        named = value.items() if isinstance(value, dict) else enumerate(value, start=1)
        for name, one in named:
            yield from _leaves(one, f"{key}.{name}" if key else str(name))
    else:
        yield key


def traced(case: Case, keys: Sequence[str] = ()) -> list[Curve]:
    """Return the curves of the stages, up to one that finds no equilibrium."""
    differentiation, base, curves = Differentiation.of(case, keys), None, []
    for number, begun in enumerate(stage_runs(case, Path())):
        steps = []
        try:
            for step in differentiation.steps(number, replace(begun, base=base)):
                steps.append(step)  # noqa: PERF402 (those before an error stay)
        except ConvergenceError:
            pass
        curves.append(Curve.of(steps, begun.stage.problem.drive, differentiation.sensitive_to))
        if len(curves[-1]) == 0 or curves[-1].parameter[-1] != _end(begun.stage):
            break
        base = steps[-1].state
    return curves


def _end(stage: Any) -> float:
    return float(stage.problem.drive.parameter_column.shown(stage.parameters[-1]))


def at(curve: Curve, parameters: FloatArray) -> FloatArray:
    """Return the first reactions at some parameters; NaN where the curve has none."""
    known: dict[float, float] = {}
    for parameter, reaction in zip(curve.parameter.tolist(), curve.reaction.tolist(), strict=True):
        known.setdefault(parameter, reaction)
    return np.array([known.get(parameter, np.nan) for parameter in parameters.tolist()])


def compared(
    case: Case, key: str, stencil: Sequence[tuple[float, float]], found: Sequence[Curve], number: int
) -> list[Compared]:
    """Compare the sensitivities of all stages to a parameter with differences of runs.

    The stencil has shifts and weights: it is one-sided for a length at which an element ends.
    """
    parameter, differences = parameter_of(case, key), []
    for multiple in MULTIPLES:
        stages = [np.zeros(len(curve)) for curve in found]
        for shift, weight in stencil:
            varied = traced(case.with_values({key: parameter.written(multiple * shift)}))
            for stage, curve in enumerate(found):
                reached = stage < len(varied)
                stages[stage] += weight / multiple * at(varied[stage], curve.parameter) if reached else np.nan
        differences.append(stages)
    outcomes = []
    for stage, curve in enumerate(found):
        mine, (larger, smaller) = curve.sensitivities[:, number], (one[stage] for one in differences)
        deviation = np.fmin(np.abs(mine - larger), np.abs(mine - smaller))
        known = np.isfinite(deviation)
        scale = float(np.abs(mine[known]).max(initial=0.0))
        error = float(np.abs(larger - smaller)[known].max(initial=0.0))
        largest = float(deviation[known].max(initial=0.0))
        outcomes.append(Compared(scale, largest, error, int(known.sum())))
    return outcomes


def _seconds(case: Case, keys: Sequence[str]) -> float:
    began = process_time()
    traced(case, keys)
    return process_time() - began


def main() -> None:
    """Print a line for each case, parameter and stage."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="*", default=[*SHORT])
    parser.add_argument("--keys", help="only these, separated by commas")
    parser.add_argument("--whole", action="store_true", help="meshes and paths of the shipped cases")
    parser.add_argument("--cost", action="store_true", help="print only what they cost")
    chosen = parser.parse_args()
    print(f"{'case, stage':25} {'parameter':28} {'scale':8}  deviation  of differences  steps")
    for name in chosen.cases:
        short = {} if chosen.whole else {"output": None, **SHORT.get(name, {})}
        case = load_case(name).with_values(short)
        keys = chosen.keys.split(",") if chosen.keys else keys_of(case)
        valid: dict[str, list[tuple[float, float]]] = {}
        for key in keys:
            try:
                first = Differentiation.of(case, [key]).of_stage(0, stage_runs(case, Path())[0])
                assert first is not None
                valid[key] = [(one.shift, one.weight) for one in first.variants[0]]
            except InputError as error:
                print(f"{name:25} {key:28} refused: {error.allowed}", flush=True)
        keys = [*valid]
        traced(case, keys)  # compiled code is made or read here
        # in turn, as other programs slow both
        passes = [[_seconds(case, some) for some in ([], keys[:1], keys)] for _ in range(PASSES)]
        plain, one, every = (min(seconds) for seconds in zip(*passes, strict=True))
        print(
            f"{name:25} {plain:.2f} s; more for one parameter: {one / plain - 1:.2f} of it,"
            f" for {len(keys)}: {every / plain - 1:.2f}",
            flush=True,
        )
        if chosen.cost:
            continue
        found = traced(case, keys)
        NewtonSettings.__init__.__defaults__, usual = (
            (TOLERANCE, *(NewtonSettings.__init__.__defaults__ or ())[1:]),
            NewtonSettings.__init__.__defaults__,
        )
        for number, (key, stencil) in enumerate(valid.items()):
            for stage, one in enumerate(compared(case, key, stencil, found, number), start=1):
                scale = one.scale or 1.0
                print(
                    f"{name + ', ' + str(stage):25} {key:28} {one.scale:.2e}  {one.deviation / scale:.1e}"
                    f"  {one.error / scale:.1e}  {one.steps}",
                    flush=True,
                )
        NewtonSettings.__init__.__defaults__ = usual


if __name__ == "__main__":
    main()
