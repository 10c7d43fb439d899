"""The time left of a study."""

import pytest

from isopeel.study.time_left import clock, seconds_left


def test_the_time_left_is_that_of_the_mean_run() -> None:
    """Three of ten runs took 30 s on all workers together: seven take 70 s."""
    assert seconds_left(30.0, 3, 7) == pytest.approx(70.0, rel=1e-15)


def test_a_time_is_shown_as_on_a_clock() -> None:
    assert clock(59.6) == "0:01:00"
    assert clock(3_723.2) == "1:02:03"
