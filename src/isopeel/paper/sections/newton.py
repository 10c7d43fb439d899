"""Newton's method where the coarse mesh lets it converge, and where not."""

from collections.abc import Iterator, Sequence

import numpy as np

from isopeel.paper.figures import NewtonHistory, newton_figure
from isopeel.paper.results import Results
from isopeel.paper.study import Run
from isopeel.report.document import Block, Picture, Table, Text
from isopeel.report.wording import number

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
        "The measure is the energy residual per unknown, |R . dz|/n, in E0 L0^3 for a width of L0. On a "
        "coarse mesh the moment drops within a step or two while the front passes an element. Newton's "
        "method then starts far from the next equilibrium, the more so as it starts from the parabola "
        "through the last three; and beyond a limit point, where the path turns back, there may be no "
        "equilibrium nearby. So the angle where a run ends is one of the mesh, the step and the predictor "
        "together; the last column tells whether the step that failed can be made from the last state alone."
    )
    ended = [record for record in results.records.values() if record.run.base is None and record.ended]
    ended.sort(key=lambda record: record.run.name)
    rows = [
        (
            record.run.name,
            f"{record.reached_deg:.1f}",
            number(record.failed_at_deg, 1),
            f"{record.corrections / max(1, len(record.angles_deg)):.2f}",
            record.reason or "complete",
            {True: "yes", False: "no", None: ""}[record.goes_on],
        )
        for record in (*(results.records[run] for run in shown), *ended)
    ]
    yield Table(
        "newton",
        "How far plain Newton comes in steps of 0.1 degree: the four runs that are drawn, and all that end "
        "early.",
        (
            "run",
            "last equilibrium / degree",
            "fails at / degree",
            "corrections per step",
            "ending",
            "from the last state alone",
        ),
        tuple(dict.fromkeys(rows)),
    )
    yield Picture(
        "residuals-of-newton",
        "Energy residual of each correction: the last step that converged and the one that did not, or the "
        "hardest step while the front moves, where all converged.",
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
