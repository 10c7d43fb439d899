"""Newton's method on coarse and fine meshes: the angles up to which it converges."""

from collections.abc import Iterator, Sequence

import numpy as np

from isopeel.paper.figures import NewtonHistory, newton_figure
from isopeel.paper.results import Results
from isopeel.paper.study import Run
from isopeel.report.document import Block, Picture, Table, Text
from isopeel.report.wording import number
from isopeel.solve.step import PARABOLA_POINTS

TITLE = "Newton's method"
#: The spaces whose runs end early on one of the meshes, and one whose runs do not.
_SPACES = ("L1", "N2", "N4", "N2.1")


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return the runs of four spaces by plain Newton's method."""
    return [Run(space, mesh, plain=True) for mesh in meshes for space in _SPACES]


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield how far plain Newton's method converges, and energy residuals of steps that converge or not."""
    shown = [run for run in runs(meshes) if run in results.records]
    yield Text(
        "The published study computes a new tangent for every correction. The runs of this section do the "
        f"same, from {runs(meshes)[0].range_deg[0]:g} degrees on. The convergence measure is the energy "
        "residual per unknown, |R . dz|/n, in E0 L0^3 for a width of L0. On a coarse mesh the moment drops "
        "within one or two steps while the front passes an element. Then Newton's method starts far from the "
        "next equilibrium, because the parabola through the last three states does not predict the drop. "
        "Beyond a limit point, where the path turns back, there may be no equilibrium nearby. So the angle "
        "at which a run ends depends on the mesh, the step and the predictor together. If a step ends near "
        "a jump, this angle also depends on round-off. One column shows whether the failed step converges if "
        "it starts from the last state. The last column shows where the runs of the other sections end: "
        "they extrapolate more states and use chord tangents."
    )
    yield Table(
        "newton",
        "The last equilibrium that plain Newton's method finds in steps of 0.1 degree.",
        (
            "run",
            "last equilibrium / degree",
            "fails at / degree",
            "corrections per step",
            "ending",
            "from the last state alone",
            "by chord tangents fails at / degree",
        ),
        tuple(_row(results, run) for run in shown),
    )
    drawn = [run for run in shown if run.mesh == meshes[0]]
    yield Picture(
        "residuals-of-newton",
        f"Energy residual of each correction on {meshes[0]}: the last step that converged, and the step that "
        "did not converge. If all steps converged: the step with the most corrections.",
        lambda: newton_figure([history for run in drawn for history in _histories(results, run)]),
    )


def _row(results: Results, run: Run) -> tuple[str, ...]:
    assert run.base is not None
    record, base = results.records[run], results.records[run.base]
    return (
        run.base.name,
        f"{record.reached_deg:.1f}",
        number(record.failed_at_deg, 1),
        f"{record.corrections / max(1, len(record.angles_deg)):.2f}",
        record.reason or "complete",
        {True: "yes", False: "no", None: ""}[record.continues],
        number(base.failed_at_deg, 1),
    )


def _histories(results: Results, run: Run) -> Iterator[NewtonHistory]:
    stored = results.stored(run)
    step = len(stored.curve) - 1
    if stored.failure is None:
        # if no step failed: the step with the most corrections, once there are three states for a parabola
        step = PARABOLA_POINTS + int(np.argmax(stored.curve.iterations[PARABOLA_POINTS:]))
    angle, residuals = stored.curve.parameter[step], stored.curve.residuals_of(step)
    yield NewtonHistory(run.space, float(angle), tuple(residuals.tolist()), converged=True)
    if stored.failure is not None:
        failure = stored.failure
        yield NewtonHistory(run.space, failure.parameter, failure.iterations, converged=False)
