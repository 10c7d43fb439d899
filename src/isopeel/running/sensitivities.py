"""The sensitivities of a run: the systems of its stages with other values of parameters of the case."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from isopeel.assembly.system import System
from isopeel.case import Case, Stage
from isopeel.case.parameters import Parameter, parameter_of
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.problem import Problem
from isopeel.results.curve import DifferentiatedBy
from isopeel.running.stage_run import StageRun
from isopeel.running.stage_trace import steps_of
from isopeel.solve.sensitivity import STENCILS, Sensitivities, Variant, variant_of, with_sensitivities
from isopeel.solve.step import Step
from isopeel.splines.nurbs import NurbsSurface


@dataclass
class Differentiation:
    """The parameters by which the reactions of a case are differentiated, for one stage after another."""

    case: Case
    parameters: tuple[Parameter, ...]
    _varied: dict[tuple[str, float], tuple[Case, tuple[Stage, ...]]] = field(default_factory=dict)
    _of_last_stage: Sensitivities | None = None

    @classmethod
    def of(cls, case: Case, keys: Sequence[str]) -> Self:
        """Read the parameters. Raises InputError, whose field is the key, if one is no parameter."""
        return cls(case, tuple(parameter_of(case, key) for key in keys))

    @property
    def sensitive_to(self) -> tuple[DifferentiatedBy, ...]:
        """The parameters as a curve has them."""
        return tuple(DifferentiatedBy(one.key, one.value, one.unit) for one in self.parameters)

    def steps(self, number: int, one: StageRun) -> Iterable[Step]:
        """Return the steps of a stage, by its number from zero, with their sensitivities.

        Raises InputError where they cannot be computed.
        """
        return with_sensitivities(steps_of(one), self.of_stage(number, one))

    def of_stage(self, number: int, one: StageRun) -> Sensitivities | None:
        """Return the sensitivities of a stage, by its number from zero, after those of the stage before.

        None without parameters. Raises InputError where a parameter changes the mesh, or a contact has
        multipliers.
        """
        if not self.parameters:
            return None
        rates = () if self._of_last_stage is None else self._of_last_stage.rates()
        system = _system(one.stage.problem, one, None if one.base is None else one.base.displacement)
        if system.has_multipliers:
            allowed = "the state of a contact with a penetration depends on the updates of its multipliers"
            raise InputError("sensitivities", None, f"{allowed}; leave penetration out")
        variants = [
            self._variants(parameter, number, one, system, rates[k].displacement if rates else None)
            for k, parameter in enumerate(self.parameters)
        ]
        history = None if one.base is None else one.base.maximum_openings
        self._of_last_stage = Sensitivities(system, variants, history, rates)
        return self._of_last_stage

    def _variants(
        self, parameter: Parameter, number: int, one: StageRun, system: System, rate: FloatArray | None
    ) -> list[Variant]:
        """Return the variants of a stage with other values of a parameter.

        The displacement that the stage begins with changes at a rate (functions, 2), if there is one.
        """
        begins = None if one.base is None else one.base.displacement
        refusals: list[InputError] = []
        for stencil in STENCILS:
            found = []
            try:
                for multiple, weight in stencil:
                    shift = multiple * parameter.shift
                    case, stages = self._shifted(parameter, shift)
                    moved = begins if begins is None or rate is None else begins + shift * rate
                    problem = _with_equal_shapes(stages[number].problem, one.stage.problem)
                    if moved is begins and _has_same_geometry(problem, one.stage.problem):
                        other = system.with_physics_of(problem)
                    else:
                        same = _has_same_shapes(problem, one.stage.problem)
                        other = _system(
                            problem, one if same else replace(one, spaces=case.spaces()), moved, system
                        )
                    found.append(variant_of(system, other, shift, weight / parameter.shift))
            except InputError as error:
                refusals.append(error)
            else:
                return found
        allowed = f"there is no derivative by it, as with other values near it: {refusals[0]}"
        raise InputError(parameter.key, parameter.written(0.0), allowed) from refusals[0]

    def _shifted(self, parameter: Parameter, shift: float) -> tuple[Case, tuple[Stage, ...]]:
        """Return the case, and its stages, with a parameter that is larger by a shift in its unit."""
        at = parameter.key, shift
        if at not in self._varied:
            case = self.case.with_values({parameter.key: parameter.written(shift)})
            self._varied[at] = case, case.stages()
        return self._varied[at]


def _system(problem: Problem, one: StageRun, base: FloatArray | None, like: System | None = None) -> System:
    """Return the system of a problem in place of that of a stage, which begins with coefficients.

    It shares the tables of bodies with a system like it.
    """
    return System(problem, one.spaces, one.case.discretization.contact_points, base, like)


def _with_equal_shapes(problem: Problem, other: Problem) -> Problem:
    """Return a problem whose bodies have the very shapes of another one where these are equal."""
    bodies = tuple(
        replace(mine, shape=theirs.shape) if _are_equal(mine.shape, theirs.shape) else mine
        for mine, theirs in zip(problem.bodies, other.bodies, strict=True)
    )
    return replace(problem, bodies=bodies)


def _are_equal(one: NurbsSurface, other: NurbsSurface) -> bool:
    return np.array_equal(one.control_points, other.control_points) and np.array_equal(
        one.weights, other.weights
    )


def _has_same_shapes(problem: Problem, other: Problem) -> bool:
    """Return whether the bodies have the very shapes of another problem, and so the same spaces."""
    return all(a.shape is b.shape for a, b in zip(problem.bodies, other.bodies, strict=True))


def _has_same_geometry(problem: Problem, other: Problem) -> bool:
    """Return whether a problem differs from another one in materials and laws only."""
    bodies = tuple(replace(a, material=b.material) for a, b in zip(problem.bodies, other.bodies, strict=True))
    interfaces = tuple(
        replace(a, law=b.law) for a, b in zip(problem.interfaces, other.interfaces, strict=True)
    )
    return replace(problem, bodies=bodies, interfaces=interfaces) == other
