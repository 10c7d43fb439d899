"""The model and the method of the runs, and the references of the report."""

from collections.abc import Iterator

from isopeel.case import OneBody
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
    "In a study in Sadhana 46:3 (2021), a moment peels a strip of 200 nm x 10 nm off a flat surface to which "
    "it adheres by van der Waals forces. The study compares the oscillation of the moment for nine "
    "discretizations on three meshes. This report repeats its runs, and compares our tables with the "
    "published ones. It adds the enriched contact elements of the literature, and examines what the "
    "published values depend on. In short: the values of L1 and of the smooth spaces N2 to N8 are "
    "reproduced. The published values of L2, L4, N2.1 and N4.1 are not those of spaces that are elevated in "
    "all rows of control points, because such spaces oscillate far less. They are consistent with an "
    "elevation in the contact row only."
)
REFERENCES = """\
- Sadhana 46:3 (2021): the study, by Agrawal and Gautam.
- Sauer, Int. J. Numer. Methods Eng. 87 (2011): enriched contact elements, and the strip.
- Corbett and Sauer, Comput. Methods Appl. Mech. Eng. 275 (2014): NURBS-enriched contact elements.
- Maleki-Jebeli et al. (2018): hybrid of isogeometric and finite elements.
- Agrawal and Gautam (2020): varying-order NURBS."""


def blocks() -> Iterator[Block]:
    """Yield the model, the method, and the definition of the values."""
    case = Run("L1", "m2").case
    problem = case.problem()
    settings = NewtonSettings()
    assert isinstance(case, OneBody)
    stiffness, law = case.material, case.adhesion
    yield Text(
        f"The body is a strip of {case.body.length:g} nm x {case.body.height:g} nm in plane strain. Its "
        f"material is compressible neo-Hooke. The lower face adheres from its left end to {law.length:g} nm "
        "to a flat rigid substrate, by van der Waals forces. The left face has u_x = 0. The right face "
        "remains straight and is rotated about its own centre. The centre is free, so that the only reaction "
        f"is a moment. In units of E0 = 2 GPa and L0 = 1 nm the material has {_constants(stiffness)}; the "
        f"adhesion has {_constants(law)}. At the start the lower face is at the equilibrium gap of "
        f"{problem.adhesion.law.equilibrium_gap:.5f}. The adhesive force acts per reference area, unless a "
        "table states the projected area."
    )
    yield Text(
        f"The step is {STEP:g} degree. Each step starts from a prediction: a polynomial through up to "
        f"{MOST_STATES} states, in the angle or in the adhesive energy, or the state of the front one "
        "element earlier, translated by one element. The predictor with the smallest errors in the last "
        "steps is selected. A chord tangent (modified Newton) serves many steps, with L-BFGS updates from "
        "the residuals. If this does not converge well, plain Newton's method is used. It starts from the "
        f"parabola through the last {PARABOLA_POINTS} states and has no line search. It ends when |R . dz|/n "
        f"is below {settings.tolerance:g} E A, where A is the area of the strip, or after "
        f"{settings.iteration_limit} corrections. The number of Gauss points of the forces is the highest "
        "degree plus one along the strip, and two across it."
    )
    yield Text(
        "dM is the peak-to-peak amplitude of the oscillation of the moment on its plateau. The slopes are "
        "the steepest difference quotients from one step to the next, per degree. Tables have both "
        f"multiplied by 1e3, in {UNIT}. Unless a table states another window, they are read between "
        f"{WINDOW[0]:g} and {WINDOW[1]:g} degrees, with the {Reading.MEAN.value}: a parabola is fitted to "
        "the running mean over one period, in which the front passes one element, and subtracted. The study "
        "does not state its window and its definition. A run that finds no equilibrium ends there; its last "
        "angle is then its result."
    )


def _constants(section: object) -> str:
    """Return the numbers of a section of a case, by the names of their keys."""
    found = {
        name: value for name, value in vars(section).items() if isinstance(value, float) and name != "length"
    }
    return ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in found.items())
