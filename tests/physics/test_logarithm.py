"""The logarithm of compiled loops against NumPy's."""

import numpy as np
import pytest

from isopeel.physics.logarithm import log


def test_it_is_numpys_to_two_units_in_the_last_place() -> None:
    rng = np.random.default_rng(0)
    everywhere = 10.0 ** rng.uniform(-300, 300, 2000)
    near_one = 1 + np.concatenate([rng.uniform(-0.3, 0.5, 2000), 10.0 ** rng.uniform(-15, -1, 500)])
    for x in (everywhere, near_one, np.array([1.0, 2.0, 0.5, np.sqrt(2), np.sqrt(0.5)])):
        found, known = np.array([log(value) for value in x]), np.log(x)
        assert np.all(np.abs(found - known) <= 2 * np.spacing(np.abs(known)))


@pytest.mark.parametrize("x", [0.0, -1.0, -np.inf, np.inf, np.nan])
def test_it_is_nan_where_there_is_none(x: float) -> None:
    assert np.isnan(log(x))
