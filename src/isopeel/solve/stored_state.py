"""What the solver needs to continue bit for bit, as plain arrays: the file of a run stores them unread."""

from collections.abc import Mapping

import numpy as np

from isopeel.common.arrays import FloatArray, frozen
from isopeel.solve.lbfgs import LbfgsPairs
from isopeel.solve.quasi_newton import SolverState
from isopeel.solve.step import PARABOLA_POINTS, AcceptedState, State

#: Changes where the arrays mean something else.
VERSION = 1


def solver_arrays(state: State) -> dict[str, FloatArray]:
    """Return the arrays of the accepted states and of the solver state; none where there is neither."""
    arrays: dict[str, FloatArray] = {}
    if state.accepted_states:
        parameters, unknowns, *energies, converged = zip(*state.accepted_states, strict=True)
        arrays["accepted_parameter"] = np.array(parameters)
        arrays["accepted_unknown_values"] = np.array(unknowns)
        arrays["accepted_energies"] = np.stack(energies, axis=1)
        # only the last ones are ever converged to round-off
        nothing = np.full_like(unknowns[0], np.nan)
        last = converged[-PARABOLA_POINTS:]
        arrays["accepted_fully_converged"] = np.array([nothing if y is None else y for y in last])
    solver = state.solver_state
    if solver is not None:
        arrays["chord_at"] = np.array([solver.parameter, solver.steps, solver.slow], np.float64)
        arrays["chord_unknown_values"] = solver.unknown_values
        arrays["chord_maximum_openings"] = solver.maximum_openings
        arrays["lbfgs_corrections"] = solver.lbfgs_pairs.corrections.astype(np.float64)
        arrays["lbfgs_changes"] = solver.lbfgs_pairs.changes.astype(np.float64)
    return arrays


def restored(state: State, arrays: Mapping[str, FloatArray]) -> State:
    """Return a state with what the arrays hold.

    Raises KeyError or ValueError where they do not fit together.
    """
    return state._replace(accepted_states=_accepted(arrays), solver_state=_solver_state(arrays))


def _accepted(arrays: Mapping[str, FloatArray]) -> tuple[AcceptedState, ...]:
    if "accepted_parameter" not in arrays:
        return ()
    parameters = _shaped(arrays, "accepted_parameter", None)
    count = len(parameters)
    unknowns = _shaped(arrays, "accepted_unknown_values", count, None)
    energies = _shaped(arrays, "accepted_energies", count, 3)
    converged = _shaped(arrays, "accepted_fully_converged", None, unknowns.shape[1])
    nothing = [np.full(1, np.nan)] * (count - len(converged))
    return tuple(
        AcceptedState(p, frozen(y), energy, rate, adhesive, None if np.isnan(exact).all() else frozen(exact))
        for p, y, (energy, rate, adhesive), exact in zip(
            parameters.tolist(), unknowns, energies.tolist(), [*nothing, *converged], strict=True
        )
    )


def _solver_state(arrays: Mapping[str, FloatArray]) -> SolverState | None:
    if "chord_at" not in arrays:
        return None
    parameter, steps, slow = _shaped(arrays, "chord_at", 3).tolist()
    y = _shaped(arrays, "chord_unknown_values", None)
    maximum_openings = _shaped(arrays, "chord_maximum_openings", None, None)
    corrections = _shaped(arrays, "lbfgs_corrections", None, y.size)
    changes = _shaped(arrays, "lbfgs_changes", len(corrections), y.size)
    pairs = LbfgsPairs.of(corrections, changes)
    return SolverState(frozen(y), parameter, frozen(maximum_openings), pairs, int(steps), bool(slow))


def _shaped(arrays: Mapping[str, FloatArray], name: str, *shape: int | None) -> FloatArray:
    """Return one of the arrays, checked for its shape (None is any size) and for finite numbers."""
    values = arrays[name]
    fits = values.ndim == len(shape) and all(
        wanted in (None, size) for size, wanted in zip(values.shape, shape, strict=False)
    )
    if not fits or not (name == "accepted_fully_converged" or np.isfinite(values).all()):
        raise ValueError(f"the solver's {name} does not fit")
    return values
