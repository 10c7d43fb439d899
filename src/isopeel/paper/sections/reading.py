"""How the values depend on what the study does not state: the window, the force, its Gauss points."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from matplotlib.figure import Figure

from isopeel.paper.figures import quadrature_figure, windows_figure
from isopeel.paper.published import published
from isopeel.paper.reading import (
    WINDOW,
    Fit,
    Points,
    Reading,
    Recipe,
    Rows,
    candidate_windows,
    fits,
    period_deg,
)
from isopeel.paper.results import Results
from isopeel.paper.study import (
    SPACES,
    VARIANT_MESH,
    VARIED_SPACES,
    Run,
    contact_row_runs,
    default_points,
    quadrature_runs,
    table_runs,
    traction_runs,
)
from isopeel.paper.wording import deviations, endings, triple
from isopeel.report.document import Block, Picture, Table, Text
from isopeel.report.wording import ABSENT, digits, listed

TITLE = "What the values depend on"
_LENGTH = WINDOW[1] - WINDOW[0]
#: Entries with a larger relative deviation are listed one by one.
_FAR = 0.2


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return the runs of Table 2, and their variants on one mesh."""
    variants = [*traction_runs(), *quadrature_runs()] if VARIANT_MESH in meshes else []
    return [*table_runs(meshes), *contact_row_runs(meshes), *variants]


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield the effects of window, force and points, then the closest recipe and its residuals."""
    if VARIANT_MESH in meshes:
        yield from _window(results)
        yield from _traction(results)
        yield from _quadrature(results)
        yield _variants(results)
    yield from _recipes(results, meshes)


def _window(results: Results) -> Iterator[Block]:
    starts = np.array([window[0] for window in candidate_windows([_LENGTH])])

    def amplitudes(run: Run) -> list[float]:
        read = (results.figures(run, (start, start + _LENGTH)) for start in starts.tolist())
        return [np.nan if figures is None else figures.amplitude for figures in read]

    read = {space: np.array(amplitudes(Run(space, VARIANT_MESH))) for space in VARIED_SPACES}
    theirs = {
        space: row.figures.amplitude / 1e3 for space, row in published(VARIANT_MESH).items() if row.figures
    }
    yield Table(
        "windows",
        f"dM, times 1e3, in windows of {_LENGTH:.1f} degrees that begin at {starts[0]:g} to {starts[-1]:g} "
        f"degrees; {VARIANT_MESH}.",
        ("space", "smallest", f"from {WINDOW[0]:g}", "largest", "largest / smallest"),
        tuple(
            (
                space,
                digits(float(np.nanmin(values))),
                digits(_amplitude(results, Run(space, VARIANT_MESH))),
                digits(float(np.nanmax(values))),
                f"{np.nanmax(values) / np.nanmin(values):.2f}",
            )
            for space, values in read.items()
        ),
    )
    yield Picture(
        "windows-figure",
        f"Amplitude dM over the start of a window of {_LENGTH:.1f} degrees on the plateau, {VARIANT_MESH}.",
        lambda: windows_figure(
            starts, {space: values / 1e3 for space, values in read.items()}, WINDOW, theirs
        ),
    )


def _traction(results: Results) -> Iterator[Block]:
    yield Text(
        "The contact force of the study, Eq. (19), has the factor n . F^-T N, so it is a force on the "
        "projected area. But the tangent of the study, Eq. (27), is that of a force on the reference area. "
        "All other sections use the force on the reference area."
    )
    rows = []
    for space in VARIED_SPACES:
        run = Run(space, VARIANT_MESH)
        reference, projected = (results.figures(shown) for shown in (run, replace(run, traction="projected")))
        rows.append((space, triple(reference), triple(projected), deviations(projected, reference)))
    yield Table(
        "traction",
        "The force on the reference area and on the projected one: dM / rise / fall, times 1e3, "
        f"{VARIANT_MESH}.",
        ("space", "reference", "projected", "projected less reference"),
        tuple(rows),
        endings(results.records[run] for run in traction_runs() if run in results.records),
    )


def _quadrature(results: Results) -> Iterator[Block]:
    spaces = VARIED_SPACES
    found: dict[str, dict[int, float]] = {}
    for space in spaces:
        default = default_points(space)
        for points in range(2, default + 2):
            run = Run(space, VARIANT_MESH, contact_points=None if points == default else points)
            amplitude = results.amplitude(run)
            if amplitude is not None:
                found.setdefault(space, {})[points] = amplitude
    most = max(default_points(space) for space in spaces) + 1
    yield Table(
        "quadrature",
        "dM, times 1e3, over the number of Gauss points of the force on an element; the number p + 1 is in "
        f"brackets; {VARIANT_MESH}.",
        ("space", *(f"{points}" for points in range(2, most + 1))),
        tuple(
            (
                space,
                *(
                    _points_cell(found.get(space, {}), points, default_points(space))
                    for points in range(2, most + 1)
                ),
            )
            for space in spaces
        ),
        endings(results.records[run] for run in quadrature_runs() if run in results.records),
    )

    def draw() -> Figure:
        shown = {space: amplitudes for space, amplitudes in found.items() if space in SPACES}
        return quadrature_figure(shown, {space: default_points(space) for space in shown})

    yield Picture(
        "quadrature-figure",
        f"Amplitude dM over the Gauss points of the force, {VARIANT_MESH}, all rows.",
        draw,
    )


def _points_cell(amplitudes: dict[int, float], points: int, default: int) -> str:
    value = amplitudes.get(points)
    if value is None:
        return ABSENT if points <= default + 1 else ""
    return f"({digits(1e3 * value, 3)})" if points == default else digits(1e3 * value, 3)


def _variants(results: Results) -> Table:
    """Return the deviation of each variant of the force in the default window."""
    columns = {"projected": Recipe(Rows.ALL, traction="projected")}
    columns |= {f"{points.value} points": Recipe(Rows.ALL, points=points) for points in Points}
    recipes = [replace(recipe, rows=enriched) for recipe in columns.values() for enriched in Rows]
    found = {fit.recipe: fit for fit in fits(results.readables, [VARIANT_MESH], recipes)}
    rows = []
    for enriched in Rows:
        fitted = (found.get(replace(recipe, rows=enriched)) for recipe in columns.values())
        rows.append((enriched.value, *(ABSENT if fit is None else _deviation(fit) for fit in fitted)))
    return Table(
        "variants",
        f"Deviation of our values from the published ones on {VARIANT_MESH}: mean of "
        f"|ln(ours/published)|, window {WINDOW[0]:g} to {WINDOW[1]:g} degrees.",
        ("enriched", *columns),
        tuple(rows),
    )


def _recipes(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    longest = max(period_deg(mesh) for mesh in meshes)  # a shorter window would miss part of an oscillation
    lengths = sorted({_LENGTH, longest, 2 * longest})
    recipes = [Recipe(*choice) for choice in product(Rows, Reading, candidate_windows(lengths))]
    found = fits(results.readables, meshes, recipes)
    best: dict[tuple[Rows, Reading], Fit] = {}
    for fit in found:
        best.setdefault((fit.recipe.rows, fit.recipe.reading), fit)
    usual = {
        f.recipe: f for f in fits(results.readables, meshes, [Recipe(*c) for c in product(Rows, Reading)])
    }
    rows = []
    for (enriched, reading), fit in best.items():
        start, end = fit.recipe.window
        default = usual[Recipe(enriched, reading)]
        rows.append(
            (
                enriched.value,
                reading.value,
                f"{start:.1f} to {end:.2f}",
                _deviation(fit),
                f"{fit.unread}",
                _deviation(default),
            )
        )
    chosen = found[0]
    yield Text(
        "A *recipe* is a choice of the enriched rows, the treatment of the drift, and the window. "
        f"Each of {len(recipes)} recipes is compared with {len(chosen.ratios) + chosen.unread} published "
        f"entries on {listed(list(meshes))}, without the misprints. {{recipes}} shows the closest recipe of "
        "each kind, and {residuals} all entries of the closest recipe."
    )
    yield Table(
        "recipes",
        "The closest recipe of each kind: mean of |ln(ours/published)|.",
        (
            "enriched",
            "drift",
            "window / degree",
            "deviation",
            "entries not comparable",
            f"in {WINDOW[0]:g} to {WINDOW[1]:g}",
        ),
        tuple(rows),
    )
    yield _residuals(chosen, meshes)
    yield Text(_unexplained(chosen))


def _residuals(fit: Fit, meshes: Sequence[str]) -> Table:
    rows = []
    for space in SPACES:
        cells = []
        for mesh in meshes:
            ratios = [fit.ratios.get((mesh, space, name)) for name in ("amplitude", "rise", "fall")]
            known = published(mesh)[space].figures is not None
            cells.append(
                " / ".join(ABSENT if r is None else f"{100 * (r - 1):+.0f}" for r in ratios) if known else ""
            )
        rows.append((f"{fit.recipe.rows.enriched(space)} for {space}", *cells))
    start, end = fit.recipe.window
    return Table(
        "residuals",
        "Deviations of our dM / rise / fall from the published ones in percent, by the closest recipe: "
        f"{fit.recipe.rows.value}; {fit.recipe.reading.value}; {start:.1f} to {end:.2f} degrees.",
        ("space", *meshes),
        tuple(rows),
        ("Empty cell: not converging in the study. Dash: a misprint, or not comparable.",),
    )


def _unexplained(fit: Fit) -> str:
    """Return a list of the entries whose deviation exceeds _FAR."""
    far: dict[str, list[str]] = {}
    for (mesh, space, name), ratio in fit.ratios.items():
        if abs(ratio - 1) > _FAR:
            far.setdefault(space, []).append(f"{name} on {mesh} ({100 * (ratio - 1):+.0f} %)")
    if not far:
        return f"No entry deviates by more than {100 * _FAR:.0f} %."
    items = "\n".join(f"- {space}: {listed(entries)}" for space, entries in far.items())
    return f"These entries deviate by more than {100 * _FAR:.0f} %; no recipe above explains them:\n\n{items}"


def _deviation(fit: Fit) -> str:
    return f"{fit.deviation:.3f}" + (f" ({fit.unread} not comparable)" if fit.unread else "")


def _amplitude(results: Results, run: Run) -> float | None:
    amplitude = results.amplitude(run)
    return None if amplitude is None else 1e3 * amplitude
