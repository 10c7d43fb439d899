"""Bodies whose bending or volume response locks: right by default, and told where they are not."""

import pytest

from isopeel.case import Case
from isopeel.post.closed_form import expected
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.trace import trace


def rubber(poissons_ratio: float, discretization: str = 'mesh = "180x2"') -> Case:
    """A strip of rubber (Kendall) that is peeled by a moment."""
    return Case.parse(f"""\
name = "rubber-strip"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "60 mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = {poissons_ratio}
[adhesion]
law = "exponential"
strength = "0.01 MPa"
work_of_adhesion = "0.0005 N/mm"
length = "50 mm"
[discretization]
{discretization}
[drive]
kind = "rotation"
to = "60 deg"
step = "1 deg"
""")


def plateau(case: Case) -> float:
    """Mean moment in the last 10 degrees over that of beam theory."""
    (stage,) = case.stages()
    steps = list(trace(stage.problem, case.space(), stage.parameters, NewtonSettings(control="auto")))
    theory = expected(stage.problem, case.space())
    assert theory is not None
    last = [step.reaction for step in steps if step.parameter > stage.parameters[-11]]
    return sum(last) / len(last) / theory.reaction


# beam theory is right within 0.3 %: the strip's radius is 45 heights
@pytest.mark.parametrize("poissons_ratio", [0.3, 0.45, 0.49, 0.499])
def test_a_strip_bends_rightly_by_default_whatever_its_poissons_ratio(poissons_ratio: float) -> None:
    assert plateau(rubber(poissons_ratio)) == pytest.approx(1, abs=0.01)
