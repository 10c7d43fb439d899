"""A material from one expression of its stored energy."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import NUMBER, STRESS
from isopeel.physics.batch import MATERIAL_SIGNATURE, BatchFunction
from isopeel.physics.formula import (
    batch_source,
    check_constants,
    check_smooth,
    check_used,
    compile_source,
    parse_formula,
)
from isopeel.physics.formula_dimensions import FormulaDimensions

if TYPE_CHECKING:
    import sympy

_IN_PLANE = ("F11", "F12", "F21", "F22")
_COMPONENTS = (*_IN_PLANE, "F33")
_NAMES = (*_COMPONENTS, "I1", "I2", "J")


@dataclass(frozen=True)
class FormulaMaterial:
    """Isotropic material whose stored energy is one expression of the deformation gradient.

    `energy` may use the components F11 F12 F21 F22 F33, the three-dimensional invariants I1 = tr C,
    I2 = ((tr C)^2 - tr C^2)/2 with C = F^T F, and J = det F, and the names in `constants` (with values in
    the units of the problem). P = d psi/dF and dP/dF are derived by SymPy; F33 = 1 (plane strain) is set
    after the derivatives. Raises InputError unless the state F = I is free of stress and stable.
    """

    name: ClassVar[str] = "formula"
    dimensions: ClassVar[FormulaDimensions] = FormulaDimensions(
        "energy", STRESS, dict.fromkeys(_NAMES, NUMBER)
    )
    energy: Annotated[str, "a formula of I1, I2, J or F11 to F33 is needed"]
    constants: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the formula and its state of rest."""
        check_constants("material.constants", self.constants, _NAMES)
        object.__setattr__(self, "constants", dict(sorted(self.constants.items())))
        _source(self.energy, tuple(self.constants))
        shear, lame_lambda, stress = self._at_rest
        if not np.isfinite([shear, lame_lambda, stress]).all():
            raise InputError("material.energy", self.energy, "its derivatives must be finite at F = I")
        if shear <= 0 or lame_lambda + 2 / 3 * shear <= 0:
            raise InputError("material.energy", self.energy, "its stiffness at F = I must be positive")
        # differentiation is exact, so only the round-off of the evaluation may remain
        if abs(stress) > 1e-10 * shear:
            raise InputError("material.energy", self.energy, "its stress at F = I must vanish")
        if not self._is_isotropic:
            allowed = "it must not change when the body is turned, before or after its deformation"
            raise InputError("material.energy", self.energy, allowed)
        check_used("material.constants", self.constants, self.energy)

    @cached_property
    def _at_rest(self) -> tuple[float, float, float]:
        """Shear modulus, Lame's lambda and the largest stress at F = I."""
        import sympy

        _, stress = _derive(self.energy, tuple(self.constants))
        at_rest = {name: float(name in ("F11", "F22", "F33")) for name in _COMPONENTS} | dict(self.constants)
        coupling = stress["F11"].diff(sympy.Symbol("F22", real=True))
        shear = stress["F12"].diff(sympy.Symbol("F12", real=True))
        function = sympy.lambdify(tuple(at_rest), [shear, coupling, *stress.values()], "numpy")
        with np.errstate(all="ignore"):
            # numbers of NumPy overflow to infinity, those of Python raise
            numbers = [float(value) for value in function(*map(np.float64, at_rest.values()))]
        return numbers[0], numbers[1], max(numbers[2:], key=abs)

    @property
    def _is_isotropic(self) -> bool:
        """Whether psi(Q F) = psi(F Q) = psi(F) at a few deformations F and rotations Q."""
        import sympy

        psi, _ = _derive(self.energy, tuple(self.constants))
        function = sympy.lambdify((*_IN_PLANE, "F33", *self.constants), psi, "numpy")
        deformations = np.array([[[1.1, 0.2], [-0.1, 0.9]], [[0.95, -0.3], [0.1, 1.05]]])
        for angle in (0.7, np.pi / 2, 2.0):
            Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            states = np.stack([deformations, Q @ deformations, deformations @ Q]).reshape(3, 2, 4)
            with np.errstate(all="ignore"):
                values = function(*np.moveaxis(states, -1, 0), 1.0, *map(np.float64, self.constants.values()))
            shear, _, _ = self._at_rest
            # energies at strains of 20 % are some percent of the shear modulus
            if not np.ptp(values, axis=0).max() < 1e-10 * shear:
                return False
        return True

    @classmethod
    def like(cls, youngs_modulus: float, poissons_ratio: float) -> Self:
        """The neo-Hookean material of these elastic constants."""
        shear = youngs_modulus / (2 * (1 + poissons_ratio))
        lame_lambda = 2 * shear * poissons_ratio / (1 - 2 * poissons_ratio)
        constants = {"mu": shear, "lame": lame_lambda}
        return cls("mu/2*(I1 - 3 - 2*log(J)) + lame/2*log(J)**2", constants)

    @property
    def youngs_modulus(self) -> float:
        """E = mu (3 lambda + 2 mu)/(lambda + mu) at F = I."""
        shear, lame_lambda, _ = self._at_rest
        return shear * (3 * lame_lambda + 2 * shear) / (lame_lambda + shear)

    @property
    def poissons_ratio(self) -> float:
        """nu = lambda / (2 (lambda + mu)) at F = I."""
        shear, lame_lambda, _ = self._at_rest
        return lame_lambda / (2 * (lame_lambda + shear))

    @property
    def parameters(self) -> FloatArray:
        """Values of the constants, in the alphabetic order of their names."""
        return np.array(list(self.constants.values()), dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of energy density, stress and tangent."""
        return compile_source(_source(self.energy, tuple(self.constants)), MATERIAL_SIGNATURE)

    def out_of_plane_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress sigma_33 = (1/J) d psi/dF33 (...) for F (..., 2, 2)."""
        import sympy

        _, stress = _derive(self.energy, tuple(self.constants))
        names = (*_IN_PLANE, *self.constants)
        function = sympy.lambdify(names, stress["F33"].subs(sympy.Symbol("F33", real=True), 1), "numpy")
        F = deformation_gradient
        components = (F[..., 0, 0], F[..., 0, 1], F[..., 1, 0], F[..., 1, 1])
        value: FloatArray = function(*components, *self.constants.values()) / np.linalg.det(F)
        return value


@cache
def _derive(energy: str, constants: tuple[str, ...]) -> "tuple[sympy.Expr, dict[str, sympy.Expr]]":
    """psi(F11, ..., F33) and its derivatives with respect to each component."""
    import sympy

    psi = parse_formula("material.energy", energy, (*_NAMES, *constants))
    symbol = {name: sympy.Symbol(name, real=True) for name in _NAMES}
    F = sympy.Matrix(
        [[symbol["F11"], symbol["F12"], 0], [symbol["F21"], symbol["F22"], 0], [0, 0, symbol["F33"]]]
    )
    C = F.T * F
    invariants = {"I1": C.trace(), "I2": (C.trace() ** 2 - (C * C).trace()) / 2, "J": F.det()}
    psi = psi.subs({symbol[name]: value for name, value in invariants.items()})
    return psi, {name: psi.diff(symbol[name]) for name in (*_IN_PLANE, "F33")}


@cache
def _source(energy: str, constants: tuple[str, ...]) -> str:
    import sympy

    psi, stress = _derive(energy, constants)
    plane = {sympy.Symbol("F33", real=True): 1}
    index = {name: f"{int(name[1]) - 1}, {int(name[2]) - 1}" for name in _IN_PLANE}
    outputs, tangent = {"energy[n]": psi.subs(plane)}, {}
    for one in _IN_PLANE:
        outputs[f"P[{index[one]}, n]"] = stress[one].subs(plane)
        for other in _IN_PLANE:
            derivative = stress[one].diff(sympy.Symbol(other, real=True)).subs(plane)
            tangent[f"A[{index[one]}, {index[other]}, n]"] = derivative
    inputs = {name: f"F[{index[name]}, n]" for name in _IN_PLANE}
    arguments = "F, parameters, count, energy, P, A, tangent"
    check_smooth("material.energy", energy, [*outputs.values(), *tangent.values()])
    return batch_source(arguments, inputs, constants, outputs, asked={"tangent": tangent})
