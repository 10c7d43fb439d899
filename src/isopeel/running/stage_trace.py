"""Trace a stage: its steps after the stored ones, and the attributes of its run."""

from collections.abc import Iterable, Mapping

import numpy as np

from isopeel.common.errors import InputError
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import run_attributes
from isopeel.running.checks import check_memory
from isopeel.running.stage_run import StageRun
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.solve.trace import trace


def steps_of(one: StageRun) -> Iterable[Step]:
    """Return the steps of a stage after the stored ones. Raises InputError where they cannot be computed."""
    stage, last = one.stage, None if one.stored is None else one.stored.last
    passed, rest = np.split(stage.parameters, [one.met])
    try:
        steps = trace(
            stage.problem,
            one.spaces,
            rest,
            NewtonSettings(path_control=stage.path_control),
            start=() if last is None else [last],
            passed=passed.tolist(),
            base=one.base,
            contact_points=one.case.discretization.contact_points,
        )
    except InputError as error:
        raise one.case.named(error) from error
    check_memory(one)
    return steps


def attributes_of(one: StageRun) -> Mapping[str, str | int]:
    """Return the attributes of the run of a stage: units, name, discretization and provenance."""
    if one.stored is not None:
        return one.stored.attributes
    units = one.case.units
    stated = {"L0": units.length, "E0": units.stress, "stage": one.stage.name}
    return {**stated, **run_attributes(one.stage.problem, one.spaces, Provenance.of_this_process())}
