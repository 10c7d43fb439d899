"""The data of a path: its steps, and the states that a path can continue from."""

from dataclasses import dataclass
from typing import Literal, NamedTuple, Self, get_args
from weakref import ReferenceType

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.solve.newton import NewtonResult
from isopeel.solve.quasi_newton import SolverState

#: Number of accepted states through which plain Newton's method extrapolates its start, by a parabola.
PARABOLA_POINTS = 3


class AcceptedState(NamedTuple):
    """An accepted state, which the solver stores to extrapolate the path: unknowns (count,) and more."""

    parameter: float
    unknown_values: FloatArray
    energy: float
    rate: float  # derivative of the energy by the parameter
    adhesive_energy: float  # plus the dissipated energy
    fully_converged: FloatArray | None = None  # unknowns (count,) to round-off, where they were computed

    @classmethod
    def of(cls, system: System, result: NewtonResult) -> Self:
        """Return the accepted state of an equilibrium."""
        at = result.equilibrium
        energy, rate = system.potential(at, result.displacement, result.load, result.parameter)
        adhesive_energy = at.adhesive_energy + at.dissipated_energy
        return cls(result.parameter, result.unknown_values, energy, rate, adhesive_energy)

    @property
    def exact(self) -> FloatArray:
        """The most exact unknowns (count,) that are known."""
        return self.unknown_values if self.fully_converged is None else self.fully_converged


class State(NamedTuple):
    """A state that a path can continue from: displacement coefficients (functions, 2) at a parameter.

    Only irreversible adhesion needs the maximum openings (E, Q), and a joint law its history in their place,
    see `System`. From the displacement alone a path continues to the tolerance of the solver. With the
    accepted states up to this one and the solver state it continues bit for bit.
    """

    parameter: float
    displacement: FloatArray
    maximum_openings: FloatArray | None = None
    accepted_states: tuple[AcceptedState, ...] = ()
    solver_state: SolverState | None = None


#: The kind of a step: at a requested parameter; between two of them, where a step was cut or the path follows
#: its curve; at a limit point of the parameter; on the branch that a jump has reached; or at a bifurcation,
#: where stability is lost and the path changes to another branch.
Kind = Literal["requested", "between", "limit point", "jump", "bifurcation"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, eq=False)
class Step:
    """One converged equilibrium. Energies and reactions are for a unit width, in the problem's units.

    The adhesive energy is the potential of the adhesive forces. For irreversible adhesion it is the energy
    that closing would give back, zero where the joint was never opened. Projected forces have no potential:
    then the work of the drive differs from the change of the energies. Held loads do work too: the sum of the
    stored, adhesive and dissipated energy grows by their work and that of the drive.

    The reaction of a boundary is the force along the direction of the drive, or the moment; under a
    prescribed load it is the displacement of the load. The reaction is the sum of these, each times its
    factor. If the load is unknown, the reaction is the load, and that of a boundary is its factor times the
    load.

    The released energy is the work of the drive since the last step, by the trapezoidal rule, minus the
    change of the energies. It is zero, or of third order in the step, except in a jump (then its error is up
    to half of the step times the fall of the reaction), and in the first step of a stage that releases what
    the stage before has held. It is set to zero if it is the error of that rule only, and for forces without
    a potential.
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
    maximum_openings: FloatArray  # (E, Q) at the points of the adhesive force, see `System`; read-only
    unknown_values: FloatArray  # (count,) of the solver, read-only
    released_energy: float = 0.0  # since the last step, see above
    reactions: tuple[float, ...] = ()  # of each boundary, where the drive acts on several
    load_work: float | None = None  # of the loads that are held, since the initial state; None without any
    sensitivities: tuple[float, ...] = ()  # derivatives of the reaction, see `isopeel.solve.sensitivity`
    kind: Kind = "requested"
    negative_eigenvalues: int | None = None  # of the tangent: 0 where stable, None where not counted
    resumes: bool = True  # whether a path continues from its state bit for bit to the next requested value
    accepted_states: tuple[AcceptedState, ...] = ()  # of the solver, up to this one
    #: Of the solver, which stores it until the next step.
    solver_state: "ReferenceType[SolverState] | None" = None

    @property
    def state(self) -> State:
        """The state that another path can continue from; with the solver state until the next step is made.

        The solver state of every step would take more memory than the rest of the step.
        """
        solver_state = None if self.solver_state is None else self.solver_state()
        return State(
            self.parameter, self.displacement, self.maximum_openings, self.accepted_states, solver_state
        )


class Found(NamedTuple):
    """An equilibrium, the kind of its step, and its negative eigenvalues where they were counted."""

    result: NewtonResult
    kind: Kind = "requested"
    negative: int | None = None
    resumes: bool = True
    is_elsewhere: bool = False  # on another branch than the states before, without a jump
    is_balanced: bool = False  # energy gained = work of the drive, to the error of the trapezoidal rule

    @property
    def parameter(self) -> float:
        """Parameter of the equilibrium."""
        return self.result.parameter

    @property
    def leaves_branch(self) -> bool:
        """Whether the states before are of another branch, so that they must not be extrapolated."""
        return self.is_elsewhere or self.kind == "jump"
