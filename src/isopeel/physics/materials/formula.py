"""A material from one expression of its stored energy."""

from collections.abc import Callable, Mapping
from dataclasses import field
from functools import cache
from itertools import combinations_with_replacement
from typing import Annotated, Any, ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import NUMBER, STRESS, Meaning
from isopeel.physics.formula import check_constants, check_smooth, check_used, parse_formula, point_function
from isopeel.physics.formula_dimensions import FormulaDimensions
from isopeel.physics.materials.invariants import INVARIANTS
from isopeel.physics.materials.isotropic import Isotropic, material


@material
class FormulaMaterial(Isotropic):
    """Isotropic material whose stored energy is one expression of invariants.

    `energy` may use I1 = tr C and I2 = ((tr C)^2 - tr C^2)/2 of C = F^T F in three dimensions, and J = det F,
    and the names in `constants` (with values in the units of the problem). Raises InputError unless the state
    F = I is free of stress and stable.
    """

    name: ClassVar[str] = "formula"
    dimensions: ClassVar[FormulaDimensions] = FormulaDimensions(
        "energy", STRESS, dict.fromkeys(INVARIANTS, NUMBER)
    )
    energy: Annotated[
        str,
        "a formula of I1, I2 and J is needed",
        Meaning(
            "energy per volume, a formula of the invariants I1, I2 and J",
            "C*(I1/J**(2/3) - 3) + K/2*(J - 1)**2",
            see="extending.md",
        ),
    ]
    constants: Annotated[
        Mapping[str, float],
        Meaning(
            "constants of the formula, numbers or texts with units",
            {"C": "0.2 MPa", "K": "100 MPa"},
            usual="none",
        ),
    ] = field(default_factory=dict)  # type: ignore[assignment]

    def check(self) -> None:
        """Check the formula and its state of rest."""
        check_constants("material.constants", self.constants, INVARIANTS)
        object.__setattr__(self, "constants", dict(sorted(self.constants.items())))
        _, P, A = self.solid_response(np.eye(3))
        shear, lame = A[0, 1, 0, 1], A[0, 0, 1, 1]
        if not np.isfinite([shear, lame, P[0, 0]]).all():
            raise self.error("energy", "its derivatives must be finite at F = I")
        if shear <= 0 or lame + 2 / 3 * shear <= 0:
            raise self.error("energy", "its stiffness at F = I must be positive")
        # differentiation is exact, so only the round-off of the evaluation may remain
        if abs(P[0, 0]) > 1e-10 * shear:
            raise self.error("energy", "its stress at F = I must vanish")
        check_used("material.constants", self.constants, self.energy)

    @classmethod
    def like(cls, youngs_modulus: float, poissons_ratio: float) -> Self:
        """The neo-Hookean material of these elastic constants."""
        shear = youngs_modulus / (2 * (1 + poissons_ratio))
        lame_lambda = 2 * shear * poissons_ratio / (1 - 2 * poissons_ratio)
        constants = {"mu": shear, "lame": lame_lambda}
        return cls("mu/2*(I1 - 3 - 2*log(J)) + lame/2*log(J)**2", constants)

    @property
    def stored_energy(self) -> Callable[..., Any]:  # type: ignore[override]
        """The energy as a function of the invariants and the values of the constants."""
        return _function(self.energy, tuple(self.constants))

    @property
    def parameters(self) -> FloatArray:
        """Values of the constants, in the alphabetic order of their names."""
        return np.array(list(self.constants.values()), dtype=np.float64)


@cache
def _function(energy: str, constants: tuple[str, ...]) -> Callable[..., Any]:
    # SymPy takes a second to load
    import sympy

    psi = parse_formula("material.energy", energy, (*INVARIANTS, *constants))
    pairs = combinations_with_replacement([sympy.Symbol(name, real=True) for name in INVARIANTS], 2)
    check_smooth("material.energy", energy, [psi, *(psi.diff(*pair) for pair in pairs)])
    return point_function({name: name for name in INVARIANTS}, constants, [psi])
