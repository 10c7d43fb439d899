"""Bodies whose bending or volume response locks: right by default, with a note where they are not."""

import pytest
from summaries import result_of

from isopeel.case import Case, load_case, shipped_cases
from isopeel.common.units import UnitSystem
from isopeel.post.closed_form import expected
from isopeel.post.front import front_profile
from isopeel.post.laboratory import Laboratory
from isopeel.post.locking import _block_stiffness, bending, locking_notes
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space


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
    steps = list(trace(stage.problem, case.space(), stage.parameters, NewtonSettings(path_control="auto")))
    theory = expected(stage.problem, case.space())
    assert theory is not None
    last = [step.reaction for step in steps if step.parameter > stage.parameters[-11]]
    return sum(last) / len(last) / theory.reaction


# beam theory is right within 0.3 %: the strip's radius is 15 heights
@pytest.mark.parametrize("poissons_ratio", [0.3, 0.45, 0.49, 0.499])
def test_a_strip_bends_rightly_by_default_whatever_its_poissons_ratio(poissons_ratio: float) -> None:
    assert plateau(rubber(poissons_ratio)) == pytest.approx(1, abs=0.01)


TAPE = """\
name = "petf"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
shape = "strip"
length = "6 mm"
height = "25 um"
[material]
law = "neo-hooke"
youngs_modulus = "4 GPa"
poissons_ratio = 0.4
[adhesion]
law = "formula"
potential = "-W*exp(-(r/d)**2)"
constants = { W = "50 J/m^2", d = "40 um" }
length = "5 mm"
[discretization]
space = "N2.1"
mesh = "240x2"
ACROSS
[drive]
kind = "force"
side = "right"
angle = "90 deg"
to = "0.2 mm"
step = "20 um"
"""


def message(case: Case) -> str:
    laboratory = Laboratory.of(UnitSystem(), case.problem())
    return " ".join(note.text for note in locking_notes(case.problem(), case.spaces(), laboratory))


@pytest.mark.parametrize(
    ("case", "means"),
    [
        (rubber(0.499, 'mesh = "180x2"\nacross_degree = 1'), "across_degree = 2"),
        (rubber(0.3, 'mesh = "180x2"\nacross_degree = 1'), "across_degree = 2"),
        (rubber(0.3, 'mesh = "90x2"\nspace = "L1"'), "space N2.1"),
        (rubber(0.0, 'mesh = "40x1"\nspace = "L1"\nacross_degree = 1'), "space N2.1"),
        (rubber(0.4999, 'mesh = "180x2"\nacross_degree = 2'), "across_degree = 3"),
        (Case.parse(TAPE.replace("ACROSS", "across_degree = 1")), "across_degree = 2"),
    ],
    ids=["given", "linear across", "linear along", "thin and long", "nearly incompressible", "given tape"],
)
def test_a_locking_discretization_gets_a_note_with_a_better_one(case: Case, means: str) -> None:
    assert f"{means} is sufficient" in message(case) or f"; {means} with" in message(case)


@pytest.mark.parametrize("poissons_ratio", [0.0, 0.3, 0.45, 0.49, 0.499, 0.4999])
def test_defaults_do_not_lock(poissons_ratio: float) -> None:
    assert not message(rubber(poissons_ratio))
    assert not message(Case.parse(TAPE.replace("ACROSS", "").replace("0.4\n", f"{poissons_ratio}\n")))


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_do_not_lock(name: str) -> None:
    assert not message(load_case(name))


def test_elements_that_are_linear_across_are_too_stiff_by_a_closed_form() -> None:
    """One cannot lift by squares of the height: (1 - nu)^2/(1 - 2 nu) times E'I, in excess by 1/n^2 of n."""
    for nu in (0.0, 0.2, 0.45, 0.49):
        for elements in (1, 2, 5):
            case = rubber(nu, f'mesh = "180x{elements}"\nacross_degree = 1')
            found = bending(case.problem(), case.space())
            assert found is not None
            excess = (1 - nu) ** 2 / (1 - 2 * nu) - 1
            # of moments about the middles of the elements, all but their own are exact
            assert found.excess == pytest.approx(excess / elements**2, abs=1e-9)


def test_bilinear_elements_are_too_stiff_by_a_closed_form() -> None:
    """Shear that bending does not have, (l/h)^2 (1 - nu)/2 of E'I (with what is linear across exact)."""
    case = rubber(0.3, 'mesh = "120x3"\nspace = "L1"')
    found = bending(case.problem(), case.space())
    assert found is not None
    assert found.linear == pytest.approx(0.5**2 * (1 - 0.3) / 2, rel=0.01)


@pytest.mark.parametrize(
    "discretization",
    [
        'space = "L1"\nmesh = "180x2"',
        'mesh = "180x4"\nacross_degree = 1',
        'mesh = "180x1"\nacross_degree = 2',
    ],
)
def test_the_estimate_is_the_error_of_the_plateau(discretization: str) -> None:
    case = rubber(0.499 if "180x1" in discretization else 0.3, discretization)
    found = bending(case.problem(), case.space())
    assert found is not None
    assert plateau(case) - 1 == pytest.approx((1 + found.excess) ** 0.5 - 1, abs=0.003)


PAD = """\
name = "pad"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "{length} mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = {ratio}
[adhesion]
law = "exponential"
strength = "1 MPa"
work_of_adhesion = "0.5 N/mm"
sliding_length = "0.1 mm"
[discretization]
{discretization}
[drive]
kind = "displacement"
side = "top"
angle = "90 deg"
transverse = "held"
to = "0.1 mm"
step = "0.01 mm"
"""


@pytest.mark.parametrize("length", [1, 4])
@pytest.mark.parametrize(
    "discretization",
    [
        'mesh = "40x2"\nacross_degree = 2',
        'mesh = "40x4"\nacross_degree = 2',
        'mesh = "40x4"\nspace = "L1"\nacross_degree = 1',
        'mesh = "160x16"\nspace = "L1"\nacross_degree = 1',
    ],
)
def test_a_confined_incompressible_pad_gets_a_note(length: int, discretization: str) -> None:
    case = Case.parse(PAD.format(length=length, ratio=0.4999, discretization=discretization))
    assert "volume: the body, whose Poisson's ratio is 0.4999, is at least" in message(case)
    # the same block of a compressible material does not lock
    assert not message(Case.parse(PAD.format(length=length, ratio=0.3, discretization=discretization)))


@pytest.mark.parametrize("ratio", [0.49, 0.4999])
@pytest.mark.parametrize("length", [1, 4, 16])
def test_a_confined_pad_is_right_by_default(length: int, ratio: float) -> None:
    """Within 2 % of stiffness, against more elements and a higher degree."""
    case = Case.parse(PAD.format(length=length, ratio=ratio, discretization=""))
    assert not message(case)
    fine = _block_stiffness(row_space("N4", (60, 12), 4), length, (ratio,))
    usual = _block_stiffness(case.space(), length, (ratio,))
    assert usual[0] / fine[0] == pytest.approx(1, abs=0.02)


def test_a_block_is_as_stiff_as_its_modulus_where_nothing_holds_it_beside() -> None:
    assert _block_stiffness(row_space("N2", (4, 2), 2), 3.0, (0.0,))[0] == pytest.approx(3.0, rel=1e-12)


def test_bending_of_thick_bodies_is_not_checked() -> None:
    case = load_case("cylinder-pull-off")
    assert bending(case.problem(), row_space("L1", (20, 8), 2)) is None


def test_the_tension_of_the_body_at_its_face_is_that_of_the_adhesion() -> None:
    """The given figure: 82.8 MPa in the body beside 1.07 MPa of the adhesion where it is linear across."""
    case = Case.parse(TAPE.replace("ACROSS", ""))
    (stage,) = case.stages()
    *_, last = trace(stage.problem, case.space(), stage.parameters, NewtonSettings(path_control="auto"))
    profile = front_profile(stage.problem, case.space(), last.displacement)
    pull, body = -profile.adhesive_traction, -profile.body_traction
    at = pull > 0.2 * pull.max()
    assert body[at].max() < 2 * pull.max()
    assert body[at].min() > -pull.max()


@pytest.mark.parametrize("angle", [90, 135])
def test_a_tape_that_is_too_stiff_in_bending_is_not_reported_where_it_is_steady(angle: int) -> None:
    """Its steady force is right: what the front bends costs no energy in the end."""
    text = f"""
name = "tape"
units = {{ length = "1 mm", stress = "1 MPa" }}
body = {{ length = "14 mm", height = "0.1 mm" }}
material = {{ law = "neo-hooke", youngs_modulus = "300 MPa", poissons_ratio = 0.3 }}
adhesion = {{ law = "exponential", strength = "0.5 MPa", work_of_adhesion = "0.1 N/mm", length = "11 mm" }}
discretization = {{ space = "L1", mesh = "160x1", across_degree = 1 }}
drive = {{ kind = "force", side = "right", angle = "{angle} deg", to = "9 mm", step = "0.1 mm" }}
"""
    summary = result_of(text)
    assert "is sufficient" in message(summary.case)
    assert abs(summary.reading("steady force")["deviation_percent"]) < 1
    assert not summary.notes("locking")
