"""Newton's method where the coarse mesh lets it converge, and where not."""

from collections.abc import Iterator, Sequence

import numpy as np

from isopeel.paper.document import Block, Picture, Table, Text
from isopeel.paper.figures import NewtonHistory, newton_figure
from isopeel.paper.results import Results
from isopeel.paper.study import Run
from isopeel.paper.wording import ABSENT

TITLE = "Newton's method"
_SPACES = ("L1", "N2", "N4", "N2.1")
_PEELING_DEG = 60.0  # the front moves from here on


def runs(meshes: Sequence[str]) -> list[Run]:
    """Four spaces on the coarsest mesh that is asked for."""
    return [Run(space, meshes[0]) for space in _SPACES]


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """The energy residuals of a step that converges and of one that does not, and how far each run got."""
    shown = runs(meshes)
    yield Text(
        "The measure is the energy residual per unknown, |R . dz|/n, in E0 L0^3 for a width of L0. Where a "
        "coarse mesh makes the moment drop within one step, the path has turned back in the angle (a limit "
        "point), and there is no equilibrium near the last one for plain Newton to find."
    )
    rows = []
    for run in shown:
        record = results.records[run]
        rows.append(
            (
                run.name,
                f"{record.angles_deg[-1]:.1f}",
                ABSENT if record.failed_at_deg is None else f"{record.failed_at_deg:.1f}",
                f"{record.corrections / len(record.angles_deg):.2f}",
                record.reason or "complete",
            )
        )
    yield Table(
        "newton",
        "How far plain Newton comes in steps of 0.1 degree.",
        ("run", "last equilibrium at degrees", "fails at degrees", "corrections per step", "ending"),
        tuple(rows),
    )
    yield Picture(
        "residuals-of-newton",
        "Energy residual of each correction, in the last step that converged and in the one that did not.",
        lambda: newton_figure([h for run in shown for h in _histories(results, run)]),
    )


def _histories(results: Results, run: Run) -> Iterator[NewtonHistory]:
    stored = results.stored(run)
    step = len(stored.curve) - 1
    if stored.failure is None:
        # where nothing failed, the hardest step while the front moves tells the most
        moving = stored.curve.parameter >= _PEELING_DEG
        step = int(np.argmax(np.where(moving, stored.curve.iterations, 0)))
    angle, residuals = stored.curve.parameter[step], stored.curve.residuals_of(step)
    yield NewtonHistory(run.space, float(angle), tuple(residuals.tolist()), converged=True)
    if stored.failure is not None:
        failure = stored.failure
        yield NewtonHistory(run.space, failure.parameter, failure.iterations, converged=False)
