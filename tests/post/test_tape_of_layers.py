"""The closed form of a tape of tied layers: shown where it is valid, and nowhere else."""

from dataclasses import replace
from math import pi

import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from isopeel import (
    Body,
    Exponential,
    Flat,
    HeldLoad,
    Interface,
    NeoHooke,
    Problem,
    PulledSide,
    Support,
    Tie,
    row_space,
)
from isopeel.physics.materials import Material
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.post.closed_form import composite_stiffness, kendall_force, laminate
from isopeel.post.closed_form.finite_strain import Membrane, peeled_layers, peeled_tape
from isopeel.post.crack import load_position
from isopeel.problem.place import placed
from isopeel.splines.nurbs import rectangle

LENGTH, LOWER, UPPER = 12.0, 0.1, 0.05
SOFT, STIFF = NeoHooke(0.02, 0.4), NeoHooke(1.0, 0.3)
LAW = Exponential(1.5e-3, 2e-4)
ADHESIVE = Body(rectangle(LENGTH, LOWER), SOFT, "adhesive")
BACKING = Body(placed(rectangle(LENGTH, UPPER), (0.0, LOWER), 0.0), STIFF, "backing")
TIE = Tie(BACKING.side("bottom"), ADHESIVE.side("top"))
JOINT = Interface(ADHESIVE.side("bottom", end=10 / 12), LAW, Flat())
HELD = Support(ADHESIVE.side("left"), (0,)), Support(BACKING.side("left"), (0,))
PULL = PulledSide(BACKING.side("right"), pi / 2)
PEELED = Problem("layers", (ADHESIVE, BACKING), (JOINT,), HELD, PULL, ties=(TIE,))
SPACES = {"adhesive": row_space("N2", (120, 2), 2), "backing": row_space("N2", (90, 1), 2)}


def plane(material: NeoHooke) -> float:
    return material.youngs_modulus / (1 - material.poissons_ratio**2)


def test_stiffnesses_are_integrals_over_the_height() -> None:
    layers = [(3.0, 0.2), (0.5, 0.7), (2.0, 0.1)]

    def modulus(y: float) -> float:
        return 3.0 if y < 0.2 else 0.5 if y < 0.9 else 2.0

    def moment(power: int, about: float = 0.0) -> float:
        return float(
            quad(lambda y: modulus(y) * (y - about) ** power, 0.0, 1.0, points=[0.2, 0.9], epsabs=1e-13)[0]
        )

    neutral = brentq(lambda at: moment(1, at), 0.0, 1.0, xtol=1e-14)
    stretching, bending = composite_stiffness(layers)
    assert stretching == pytest.approx(moment(0), rel=1e-10)
    assert bending == pytest.approx(moment(2, neutral), rel=1e-10)


def test_the_force_is_kendall_s_with_both_stiffnesses() -> None:
    form = laminate(PEELED, SPACES).form
    assert form is not None
    assert form.source == "Kendall's tape of layers"
    assert form.reaction == pytest.approx(
        kendall_force(2e-4, plane(SOFT) * LOWER + plane(STIFF) * UPPER, pi / 2), rel=1e-14
    )
    # an element of 0.1, stretched by 3.5e-3
    assert form.period == pytest.approx(0.1, rel=5e-3)


def test_layers_of_one_material_are_one_tape() -> None:
    soft = NeoHooke(1.0, 0.3)
    one, layers = peeled_tape(soft, 0.3, 0.12, 1.0), peeled_layers(((soft, 0.2), (soft, 0.1)), 0.12, 1.0)
    assert one is not None
    assert layers is not None
    assert (layers.force, layers.stretch) == pytest.approx((one.force, one.stretch), rel=1e-12)


def test_the_force_of_layers_is_the_derivative_of_their_energy() -> None:
    layers: tuple[tuple[Material, float], ...] = (SOFT, 0.2), (STIFF, 0.1)
    tape, size = Membrane(layers), 1e-5
    change = (tape.state(1.3 + size)[0] - tape.state(1.3 - size)[0]) / (2 * size)
    # the error of central differences is of the order of the size squared
    assert tape.state(1.3)[1] == pytest.approx(change, rel=1e-8)


def test_cracks_are_measured_from_the_end_of_the_layer_that_is_pulled() -> None:
    assert load_position(PEELED) == LENGTH
    to_the_left = replace(PEELED, drive=PulledSide(BACKING.side("left"), pi / 2), supports=())
    assert load_position(to_the_left) == 0.0
    assert load_position(replace(PEELED, drive=PulledSide(BACKING.side("top"), pi / 2))) is None


TENSE = replace(BACKING, material=Prestretched(STIFF, 1.01))
SHORT = replace(BACKING, shape=placed(rectangle(8.0, UPPER), (0.0, LOWER), 0.0))


@pytest.mark.parametrize(
    "problem",
    [
        pytest.param(replace(PEELED, ties=()), id="not tied"),
        pytest.param(replace(PEELED, bodies=(ADHESIVE, TENSE)), id="laid under tension"),
        pytest.param(replace(PEELED, bodies=(ADHESIVE, SHORT)), id="layers of two lengths"),
        pytest.param(replace(PEELED, drive=PulledSide(BACKING.side("right"), 1.0)), id="inclined"),
        pytest.param(replace(PEELED, drive=PulledSide(BACKING.side("right"), -pi / 2)), id="pressed"),
        pytest.param(replace(PEELED, drive=PulledSide(BACKING.side("top"), pi / 2)), id="pulled on top"),
        pytest.param(
            replace(PEELED, drive=PulledSide(BACKING.side("right"), pi / 2, control="force")),
            id="of a given force",
        ),
        pytest.param(
            replace(PEELED, loads=(HeldLoad(BACKING.side("top"), 1e-5, pi / 2),)), id="with another load"
        ),
        pytest.param(
            replace(PEELED, supports=(*HELD, Support(BACKING.side("top", end=0.5), (1,)))), id="held on top"
        ),
        pytest.param(
            replace(PEELED, interfaces=(replace(JOINT, boundary=ADHESIVE.side("bottom", start=0.1)),)),
            id="cracked at the far end",
        ),
        pytest.param(
            replace(PEELED, interfaces=(replace(JOINT, against=Flat(height=-0.01)),)), id="lifted at rest"
        ),
    ],
)
def test_other_problems_have_no_such_form(problem: Problem) -> None:
    assert laminate(problem, SPACES).form is None
