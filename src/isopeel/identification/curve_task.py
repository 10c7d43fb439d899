"""One run of a fit: a task whose outcome has curves and no readings, which take longer than a short run."""

from dataclasses import dataclass
from hashlib import sha256
from time import perf_counter

from isopeel.case import Case
from isopeel.common.errors import InputError
from isopeel.running.in_memory import traced_stages
from isopeel.study.outcome import REFUSED, Line, Outcome, Task


@dataclass(frozen=True)
class CurveTask(Task):
    """A run to compute, with the derivatives of its curves by the keys of `values`, per unit of the value."""

    @property
    def digest(self) -> str:
        """The name of its outcome, unlike that of the same run with readings."""
        return sha256(f"curve {super().digest}".encode()).hexdigest()[:32]

    def __call__(self) -> Outcome:
        """Compute the run. What is wrong with it is part of the outcome."""
        began = perf_counter()
        lines: list[Line] = []
        ending, cause, steps = REFUSED, "", 0
        try:
            case = Case.parse(self.case_text).with_values(self.values)
            for one, run in traced_stages(case, list(self.values)):
                lines.append(Line.of(one.stage.name, one.laboratory.curve(run.curve)))
                steps += len(run.curve)
                ending = run.ending
                cause = "" if run.failure is None else f"{run.failure.reason} ({run.failure.cause})"
        except InputError as error:
            ending, cause = REFUSED, str(error)
        except MemoryError:
            ending, cause = REFUSED, "there is not enough memory; use a coarser mesh"
        return Outcome(ending, cause, lines=tuple(lines), steps=steps, seconds=perf_counter() - began)
