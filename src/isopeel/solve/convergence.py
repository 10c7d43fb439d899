"""Why no equilibrium was found: the causes, what to try, and the error."""

from typing import Literal

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray

#: Why no equilibrium was found.
Cause = Literal[
    "inverted element",
    "limit point",
    "limit load",
    "held load",
    "energy without work",
    "lost partner",
    "instability",
    "long fall",
    "stalled residual",
    "line search",
    "non-finite traction",
    "singular tangent",
    "iteration limit",
    "penetration",
]

#: The reason where det F is not positive.
INVERTED = "an element is inverted"

#: What to try.
HINTS: dict[Cause, str] = {
    "inverted element": "use smaller steps, or a mesh that is finer around this element",
    "limit point": (
        "use path_control = continuation, or jump if the forces have a potential, or refine the mesh"
    ),
    "limit load": "stay below it, or prescribe the displacement where the load acts (control = displacement)",
    "held load": "make the held loads smaller, or let the drive raise one (control = force)",
    "energy without work": "use path_control = auto, which looks for the stable branch, or smaller steps",
    "lost partner": (
        "let one side of the interface end before the end of the other one (length), take scheme = biased"
        " with the shorter side first, or use a joint law, whose points stay paired"
    ),
    "instability": "follow the unstable branch by path_control = continuation, or refine the mesh",
    "long fall": "refine the mesh where the joint opens, or end the path where the body begins to come off",
    "stalled residual": "use smaller steps, or path_control = continuation",
    "line search": "use smaller steps, or a finer mesh",
    "non-finite traction": "use smaller steps, or check whether the body touches the substrate",
    "singular tangent": "add a support against free motion, or use path_control = continuation",
    "iteration limit": "use smaller steps, or path_control = auto, which reduces them where needed",
    "penetration": "allow a larger one, refine the mesh, or use the scheme 'biased' between two bodies",
}


class ConvergenceError(ArithmeticError):
    """No equilibrium was found at a value of the drive's parameter.

    It holds the reason in words, the energy residuals of the iterations, the parameter, and the cause.
    """

    def __init__(
        self, reason: str, iterations: tuple[float, ...], parameter: float, cause: Cause = "iteration limit"
    ) -> None:
        self.reason = reason
        self.iterations = iterations
        self.parameter = parameter
        self.cause = cause
        #: Coefficients (size, 2) where an element was inverted. To find its place costs as much as a step:
        #: `located` does so for the error that is reported.
        self.displacement: FloatArray | None = None
        super().__init__(f"no equilibrium at {parameter:g}: {reason}")

    def located(self, system: System) -> "ConvergenceError":
        """Return the same error with the place of the inverted element in its reason, where there is one."""
        inverted = None if self.displacement is None else system.inverted_point(self.displacement)
        if inverted is None:
            return self
        place, determinant = inverted
        at = f"det F = {determinant:.3g} at X = ({place[0]:.4g}, {place[1]:.4g})"
        reason = self.reason.replace(INVERTED, f"{INVERTED}: {at}", 1)
        return ConvergenceError(reason, self.iterations, self.parameter, self.cause)

    @property
    def hint(self) -> str:
        """What to try."""
        return HINTS[self.cause]

    def __reduce__(self) -> tuple[type["ConvergenceError"], tuple[str, tuple[float, ...], float, Cause]]:
        """Pickle the error with its reason, iterations, parameter and cause."""
        return type(self), (self.reason, self.iterations, self.parameter, self.cause)
