"""The file of a fit, and what is said where it is wrong."""

from pathlib import Path

import numpy as np
import pytest

from isopeel.common.errors import InputError
from isopeel.identification.fit_file import Fit, load_fit

CURVE = "displacement [um],force [mN/mm]\n" + "".join(f"{x / 1000},{x / 10}\n" for x in range(1, 11))
FIT = """
name = "tape"
case = "tape-angle"

[set]
"drive.to" = "10 nm"

[[measured]]
file = "curve.csv"
noise = "1 %"
set = { "drive.angle" = "70 deg" }

[[parameter]]
key = "adhesion.hamaker_constant"
start = "1e-19 J"
lower = "5e-20 J"
upper = "2e-19 J"

[[parameter]]
key = "material.poissons_ratio"
start = 0.3
lower = -0.2

[search]
starts = 1
profile = "material.poissons_ratio"
"""


def _load(folder: Path, text: str = FIT, curve: str = CURVE) -> Fit:
    (folder / "fit.toml").write_text(text)
    (folder / "curve.csv").write_text(curve)
    return load_fit(folder / "fit.toml")


def test_a_fit_is_read_with_its_case_and_curves(tmp_path: Path) -> None:
    fit = _load(tmp_path)
    (data,) = fit.data
    np.testing.assert_allclose(data.x, np.arange(1, 11) * 1e-9, rtol=1e-14)
    np.testing.assert_allclose(data.y, np.arange(1, 11) / 10, rtol=1e-14)
    assert data.deviations is not None
    np.testing.assert_allclose(data.deviations, 0.01, rtol=1e-14)
    assert data.case.value("drive.angle") == "70 deg"
    hamaker, poisson = fit.parameters
    assert (hamaker.start, hamaker.lower, hamaker.upper, hamaker.unit) == (1e-19, 5e-20, 2e-19, "J")
    assert hamaker.logarithmic
    assert not poisson.logarithmic
    assert fit.profile == poisson.key


@pytest.mark.parametrize("value", [0.3, 3e-20, 7.0])
def test_a_coordinate_is_one_at_the_start_and_has_the_stated_slope(tmp_path: Path, value: float) -> None:
    for parameter in _load(tmp_path).parameters:
        assert parameter.coordinate(parameter.start) == 1
        at, step = parameter.coordinate(value), 1e-6
        assert parameter.value(at) == pytest.approx(value, rel=1e-12)
        slope = (parameter.value(at + step) - parameter.value(at - step)) / (2 * step)
        # the truncation of the difference is 1e-12
        assert parameter.slope(value) == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"tape-angle"', '"none.toml"', "^case: .*none.toml"),
        ("[[measured]]", "[[measure]]", "^measure: .*there is no such key"),
        (
            'file = "curve.csv"',
            'file = "none.csv"',
            "^measured: .*none.csv' cannot be used; it does not exist",
        ),
        ('file = "curve.csv"', "file = 3", "^measured.1.file: 3 cannot be used; the path of a CSV file"),
        ('noise = "1 %"', 'noise = "1 nm"', "^measured.1.noise: '1 nm' cannot be used; .*a share of"),
        ('noise = "1 %"', 'noise = "-1 %"', "^measured.1.noise: '-1 %' cannot be used; it must be positive"),
        ('noise = "1 %"', 'y = "moment"', "moment' cannot be used; no column has this name"),
        ('noise = "1 %"', 'stage = "press"', "^measured.1.stage: 'press' .*the stages are"),
        ('"drive.angle" =', '"drive.angel" =', "^measured.1.set.drive.angel: "),
        ('"drive.to" = "10 nm"', '"drive.to" = "9 nm"', "from 0 to 0.009 um; 1 of 10 points are outside"),
        ('start = "1e-19 J"', 'start = "1e-19 N"', "^parameter.1.lower: '5e-20 J'"),
        (
            'start = "1e-19 J"',
            'start = "3e-19 J"',
            "^parameter.1.start: '3e-19 J' .*between the bounds 5e-20 J and",
        ),
        ('start = "1e-19 J"', "start = true", "^parameter.1.start"),
        ('lower = "5e-20 J"', 'lower = "3e-19 J"', "^parameter.1.upper: .*larger than `lower`"),
        ('lower = "5e-20 J"', 'lower = "nan J"', "^parameter.1.lower: 'nan J'"),
        ('key = "adhesion.hamaker_constant"', 'key = "adhesion.hamaker"', "^parameter.1, adhesion.hamaker: "),
        ('key = "adhesion.hamaker_constant"', 'key = "body.width"', "^parameter.1, body.width: "),
        ('key = "adhesion.hamaker_constant"', 'key = "drive.angle"', "^parameter.1.key: .* sets this key"),
        ('key = "material.poissons_ratio"', 'key = "adhesion.hamaker_constant"', "^parameter.2"),
        ("start = 0.3", 'start = "0.3"', "^parameter.2.start: '0.3'"),
        ("start = 0.3", "start = 0.7", "^parameter.2, material.poissons_ratio: 0.7"),
        ("lower = -0.2", 'scale = "logarithmic"\nlower = -0.2', "^parameter.2.scale: "),
        ("lower = -0.2", "lower = -0.2\nupper = -0.3", "^parameter.2.upper: "),
        ("starts = 1", "starts = 2", "^parameter.2: .*several starts need"),
        ("starts = 1", "starts = 0", "^search.starts: 0 "),
        ("profile =", "profil =", "^search.profil: .*the keys are starts, seed, profile"),
        ('profile = "material', 'profile = "body', "^search.profile: 'body.poissons_ratio'"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in FIT
    with pytest.raises(InputError, match=message) as caught:
        _load(tmp_path, FIT.replace(old, new))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("curve", "message"),
    [
        (
            CURVE.replace("[mN/mm]", "[N]"),
            r"'N' cannot be used; .*'N/m'.* of another kind; the key body.width",
        ),
        (CURVE.replace("[um]", "[deg]"), "'deg' cannot be used; .*displacement in 'nm'"),
        ("displacement [um],force [N/m]\n0.001,1\n", "'1 points' .*2 parameters need at least as many"),
        ("displacement [um],force [N/m]\n0.001,0\n0.002,0\n", "all values of force"),
    ],
)
def test_a_curve_that_does_not_fit_the_case_is_refused(tmp_path: Path, curve: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _load(tmp_path, curve=curve)


def test_noise_is_stated_for_all_curves_or_none(tmp_path: Path) -> None:
    second = '[[measured]]\nfile = "curve.csv"\n'
    with pytest.raises(InputError, match=r"^measured.2.noise: .*of all measured curves, or of none"):
        _load(tmp_path, FIT + second)
    assert _load(tmp_path, FIT.replace('noise = "1 %"', "") + second).data[1].deviations is None
    two = "displacement [um],force [N/m]\n0.001,1\n0.002,2\n"
    with pytest.raises(InputError, match="no residual to estimate the noise from"):
        _load(tmp_path, FIT.replace('noise = "1 %"', ""), two)
