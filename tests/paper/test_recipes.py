"""Ways to read a curve, and how they fit the published table."""

import numpy as np
import pytest

from isopeel.common.arrays import FloatArray
from isopeel.paper.published import published
from isopeel.paper.reading import (
    WINDOW,
    Points,
    Readable,
    Reading,
    Recipe,
    Rows,
    candidate_windows,
    fits,
    period_deg,
    plateau_mean,
)
from isopeel.paper.record import Record
from isopeel.paper.study import SPACES, Run

RUN = Run("L1", "m2")
ANGLES = np.round(np.arange(0, 1121) * 0.1, 10)


def record(moments: FloatArray, run: Run = RUN) -> Record:
    angles = ANGLES[: len(moments)]
    return Record(run, angles, moments, 100, 2000, 10.0, 0.01, 2.0, None, "", "", "", "", "", None, None)


def waving(amplitude: float, drift: float = 0.0) -> FloatArray:
    """A sine of the period of m2 on a drifting plateau."""
    phase = 2 * np.pi * ANGLES / period_deg("m2")
    wave: FloatArray = 1.63 + drift * (ANGLES - 98) + amplitude / 2 * np.sin(phase)
    return wave


def test_periods_are_those_of_the_closed_form() -> None:
    # an element of length l turns a beam of radius 53.2 nm by l/R; published for m2: 1.077 degrees
    assert period_deg("m2") == pytest.approx(1.077, abs=5e-4)
    assert period_deg("m1") / period_deg("m3") == pytest.approx(1.5, rel=1e-14)


def test_readings_differ_by_the_drift() -> None:
    drift, amplitude = 3e-4, 2e-3
    figures = {how: Readable(record(waving(amplitude, drift))).read(WINDOW, how) for how in Reading}
    still = Readable(record(waving(amplitude))).read(WINDOW)
    assert still is not None
    # a sine is sampled every tenth degree, of which there are eleven in its period: 2 % of its height
    assert still.amplitude == pytest.approx(1e3 * amplitude, rel=0.02)
    assert still.rise == pytest.approx(-still.fall, rel=0.02)
    mean, line, raw = figures[Reading.MEAN], figures[Reading.LINE], figures[Reading.RAW]
    assert mean is not None
    assert line is not None
    assert raw is not None
    # the running mean sees the drift but for the spline's own error
    assert mean == pytest.approx(still, abs=1e-3)
    for figure in (line, raw):
        # what parabola the spline sees in a curve without one
        assert figure.rise == pytest.approx(still.rise + 1e3 * drift, abs=1e-4)
        assert figure.fall == pytest.approx(still.fall + 1e3 * drift, abs=1e-4)
    # over the window the drift adds its own rise, but for what the sine's ends hide
    assert raw.amplitude > still.amplitude + 1e3 * drift * 2


def test_what_a_run_does_not_cover_is_not_read() -> None:
    reached = record(waving(1e-3)[:1015])  # to 101.4 degrees: the mean needs half a period more
    assert Readable(reached).read(WINDOW) is None
    assert Readable(record(waving(1e-3)[:1020])).read(WINDOW) is not None
    assert plateau_mean(reached) == pytest.approx(1.63, abs=1e-4)  # part of a period is left over
    assert plateau_mean(record(waving(1e-3)[:900])) is None
    assert Readable(record(np.empty(0))).read(WINDOW) is None


def test_rows_and_points_name_runs() -> None:
    assert [Rows.CONTACT.enriched(space) for space in ("L1", "L4", "N8")] == ["L1", "L1+L4", "L1+N8"]
    elevated = [Rows.ELEVATED.enriched(space) for space in SPACES]
    assert elevated == ["L1", "L1+L2", "L1+L4", "N2", "N4", "N6", "N8", "N2+N2.1", "N4+N4.1"]
    counts = {points: points.count("L1+N4") for points in Points}
    assert counts == {
        Points.DEFAULT: None,
        Points.MORE: 6,
        Points.LESS: 4,
        Points.TWO: 2,
        Points.THREE: 3,
    }
    assert Points.LESS.count("L1") is None  # there are no fewer than 2
    recipe = Recipe(Rows.CONTACT, traction="projected", points=Points.THREE)
    assert recipe.run("N4", "m2") == Run("L1+N4", "m2", "projected", 3)


def test_the_true_recipe_fits_best() -> None:
    """Curves whose contact rows have the published amplitudes, all rows ten times smaller ones."""
    theirs = {space: row.figures for space, row in published("m2").items()}
    readables = {}
    for space, figures in theirs.items():
        assert figures is not None
        size = figures.amplitude / 1e3
        contact = Run(Rows.CONTACT.enriched(space), "m2")
        readables[Run(space, "m2")] = Readable(record(waving(size / 10), Run(space, "m2")))
        readables[contact] = Readable(record(waving(size), contact))
    recipes = [Recipe(rows, reading) for rows in Rows for reading in Reading]
    best, *others = fits(readables, ["m2"], recipes)
    assert best.recipe.rows is Rows.CONTACT
    assert best.unread == 0
    assert len(best.ratios) == 27
    assert best.ratios["m2", "L4", "amplitude"] == pytest.approx(1, abs=0.02)  # the sampled sine
    assert all(best.deviation <= other.deviation for other in others)


def test_misprints_and_missing_runs_do_not_count() -> None:
    readables = {Run("N4.1", "m1"): Readable(record(waving(1e-3), Run("N4.1", "m1")))}
    (fit,) = fits(readables, ["m1"], [Recipe(Rows.ALL)])
    # seven rows converge in print, of 3 entries each, and one entry is a misprint
    assert (len(fit.ratios), fit.unread) == (2, 18)
    assert ("m1", "N4.1", "fall") not in fit.ratios


def test_windows_begin_between_85_and_107() -> None:
    windows = candidate_windows([3.4, 1.0])
    assert len(windows) == 2 * 45
    assert min(windows) == (85.0, 86.0)
    assert max(windows) == (107.0, 107.0 + 3.4)
