"""Path control: where a step finds no equilibrium, a path ends, cuts the step, jumps or follows its curve."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import nullcontext
from time import perf_counter

from threadpoolctl import ThreadpoolController

from isopeel.common.interrupts import check, deferred
from isopeel.solve.continuation_control import along_curve
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.cutting import cut_steps
from isopeel.solve.diagnosis import diagnosed
from isopeel.solve.lost_partners import with_lost_partner
from isopeel.solve.path import Path
from isopeel.solve.step import Found, Step
from isopeel.solve.verification import without_gain


def follow_path(path: Path, parameters: Iterable[float], passed: Sequence[float]) -> Iterator[Step]:
    """Yield the steps of a path through parameters, with the path control of its settings.

    `passed` are values of the parameter that the path has met before.
    """
    path_control = path.settings.path_control
    found: Iterator[Found]
    if path_control == "newton":
        found = _plain(path, parameters)
    elif path_control == "auto":
        found = cut_steps(path, parameters)
    else:
        found = along_curve(path, [*passed, *parameters], len(passed), jumps=path_control == "jump")
    with deferred():  # an interrupt in the middle of it would leave a file open
        libraries = ThreadpoolController().select(user_api="blas")
        threaded = any(library["num_threads"] > 1 for library in libraries.info())
    while True:
        began = perf_counter()
        # for narrow bands and short vectors, starting threads costs more than they gain
        with deferred(), libraries.limit(limits=1) if threaded else nullcontext():
            check()
            try:
                one = next(found, None)
            except ConvergenceError as error:
                raise with_lost_partner(path, error).located(path.system) from error.__cause__
            if one is None:
                return
            step = path.accept(one, began)
        yield step


def _plain(path: Path, parameters: Iterable[float]) -> Iterator[Found]:
    for parameter in parameters:
        try:
            yield without_gain(path, Found(path.solver.equilibrium(parameter)))
        except ConvergenceError as error:
            raise diagnosed(path, error, parameter) from error
