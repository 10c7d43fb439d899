"""Measured curves are read from CSV files, and what is wrong with them is said in one line."""

from pathlib import Path

import numpy as np
import pytest

from isopeel.common.errors import InputError
from isopeel.identification.measured import read_measured

GOOD = "# machine 3\ntime [s],displacement [mm],force [N/25 mm]\n0.1,0,0\n\n0.2,1.5,3e-1\n"


def test_columns_have_names_and_units(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(GOOD.replace("time [s],", "").replace("0.1,0", "0").replace("0.2,", ""))
    found = read_measured(path)
    assert found.columns == ("displacement", "force")
    assert found.units == ("mm", "N/25 mm")
    np.testing.assert_array_equal(found.x, [0, 1.5])
    np.testing.assert_array_equal(found.y, [0, 0.3])
    assert found.deviations is None


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_columns_are_chosen_by_name_or_heading(tmp_path: Path, delimiter: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text("x (mm),s [N/m],y [N/m]\n1,0.5,7\n2,0.25,8\n".replace(",", delimiter), "utf-8-sig")
    found = read_measured(path, "x", "y [N/m]", "s")
    np.testing.assert_array_equal(found.y, [7, 8])
    assert found.deviations is not None
    np.testing.assert_array_equal(found.deviations, [0.5, 0.25])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "it is empty"),
        ("# nothing\n\n", "it is empty"),
        ("x [mm],y [N/m]\n", "no points below its headings"),
        ("x [mm]\n1\n", "it needs two columns, and has 1"),
        ("x,y [N/m]\n1,2\n", "'x' cannot be used; a heading has the unit"),
        ("x [mm],y [gold]\n1,2\n", "'gold' cannot be used; 'gold' is not a known unit"),
        ("x [mm],y [N/m]\n1,2\n2\n", r"line 3, y \[N/m\]: '' cannot be used; a number is needed"),
        ("x [mm],y [N/m]\n1,2\n2,three\n", r"line 3, y \[N/m\]: 'three' cannot be used; a number is needed"),
        ("x [mm];y [N/m]\n1;2,5\n", r"line 2, y \[N/m\]: '2,5' .* a point before its decimals"),
        ("x [mm],y [N/m]\n1,2\n2,nan\n", r"line 3, y \[N/m\]: 'nan' cannot be used; it must be finite"),
        ("x [mm],y [N/m]\n1e999,2\n", r"line 2, x \[mm\]: '1e999' cannot be used; it must be finite"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_measured(path)
    assert "\n" not in str(caught.value)


def test_a_missing_file_or_column_is_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none.csv' cannot be used; it does not exist"):
        read_measured(tmp_path / "none.csv")
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match="UTF-8"):
        read_measured(path)
    path.write_text("x [mm],y [N/m],y [N/m],s [N]\n1,2,3,4\n")
    with pytest.raises(InputError, match="no column has this name; the headings are x"):
        read_measured(path, "z")
    with pytest.raises(InputError, match="2 columns have this name"):
        read_measured(path, "x", "y")
    with pytest.raises(InputError, match="must have the unit of"):
        read_measured(path, deviation="s")
    path.write_text("x [mm],y [N/m],s [N/m]\n1,2,0\n")
    with pytest.raises(InputError, match="standard deviations must be positive"):
        read_measured(path, deviation="s")
