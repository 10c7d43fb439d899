"""The printed tables of trials."""

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median

from rich.table import Table

from printing import plain_table
from trials.case import Trial
from trials.drawing import FAMILIES
from trials.running import Outcome
from trials.verdict import Verdict, deviation, verdict

Found = Sequence[tuple[Trial, Outcome]]
_HEADS = {
    Verdict.RIGHT: "right",
    Verdict.WARNED_CLOSE: "warned\nin 1 %",
    Verdict.WARNED: "warned\nin 3 %",
    Verdict.NOTED: "wrong,\nnoted",
    Verdict.FAILED: "no value,\ncause",
    Verdict.SLOW: "too\nslow",
    Verdict.CRASHED: "crashed",
    Verdict.SILENT: "wrong,\nSILENT",
}
_LISTED = (Verdict.SILENT, Verdict.CRASHED, Verdict.SLOW)


def counts(found: Found) -> Table:
    """Return the table of verdicts by family."""
    table = plain_table(
        "random cases with a known answer",
        *("family", "cases", *_HEADS.values(), "seconds\nmedian", "seconds\nmost"),
        caption="right: within 3 % of the closed form, without a note; warned: right, with a note",
        labels=1,
    )
    for name in ("all", *FAMILIES):
        some = [(trial, outcome) for trial, outcome in found if name in ("all", trial.family)]
        if some:
            verdicts = Counter(verdict(*one) for one in some)
            seconds = [outcome.seconds for _, outcome in some]
            times = f"{median(seconds):.1f}", f"{max(seconds):.0f}"
            table.add_row(name, str(len(some)), *(str(verdicts[kind]) for kind in _HEADS), *times)
    return table


def listed(found: Found, *, everything: bool = False) -> list[str]:
    """Return one line for each failed case: wrong ones without a note first, then crashes and slow ones."""
    kinds = tuple(Verdict) if everything else _LISTED
    ordered = reversed(kinds) if everything else kinds
    return [_line(*one) for kind in ordered for one in found if verdict(*one) is kind]


def _line(trial: Trial, outcome: Outcome) -> str:
    discretization, material = trial.drawn.sections["discretization"], trial.drawn.sections["material"]
    assert isinstance(discretization, Mapping)
    assert isinstance(material, Mapping)
    mesh = " ".join(str(discretization.get(key, "default")) for key in ("space", "mesh"))
    element = "" if trial.drawn.element is None else f", element {trial.drawn.element:.2g} process zones"
    # the last line of a traceback is the error
    cause = outcome.cause.strip().splitlines()[-1] if outcome.cause else "; ".join(outcome.notes)
    return (
        f"case {trial.number}, {verdict(trial, outcome).value}: {trial.family} ({trial.drawn.kind}),"
        f" space and mesh {mesh}{element}, nu {material['poissons_ratio']}: {outcome.value:.5g}, right"
        f" {trial.drawn.answer.value:.5g}, {100 * deviation(trial, outcome):+.2f} %, {outcome.steps} steps"
        f" {f'; {cause}' if cause else ''}"
    )


def gains(found: Found) -> Table:
    """Return the table of runs that gained energy without work."""
    table = plain_table(
        "energy gained in a step beyond the work of the drive and the error of its quadrature",
        *("case", "family", "what", "gain\nof W A", "at parameter"),
        labels=3,
    )
    for trial, outcome in sorted(
        found, key=lambda one: one[1].gain.share if one[1].gain else 0.0, reverse=True
    ):
        if outcome.gain and outcome.gain.forbidden:
            gain = outcome.gain
            table.add_row(
                f"{trial.number}",
                trial.family,
                trial.drawn.kind,
                f"{gain.share:.1e}",
                f"{gain.parameter:.5g}",
            )
    return table
