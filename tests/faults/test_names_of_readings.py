"""Each reading is named as what it is, and a steady one is steady."""

import pytest
from summaries import CaseResult, result_of

TAPE = """
name = "tape"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "{length} mm"
height = "0.1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "300 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "0.5 MPa"
work_of_adhesion = "0.1 N/mm"
length = "{adhering} mm"
{held}
[discretization]
space = "N2.1"
mesh = "{mesh}"
[drive]
kind = "force"
side = "right"
angle = "{angle} deg"
to = "{to} mm"
step = "{step} mm"
"""
HELD = 'sliding_length = "0.1 mm"'


def tape(**changes: object) -> CaseResult:
    usual = {"length": 6, "adhering": 2, "held": HELD, "mesh": "60x2", "angle": 90, "to": 6, "step": 0.1}
    return result_of(TAPE.format(**(usual | changes)))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"adhering": 1},
        {"held": "irreversible = true"},
        {"adhering": 1.5, "held": "", "angle": 120, "to": 9},
        {"adhering": 2.5, "angle": 60, "to": 4, "step": 0.05},
    ],
)
def test_what_takes_a_short_tape_off_is_no_initiation(changes: dict[str, object]) -> None:
    """Its front reaches the end of the joint before the force is steady."""
    message = tape(**changes)
    assert "initiation force" not in message.quantities
    assert "steady force" not in message.quantities
    assert message.reading("largest force")["words"] == "when the end of the joint separates"


@pytest.mark.parametrize(("adhering", "angle", "work"), [(15, 90, 1), (15, 60, 1), (12, 120, 1)])
def test_a_long_tape_that_is_harder_to_start_has_an_initiation_force(
    adhering: float, angle: float, work: float
) -> None:
    """A blunt end that adheres up to the load: more than the steady force, by which it goes on."""
    message = tape(length=adhering, adhering=adhering, angle=angle, to=5, step=0.05, mesh=f"{6 * adhering}x2")
    steady, first = message.reading("steady force"), message.reading("initiation force")
    assert abs(steady["deviation_percent"]) < 1
    assert first["value"] > 1.02 * steady["value"]
    assert first["at"]["value"] < 1


ROUND = """
name = "round"
[units]
length = "1 nm"
stress = "1 MPa"
[body]
shape = "{shape}"
radius = "100 nm"
[material]
law = "neo-hooke"
youngs_modulus = "{modulus} MPa"
poissons_ratio = 0.3
[adhesion]
law = "van-der-waals"
hamaker_constant = "1e-19 J"
equilibrium_distance = "0.4 nm"
length = "40 nm"
[substrate]
gap = "{gap} nm"
[discretization]
space = "N2"
mesh = "{mesh}"
[drive]
kind = "displacement"
side = "top"
angle = "90 deg"
to = "{to} nm"
step = "0.25 nm"
"""


@pytest.mark.parametrize(
    ("shape", "mesh", "modulus", "gap", "to", "name"),
    [
        ("quarter-cylinder", "24x4", 500, 5, -5, "largest tension"),
        ("half-cylinder", "40x4", 500, 4, -5, "largest tension"),
        ("quarter-cylinder", "24x4", 5000, 3, -3.5, "largest tension"),
        ("quarter-cylinder", "24x4", 500, 1, 5, "pull-off force"),
        ("half-cylinder", "40x4", 5000, 0.5, 3, "pull-off force"),
    ],
)
def test_the_tension_of_a_body_that_snaps_on_does_not_pull_it_off(
    shape: str, mesh: str, modulus: float, gap: float, to: float, name: str
) -> None:
    text = ROUND.format(shape=shape, mesh=mesh, modulus=modulus, gap=gap, to=to)
    message = result_of(text)
    (found,) = {"largest tension", "pull-off force"} & set(message.quantities)
    assert found == name
    assert ("while the body approaches the substrate" in message.reading(found)["words"]) == (to < 0)


STRIP = """
name = "strip"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "60 mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "{strength} MPa"
work_of_adhesion = "0.0005 N/mm"
length = "50 mm"
{extra}
[discretization]
mesh = "{mesh}"
[drive]
kind = "rotation"
to = "{to} deg"
step = "1 deg"
{window}
"""


def strip(**changes: object) -> CaseResult:
    usual = {"strength": 0.001, "mesh": "60x2", "to": 100, "window": "", "extra": ""}
    return result_of(STRIP.format(**(usual | changes)))


@pytest.mark.parametrize(("strength", "to"), [(0.001, 35), (0.0002, 90), (0.001, 44), (0.0004, 60)])
def test_a_moment_that_still_rises_is_not_called_steady(strength: float, to: float) -> None:
    assert "steady moment" not in strip(strength=strength, to=to).quantities


@pytest.mark.parametrize(("start", "end"), [(20, 30), (35, 50), (10, 90)])
def test_the_mean_in_a_window_is_not_called_steady_where_it_drifts(start: float, end: float) -> None:
    message = strip(window=f'[reading]\nwindow = ["{start} deg", "{end} deg"]')
    assert "steady moment" not in message.quantities
    drift = float(message.reading("mean moment")["words"].split("drift ")[1].split(" %")[0])
    assert drift > 2


def test_a_steady_moment_is_called_that_with_its_drift() -> None:
    words = strip().reading("steady moment")["words"]
    assert words.startswith("mean, drift ")
    assert abs(float(words.split("drift ")[1].split(" %")[0].replace("below ", ""))) < 2


@pytest.mark.parametrize("fields_every", [15, 40, 99])
def test_a_front_between_stored_states_is_found_by_the_energy_of_the_joint(fields_every: float) -> None:
    window = f'[reading]\nwindow = ["80 deg", "100 deg"]\n[output]\nfields_every = "{fields_every} deg"'
    message = strip(window=window, mesh="120x2", strength=0.003)
    assert "crack length" in message.quantities
    assert not any("no front" in text for text in message.notes("reading"))
    assert abs(message.reading("steady moment")["deviation_percent"]) < 1


WAVY = """
name = "wavy"
[units]
length = "1 um"
stress = "1 MPa"
[body]
length = "40 um"
height = "1 um"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "0.02 MPa"
work_of_adhesion = "0.002 N/m"
length = "30 um"
[substrate]
{substrate}
[discretization]
space = "N2.1"
mesh = "80x2"
[drive]
kind = "force"
side = "right"
angle = "90 deg"
to = "20 um"
step = "0.5 um"
[output]
fields_every = "1 um"
"""


@pytest.mark.parametrize(
    "substrate",
    [
        'kind = "wavy"\namplitude = "0.8 um"\nwavelength = "5 um"',
        'kind = "wavy"\namplitude = "0.2 um"\nwavelength = "3 um"',
        'kind = "formula"\nformula = "a*(sin(x/l) - 1)"\nconstants = { a = "0.4 um", l = "0.7 um" }',
    ],
)
def test_energy_released_at_waves_is_not_compared_with_the_work_of_adhesion(substrate: str) -> None:
    """A strip that rests on waves adheres in part: it takes W of less than its face."""
    message = result_of(WAVY.format(substrate=substrate))
    rate = message.reading("energy release rate")
    assert rate["closed_form"] is None
    assert rate["words"] == "by the drive, per area of the face; a part of it adheres"
    assert 0 < rate["value"] < 0.002


@pytest.mark.parametrize(
    ("angle", "to", "mesh"), [(90, 0.12, "36x1"), (120, 0.09, "36x1"), (90, 0.12, "45x1")]
)
def test_a_prescribed_load_is_compared_with_the_peeling_load(angle: int, to: float, mesh: str) -> None:
    """Followed beyond its limit it takes the tape off, by more load where the joint ends."""
    text = TAPE.format(length=9, adhering=8, held=HELD, mesh=mesh, angle=angle, to=0, step=0)
    raised = f'control = "force"\npath_control = "continuation"\nto = "{to} N/mm"'
    message = result_of(text.replace('to = "0 mm"', raised).replace('"0 mm"', '"0.02 N/mm"'))
    steady = message.reading("steady force")
    assert steady["closed_form"]["source"] == "Kendall's tape"
    assert abs(steady["deviation_percent"]) < 0.5
    assert message.reading("largest force")["value"] == pytest.approx(1000 * to)
    assert message.reading("largest force")["words"] == "when the end of the joint separates"
    assert not message.notes("closed form")


FILM = """
name = "film"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "0.48 mm"
height = "4.4 um"
[material]
law = "neo-hooke"
youngs_modulus = "24 kPa"
poissons_ratio = 0.0
[adhesion]
law = "exponential"
strength = "0.024 kPa"
work_of_adhesion = "1e-4 mJ/m^2"
[substrate]
gap = "{gap} um"
[held]
left = "xy"
[discretization]
space = "N2.1"
mesh = "{mesh}"
[drive]
side = "right"
kind = "displacement"
angle = "180 deg"
transverse = "held"
to = "0.33 um"
step = "16 nm"
"""


@pytest.mark.parametrize(("mesh", "gap"), [("24x1", 970), ("16x2", 970), ("24x1", 100)])
def test_a_film_that_buckles_far_from_its_joint_has_no_initiation(mesh: str, gap: float) -> None:
    message = result_of(FILM.format(mesh=mesh, gap=gap))
    assert "initiation force" not in message.quantities
    assert "largest force" in message.quantities
