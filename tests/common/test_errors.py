"""Errors, as they go from process to process."""

import pickle

from isopeel import ConvergenceError, InputError


def test_errors_are_the_same_in_another_process() -> None:
    error = pickle.loads(pickle.dumps(InputError("mesh", "0x1", "too small")))
    assert (error.field, error.value, error.allowed) == ("mesh", "0x1", "too small")
    assert str(error) == str(InputError("mesh", "0x1", "too small"))
    failed = pickle.loads(pickle.dumps(ConvergenceError("because", (1.0, 2.0), 0.5)))
    assert (failed.reason, failed.iterations, failed.parameter) == ("because", (1.0, 2.0), 0.5)
