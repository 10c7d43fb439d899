"""The published tables: complete, consistent with each other, and wrong where we list misprints."""

from itertools import pairwise

import pytest

from isopeel import InputError, row_space, strip
from isopeel.paper.published import (
    MISPRINTS,
    Figures,
    Misprint,
    Published,
    published,
    published_relative,
    quoted,
)
from isopeel.post.closed_form import beam_peeling

MESHES = {"m1": (160, 8), "m2": (200, 10), "m3": (240, 12)}
# degree and continuity, by the study's names
SPACES = {
    "L1": (1, 0),
    "L2": (2, 0),
    "L4": (4, 0),
    "N2": (2, 1),
    "N4": (4, 3),
    "N6": (6, 5),
    "N8": (8, 7),
    "N2.1": (3, 1),
    "N4.1": (5, 3),
}
ROWS = [row for mesh in MESHES for row in published(mesh).values()]
READ = [(row, row.figures) for row in ROWS if row.figures]
HALF_DIGIT = 0.5e-4  # Table 2 prints four places


def misprint(table: int, space: str, mesh: str, quantity: str) -> Misprint | None:
    found = [m for m in MISPRINTS if (m.table, m.space, m.mesh, m.quantity) == (table, space, mesh, quantity)]
    assert len(found) <= 1
    return found[0] if found else None


def test_all_rows_are_there() -> None:
    for mesh in MESHES:
        rows = published(mesh)
        assert tuple(rows) == tuple(SPACES)
        assert [name for name, row in rows.items() if row.figures is None] == (
            ["L1", "N2"] if mesh == "m1" else []
        )
        assert all((row.space, row.mesh) == (name, mesh) for name, row in rows.items())
    assert published("m2")["N4.1"].figures == Figures(0.1002, 0.2651, -0.3519)
    assert published_relative()["N2"] == Figures(76.79, 84.98, 64.18)
    assert tuple(published_relative()) == tuple(SPACES)


def test_another_mesh_is_refused() -> None:
    with pytest.raises(InputError, match="m1, m2, m3"):
        published("m4")


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.space}-{row.mesh}")
def test_degrees_of_freedom(row: Published) -> None:
    """By the study's formula and by the space itself; printed alike except in the misprints."""
    (p, c), (nx, ny) = SPACES[row.space], MESHES[row.mesh]
    assert row.dofs_true == 2 * (ny + 1) * ((nx - 1) * (p - c) + p + 1)
    assert row.dofs_true == 2 * row_space(row.space, (nx, ny)).size
    known = misprint(2, row.space, row.mesh, "DOFs")
    assert (row.dofs_printed, row.dofs_true) == (
        (known.printed, known.meant) if known else (row.dofs_true,) * 2
    )
    # every row of control points has the same number of unknowns, whatever the space
    assert (row.dofs_printed % (2 * (ny + 1)) == 0) == (known is None)


def test_quoted_amplitudes() -> None:
    assert [(row.space, row.mesh, row.amplitude) for row in quoted()] == [
        ("Q1N2.1", "m1", 1.011),
        ("Q1N2.1", "m3", 0.1491),
    ]
    for row in quoted():  # the contact row alone is enriched
        assert row.dofs == 2 * row_space(row.space, MESHES[row.mesh]).size


def test_the_claims_that_rest_on_a_misprint() -> None:
    """N8 has fewer unknowns than L2 by 32 % of the printed number, 48 % of the true one on every mesh."""
    saved = {mesh: 1 - published(mesh)["N8"].dofs_true / published(mesh)["L2"].dofs_true for mesh in MESHES}
    assert saved == pytest.approx({"m1": 0.48, "m2": 0.48, "m3": 0.48}, abs=0.005)  # whole percent
    assert 1 - published("m2")["N8"].dofs_true / published("m2")["L2"].dofs_printed == pytest.approx(
        0.32, abs=0.005
    )


def test_table_3_is_table_2_relative_to_its_first_row() -> None:
    """Within the rounding of both, but for the entries that are off by one in the last digit."""
    rows = {name: row.figures for name, row in published("m2").items()}
    base = rows["L1"]
    assert base is not None
    for space, percents in published_relative().items():
        own = rows[space]
        assert own is not None
        for quantity, value, whole, percent in zip(Figures._fields, own, base, percents, strict=True):
            ratio = 100 * value / whole
            rounding = 0.005 + HALF_DIGIT / abs(whole) * (100 + ratio)
            known = misprint(3, space, "m2", quantity)
            assert (abs(percent - ratio) > rounding) == (known is not None)
            if known:
                assert known.printed == percent
                assert known.meant == pytest.approx(ratio, abs=rounding)
                assert abs(known.meant - known.printed) == pytest.approx(0.01)
                assert f"gives {ratio:.4f} +- {rounding - 0.005:.4f}" in known.reason


def test_figures_become_smaller_on_finer_meshes() -> None:
    grown = [
        (coarse.space, coarse.mesh, quantity)
        for mesh, finer in pairwise(MESHES)
        for coarse, fine in zip(published(mesh).values(), published(finer).values(), strict=True)
        if coarse.figures and fine.figures
        for quantity, before, after in zip(Figures._fields, coarse.figures, fine.figures, strict=True)
        if abs(after) >= abs(before)
    ]
    assert grown == [("N4.1", "m1", "fall")]


@pytest.mark.parametrize(("row", "figures"), READ, ids=[f"{row.space}-{row.mesh}" for row, _ in READ])
def test_figures_fit_into_a_period(row: Published, figures: Figures) -> None:
    """In each period, the closed form's, M rises and falls by dM, which takes dM/rise + dM/|fall| or more."""
    closed_form = beam_peeling(strip())
    assert closed_form is not None
    period = closed_form.period_deg(MESHES[row.mesh][0])
    known = misprint(2, row.space, row.mesh, "fall")
    amplitude, rise, fall = figures
    needed = amplitude / rise - amplitude / fall
    if known is None:
        assert needed < 0.8 * period  # on average as steep as 0.4 to 0.8 of the steepest
        return
    assert fall == known.printed
    assert needed > 2.8 * period
    assert amplitude / rise - amplitude / known.meant < period
    assert amplitude / (period - amplitude / rise) > 0.69
