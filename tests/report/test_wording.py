"""Numbers and lists are written as they are read."""

from isopeel.report.wording import deviation, digits, listed, number


def test_numbers_are_worded() -> None:
    assert digits(0.0046151, 4) == "0.004615"
    assert digits(2.0) == "2.000"
    assert number(2.0, 1) == "2.0"
    assert deviation(1.1, 1.0) == "+10 %"
    assert deviation(3.0, 4.0) == "-25 %"


def test_what_is_missing_is_a_dash() -> None:
    assert digits(None) == number(None) == deviation(None, 1.0) == deviation(1.0, None) == "-"


def test_words_are_listed() -> None:
    assert listed([]) == ""
    assert listed(["a"]) == "a"
    assert listed(["a", "b", "c"]) == "a, b and c"
