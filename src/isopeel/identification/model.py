"""The curves of a case as a function of its parameters, at the measured points, with their derivatives."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.interrupts import check
from isopeel.identification.curve_task import CurveTask
from isopeel.identification.data_set import DataSet
from isopeel.identification.fit_file import Fit
from isopeel.identification.units import in_si
from isopeel.study.execution import Store
from isopeel.study.outcome import LOST, Outcome, Task, write_outcome


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Curves at values of the parameters, in SI units.

    `values` (points,) are those of all data sets, one after the other; `derivatives` (points, parameters) are
    per coordinate of the parameters; `interpolation` (points,) is the estimated error of the interpolation.
    `cause` says why there are none.
    """

    values: FloatArray
    derivatives: FloatArray
    interpolation: FloatArray
    cause: str = ""


class CurveModel:
    """Evaluates the curves of a fit, and stores each run in a folder by its digest, as a study does.

    `finished` is called after each run that was computed.
    """

    def __init__(self, fit: Fit, store: Store | None, finished: Callable[[Outcome], None]) -> None:
        self._fit = fit
        self._store = store
        self._finished = finished
        self._known: dict[tuple[float, ...], Evaluation] = {}
        self.runs = 0

    def __call__(self, values: Sequence[float]) -> Evaluation:
        """Return the curves at values of the parameters, in their units."""
        values = tuple(float(value) for value in values)
        if values not in self._known:
            self._known[values] = self._evaluated(values)
        return self._known[values]

    def _evaluated(self, values: tuple[float, ...]) -> Evaluation:
        parts = []
        for one in self._fit.data:
            outcome = self._run(CurveTask(one.case.text, self._fit.written(values)))
            part = at_measured(one, outcome)
            if part.cause:
                return part
            parts.append(part)
        slopes = [one.slope(value) for one, value in zip(self._fit.parameters, values, strict=True)]
        return Evaluation(
            np.concatenate([part.values for part in parts]),
            np.concatenate([part.derivatives for part in parts]) * slopes,
            np.concatenate([part.interpolation for part in parts]),
        )

    def _run(self, task: Task) -> Outcome:
        check()
        stored = None if self._store is None else self._store.read(task)
        if stored is not None:
            return stored
        outcome = task()
        check()
        if self._store is not None and outcome.ending != LOST:
            write_outcome(outcome, self._store.path(task))
        self.runs += 1
        self._finished(outcome)
        return outcome


def at_measured(one: DataSet, outcome: Outcome) -> Evaluation:
    """Interpolate the curve of a run linearly at the measured points, in SI units.

    The derivatives are per unit of the values. The error of the interpolation is estimated by leaving out
    every second step: the second difference, and with it the error, is then four times as large. The `cause`
    of the result says why there is no value.
    """
    nothing = Evaluation(np.empty(0), np.empty((0, 0)), np.empty(0))
    if one.stage >= len(outcome.lines):
        return replace(nothing, cause=outcome.cause or "an earlier stage did not complete")
    line = outcome.lines[one.stage]
    x, y = (
        values * in_si(unit) for values, unit in zip((line.parameter, line.reaction), line.units, strict=True)
    )
    rates = line.sensitivities * in_si(line.units[1])
    if len(x) > 1 and x[-1] < x[0]:
        x, y, rates = x[::-1], y[::-1], rates[::-1]
    slack = 1e-9 * (float(np.ptp(one.x)) or abs(float(one.x[0])))
    if not len(x) or one.x.min() < x[0] - slack or one.x.max() > x[-1] + slack:
        return replace(nothing, cause=outcome.cause or "the path ends inside the measured range")
    if not (np.diff(x) > 0).all():
        cause = "the path turns back, so that the reaction is no function of the parameter"
        return replace(nothing, cause=cause)
    fine, coarse = np.interp(one.x, x, y), np.interp(one.x, x[::2], y[::2])
    # at a limit point there is no derivative: those of the steps beside it are taken
    known = np.isfinite(rates).all(axis=1)
    if not known.any():
        return replace(nothing, cause="the derivatives of the reaction exist at no step of the path")
    derivatives = [np.interp(one.x, x[known], rate[known]) for rate in rates.T]
    return Evaluation(fine, np.column_stack(derivatives), np.abs(fine - coarse) / 3)
