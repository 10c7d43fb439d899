"""Notes on the stability of a run: where it was lost, and which states are unstable."""

import numpy as np

from isopeel.post.laboratory import Laboratory
from isopeel.results.curve import Curve
from isopeel.results.notes import Note
from isopeel.solve.step import KINDS


def stability_notes(curve: Curve, laboratory: Laboratory) -> list[Note]:
    """Return a note for each bifurcation that a path passed, and one for all its unstable states."""

    def shown(value: float) -> str:
        return laboratory.parameter(curve.parameter_column, value)

    notes = []
    bifurcations = np.flatnonzero(curve.kind == KINDS.index("bifurcation"))
    for k in bifurcations:
        at = float(curve.parameter[k])
        text = (
            f"stability is lost at {shown(at)}, a bifurcation: the path changes to the stable branch;"
            " path_control = continuation follows the unstable branch"
        )
        late = 0
        # a path that detects the loss of stability late returns to the bifurcation
        while k - late > 1 and (at - curve.parameter[k - 1 - late]) * (at - curve.parameter[0]) < 0:
            late += 1
        if late:
            text += f"; the {late} steps before it, to {shown(float(curve.parameter[k - 1]))}, are unstable"
        notes.append(Note("stability" if late else "bifurcation", text))
    unstable = np.flatnonzero((curve.negative_eigenvalues > 0) & (curve.kind != KINDS.index("limit point")))
    if len(unstable):
        ends = curve.parameter[unstable]
        notes.append(
            Note(
                "stability",
                f"{len(unstable)} steps between {shown(float(ends.min()))} and {shown(float(ends.max()))} are"
                " unstable equilibria, which a real body leaves at the smallest disturbance; path_control ="
                " auto leaves them too",
            )
        )
    return notes
