"""What was computed and how, and what the report refers to."""

from collections.abc import Iterator

from isopeel.paper.reading import WINDOW, Reading
from isopeel.paper.study import STEP, Run
from isopeel.paper.wording import UNIT
from isopeel.report.document import Block, Text
from isopeel.solve.extrapolation import MOST_STATES
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import PARABOLA_POINTS

TITLE = "What was computed"
REFERENCES_TITLE = "References"

ABSTRACT = (
    "A study in Sadhana 46:3 (2021) turns a strip of 200 nm x 10 nm off a flat surface that holds it by van "
    "der Waals forces, with nine discretizations on three meshes, and compares by how much the moment "
    "oscillates. Here are the same runs, its tables with ours beside them, what the enriched contact "
    "elements of the literature give, and what the published figures depend on. In short: L1 and the smooth "
    "spaces N2 to N8 are reproduced. The published figures of L2, L4, N2.1 and N4.1 are not those of spaces "
    "elevated in all rows of control points, which oscillate far less; they are consistent with an elevation "
    "in the row at the contact only."
)
REFERENCES = """\
- Sadhana 46:3 (2021): the study, by Agrawal and Gautam.
- Sauer, Int. J. Numer. Methods Eng. 87 (2011): enriched contact elements, and the strip.
- Corbett and Sauer, Comput. Methods Appl. Mech. Eng. 275 (2014): NURBS-enriched contact elements.
- Maleki-Jebeli et al. (2018): hybrid of isogeometric and finite elements.
- Agrawal and Gautam (2020): varying-order NURBS."""


def blocks() -> Iterator[Block]:
    """Yield the model, the method, and how the figures are read."""
    case = Run("L1", "m2").case
    problem = case.problem()
    settings = NewtonSettings()
    stiffness, law = case.material, case.adhesion
    yield Text(
        f"A strip of {case.body.length:g} nm x {case.body.height:g} nm in plane strain, compressible "
        f"neo-Hooke, is held by a flat rigid substrate on its lower face up to {law.length:g} nm, by van der "
        "Waals forces. The left face keeps u_x = 0; the right one stays straight and is turned about its own "
        "centre, which is free, so that the only reaction is a moment. In units of E0 = 2 GPa and L0 = 1 nm "
        f"the material has {_constants(stiffness)}, the adhesion {_constants(law)}; at the start the lower "
        f"face is at the equilibrium gap of {problem.adhesion.law.equilibrium_gap:.5f}. The adhesive force "
        "acts per reference area, unless a table says otherwise."
    )
    yield Text(
        f"Steps are of {STEP:g} degree, each started from the polynomial through up to {MOST_STATES} "
        "states, in the angle or in the adhesive energy, or from what the front did on the element before, "
        "whichever did best in the last steps. A tangent is "
        "kept for many of them, and updated from the residuals (BFGS). Where that does not converge well, "
        "plain Newton's method decides: it starts from the parabola through the last "
        f"{PARABOLA_POINTS} states, has no line search, and ends when |R . dz|/n is below "
        f"{settings.tolerance:g} E A, A the strip's area, or after {settings.iteration_limit} corrections. "
        "Forces have one more Gauss point than the highest degree along the strip, and two across it."
    )
    yield Text(
        "dM is the height of the oscillation of the moment on its plateau, peak to peak, and the slopes are "
        "the steepest difference quotients from one step to the next, per degree; tables show them times "
        f"1e3, in {UNIT}. Unless a table says otherwise they are read between {WINDOW[0]:g} and "
        f"{WINDOW[1]:g} degrees, with the {Reading.MEAN.value}: a parabola fitted to the running mean over "
        "the passage of one element. The published window and definition are not told. A run that finds no "
        "equilibrium ends there, and that is its result."
    )


def _constants(section: object) -> str:
    """Return the numbers of a section of a case, by the names of their keys."""
    found = {
        name: value for name, value in vars(section).items() if isinstance(value, float) and name != "length"
    }
    return ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in found.items())
