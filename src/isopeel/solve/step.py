"""What a path is made of: its steps, and the states that it can go on from."""

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args
from weakref import ReferenceType

from isopeel.common.arrays import FloatArray
from isopeel.solve.newton import NewtonResult
from isopeel.solve.quasi_newton import Memory

#: Converged states that plain Newton's method starts from: three, for a parabola.
PARABOLA_POINTS = 3


class Past(NamedTuple):
    """What the solver keeps of a state, to guess the next one from: unknowns (count,) at a parameter."""

    parameter: float
    unknown_values: FloatArray
    energy: float
    rate: float  # of the energy, by the parameter
    adhesive_energy: float  # and what was dissipated
    polished: FloatArray | None = None  # the unknowns to round-off, once they have been asked for

    @property
    def exact(self) -> FloatArray:
        """The unknowns (count,) as well as they are known."""
        return self.unknown_values if self.polished is None else self.polished


class State(NamedTuple):
    """Where a path can go on from, as a step has it: displacement coefficients (functions, 2) at a parameter.

    Only irreversible adhesion asks for the largest openings (E, Q) so far. Without the solver's past, its
    last states up to this one, what goes on is the same to the tolerance of the solver; with the past, and
    the solver's memory, it is the same bit for bit.
    """

    parameter: float
    displacement: FloatArray
    openings: FloatArray | None = None
    past: tuple[Past, ...] = ()
    memory: Memory | None = None


#: What a step is: at a parameter that was asked for; between two of them, where one was cut or a curve needs
#: its points; at a limit point of the parameter; on the branch that a jump has led to; or where stability is
#: lost to another branch, to which the path goes over.
Kind = Literal["requested", "between", "limit point", "jump", "bifurcation"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, eq=False)
class Step:
    """One converged equilibrium. Energies and reactions are for a unit width, in the problem's units.

    The adhesive energy is the potential of the adhesive forces where these act on the reference area;
    projected forces have none, and the work of the drive differs from the change of the energies. Of
    irreversible adhesion it is what closing would give back, and is zero where it was never opened.

    The released energy is the work of the drive since the last step, by the trapezoidal rule, less what the
    energies gained: zero, or of third order in the step, unless the path jumped (then it is known up to half
    of the step times the fall of the reaction), or a stage before let go of what it held. It is set to zero
    where it is known to be the error of that rule alone. Forces without a potential have none.
    """

    number: int
    parameter: float  # of the drive; an angle is in radians
    reaction: float  # a moment for an angle, a force for a displacement, a displacement for a force
    displacement: FloatArray  # (functions, 2) coefficients, read-only
    stored_energy: float
    adhesive_energy: float  # zero at infinite gap
    dissipated_energy: float  # by irreversible adhesion
    iterations: tuple[float, ...]  # energy residual per unknown before each Newton correction
    seconds: float  # wall time of the step
    openings: FloatArray  # (E, Q) largest ones so far at the points of the adhesive force, read-only
    unknown_values: FloatArray  # (count,) of the solver, read-only
    released_energy: float = 0.0  # since the last step, see above
    kind: Kind = "requested"
    negative_eigenvalues: int | None = None  # of the tangent, of a stable state none; None where not counted
    resumes: bool = True  # whether a path goes on from its state bit for bit, to the next parameter asked for
    past: tuple[Past, ...] = ()  # of the solver
    memory: "ReferenceType[Memory] | None" = None  # of the solver, which keeps it until the next step

    @property
    def state(self) -> State:
        """Where another path can go on; with the solver's memory as long as no later step has been made.

        To keep the memory of every step would take more room than all else of it.
        """
        memory = None if self.memory is None else self.memory()
        return State(self.parameter, self.displacement, self.openings, self.past, memory)


class Found(NamedTuple):
    """An equilibrium that was found, what it is, and the negative eigenvalues where they were counted."""

    parameter: float
    result: NewtonResult
    kind: Kind
    negative: int | None = None
    resumes: bool = True
    is_elsewhere: bool = False  # on another branch than the states before, which would mislead the next guess
    is_balanced: bool = False  # its energy comes from the work, but for the error of the trapezoidal rule
