"""Errors: their messages, and that they can be passed to other processes."""

import pickle

from isopeel import ConvergenceError, InputError


def test_errors_are_the_same_in_another_process() -> None:
    error = pickle.loads(pickle.dumps(InputError("mesh", "0x1", "too small")))
    assert (error.field, error.value, error.allowed) == ("mesh", "0x1", "too small")
    assert str(error) == str(InputError("mesh", "0x1", "too small"))
    failed = pickle.loads(pickle.dumps(ConvergenceError("because", (1.0, 2.0), 0.5)))
    assert (failed.reason, failed.iterations, failed.parameter) == ("because", (1.0, 2.0), 0.5)


def test_a_missing_value_is_not_shown() -> None:
    assert str(InputError("body.length", None, "the key is missing")) == "body.length: the key is missing"
    assert str(InputError("body.length", 0, "a length is needed")).startswith(
        "body.length: 0 cannot be used; "
    )
