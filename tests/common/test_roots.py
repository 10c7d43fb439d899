"""Roots, compared with those of SciPy."""

from collections.abc import Callable
from math import cos, exp, inf, nan

import numpy as np
import pytest
from scipy.optimize import brentq, newton

from isopeel.common.roots import brent, secant

FUNCTIONS: dict[str, Callable[[float], float]] = {
    "line": lambda x: 3 * x - 0.7,
    "cosine": lambda x: cos(x) - x,
    "flat": lambda x: (x - 0.3) ** 9,
    "steep": lambda x: exp(60 * x) - 1e8,
    "pole": lambda x: 1 / (x - 0.41),
    "jump": lambda x: -1.0 if x < 0.2 else 2.0,
    "tiny": lambda x: 1e-290 * (x**3 - 0.02),
    "steps": lambda x: round(4 * x, 1) - 1.3,
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize(("absolute", "relative"), [(2e-12, 1e-10), (1e-300, 1e-14), (1e-3, 1e-15)])
def test_a_root_is_that_of_scipy_to_the_bit(name: str, absolute: float, relative: float) -> None:
    places: list[float] = []
    theirs: list[float] = []

    def noted(into: list[float]) -> Callable[[float], float]:
        def value(x: float) -> float:
            into.append(x)
            return FUNCTIONS[name](x)

        return value

    options = {"xtol": absolute, "rtol": relative, "maxiter": 2000}
    expected = brentq(noted(theirs), -1.0, 2.0, **options)
    found = brent(noted(places), -1.0, 2.0, absolute=absolute, relative=relative, most=2000)
    assert found == expected
    assert places == theirs


def test_an_end_may_be_the_root() -> None:
    assert brent(lambda x: x, 0.0, 1.0) == 0.0
    assert brent(lambda x: x - 1, 0.0, 1.0) == 1.0


@pytest.mark.parametrize("value", [1.0, inf, nan])
def test_no_root_is_an_error(value: float) -> None:
    with pytest.raises(ValueError, match=r"same sign|nan"):
        brent(lambda _: value, 0.0, 1.0)


def test_too_few_iterations_are_an_error() -> None:
    with pytest.raises(ArithmeticError, match="after 3 iterations"):
        brent(lambda x: cos(x) - x, 0.0, 1.0, most=3)


@pytest.mark.parametrize("softness", [0.0, 1e-3, 0.3, 10.0, 2000.0])
def test_a_complex_root_is_that_of_scipy_to_the_bit(softness: float) -> None:
    def determinant(z: complex) -> complex:
        sine, cosine = np.sin(z), np.cos(z)
        return complex(z + sine * cosine + softness * z * (z**2 - sine**2))

    expected = complex(newton(determinant, 2.1061961 + 1.1253643j, tol=1e-13, maxiter=200))
    assert secant(determinant, 2.1061961 + 1.1253643j, absolute=1e-13, most=200) == expected


def test_a_function_without_a_complex_root_is_an_error() -> None:
    with pytest.raises(ArithmeticError, match="no root"):
        secant(np.exp, 1 + 1j, absolute=1e-13, most=5)
