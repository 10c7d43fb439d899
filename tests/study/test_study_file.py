"""The file of a study, and what is said where it is wrong."""

import tomllib
from pathlib import Path

import pytest

from isopeel.case import load_case
from isopeel.common.errors import InputError
from isopeel.study.study_file import read_study, study_of

GOOD = """
name = "angles"
case = "tape-angle"
outputs = ["largest force"]

[set]
"discretization.mesh" = "80x2"

[[factor]]
key = "drive.angle"
values = ["60 deg", "90 deg"]

[[factor]]
key = "adhesion.hamaker_constant"
from = "0.5e-19 J"
to = "1e-19 J"
count = 3
scale = "logarithmic"
"""


def test_a_study_is_read_with_its_case_and_points(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(GOOD)
    study = read_study(tmp_path / "study.toml")
    assert study.case.space().elements == (80, 2)
    assert len(study.points) == 6
    assert study.points[0] == {"drive.angle": "60 deg", "adhesion.hamaker_constant": "5e-20 J"}
    assert study.outputs == ("largest force",)


def test_a_case_is_seen_from_the_folder_of_the_study(tmp_path: Path) -> None:
    case = load_case("strip").with_values({"name": "mine"})
    (tmp_path / "my.toml").write_text(case.text)
    (tmp_path / "study.toml").write_text(
        'name = "s"\ncase = "my.toml"\n[[factor]]\nkey = "body.height"\nvalues = ["8 nm"]\n'
    )
    assert read_study(tmp_path / "study.toml").case.name == "mine"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('case = "tape-angle"', 'case = "none.toml"', "^case: .*none.toml"),
        ('key = "drive.angle"', 'key = "drive.angel"', r"^factor.1, drive.angel: .*there is no such key"),
        ('"90 deg"]', '"90 nm"]', "^factor.1, drive.angle: '90 nm'"),
        ('to = "1e-19 J"', 'to = "1e-19 N"', "^factor.2.to: '1e-19 N'.* 'J'"),
        ('to = "1e-19 J"', "to = 1", "^factor.2.to: 1 "),
        ('to = "1e-19 J"', 'to = "nan J"', "^factor.2.to: 'nan J'"),
        ('from = "0.5e-19 J"', "from = nan", "^factor.2.from: nan"),
        ('from = "0.5e-19 J"', 'from = "-1e-19 J"', "^factor.2.scale: .*positive"),
        ("count = 3", "count = 1", "^factor.2.count: 1 "),
        ("count = 3", "", "^factor.2: .*`from`, `to` and, in a grid, `count`"),
        (
            'values = ["60 deg", "90 deg"]',
            'values = ["60 deg", "60 deg"]',
            "^factor.1.values: '60 deg'",
        ),
        ('"discretization.mesh" = "80x2"', '"drive.angle" = "1 deg"', "^set.drive.angle: .*a factor has"),
        ('scale = "logarithmic"', 'scale = "log"', "^factor.2.scale: 'log'"),
        ('scale = "logarithmic"', "values = [1]", "^factor.2.from: .*not both"),
        ('scale = "logarithmic"', 'zap = "a"', "^factor.2.zap: .*the keys are key, values, from"),
        ('values = ["60 deg", "90 deg"]', "values = []", "^factor.1.values: "),
        ('"discretization.mesh" = "80x2"', '"discretization.mash" = 1', "^set.discretization.mash: "),
        ("outputs", "output", "^output: .*there is no such key; .*factor"),
        ('key = "adhesion.hamaker_constant"', 'key = "drive.angle"', "^factor.2.key: .*another factor"),
        ('name = "angles"', 'name = "../a"', "^name: '../a'"),
        ("[set]", "[design]\ncount = 4\n[set]", "^design.count: 4 .*grid"),
        ("[set]", '[design]\nmethod = "sobol"\n[set]', "^design.count: the key is missing"),
        ("[set]", '[design]\nmethod = "sobol"\ncount = 6\n[set]', "^design.count: 6 .*powers of two"),
        ("count = 3", "count = 100000", "^factor: '200000 runs'"),
        ('values = ["60 deg", "90 deg"]', 'values = ["60 deg"]\nzip = "a"', None),
    ],
)
def test_what_is_wrong_is_said_in_one_line(old: str, new: str, message: str | None) -> None:
    assert old in GOOD
    document = GOOD.replace(old, new, 1)
    if message is None:
        document = document.replace("count = 3", 'count = 3\nzip = "a"')
        message = "^zip: 'a' .*drive.angle has 1, adhesion.hamaker_constant has 3"
    with pytest.raises(InputError, match=message) as error:
        study_of(tomllib.loads(document))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("content", "message"), [(b"name = ", "not TOML"), (b"\xff\xfe", "UTF-8"), (None, "exist")]
)
def test_a_file_that_cannot_be_read_is_named(content: bytes | None, message: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=f"^STUDY: .*{message}"):
        read_study(path)


def test_a_range_of_a_sample_needs_no_count() -> None:
    document = GOOD.replace("count = 3", "").replace(
        "[set]", '[design]\nmethod = "sobol"\ncount = 4\n[set]', 1
    )
    points = study_of(tomllib.loads(document)).points
    assert len({point["adhesion.hamaker_constant"] for point in points}) == 4


def test_a_value_may_need_that_of_another_factor() -> None:
    """A face of 250 nm does not fit to the strip of 200 nm, but to one of 300 nm."""
    factors = [
        {"key": "adhesion.length", "values": ["150 nm", "250 nm"]},
        {"key": "body.length", "values": ["200 nm", "300 nm"]},
    ]
    study = study_of({"name": "s", "case": "strip", "factor": factors})
    assert len(study.points) == 4
    with pytest.raises(InputError, match=r"^factor.1, adhesion.length: '250 nm' .*at most 200 nm"):
        study_of({"name": "s", "case": "strip", "factor": factors[:1]})
