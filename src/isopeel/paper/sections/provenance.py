"""Where each number comes from."""

from collections.abc import Iterator, Sequence

from isopeel.paper.document import Block, Table, Text
from isopeel.paper.results import Results
from isopeel.paper.study import Run
from isopeel.paper.wording import listed

TITLE = "Where the numbers come from"


def runs(_meshes: Sequence[str]) -> list[Run]:
    """No runs of its own: it tells of those of the other sections."""
    return []


def blocks(results: Results, _meshes: Sequence[str]) -> Iterator[Block]:
    """One row for each run: how far it went, its effort, and its date."""
    records = sorted(results.records.values(), key=lambda record: record.run.name)
    if not records:
        return
    software, platforms, revisions = (
        sorted({text for text in texts if text})
        for texts in zip(*((r.software, r.platform, r.revision) for r in records), strict=True)
    )
    yield Text(
        f"Computed with {listed(software)} on {listed(platforms)}"
        + (f", source revision {listed(revisions)}" if revisions else "")
        + ". Dates are in UTC; times are of all steps of a run, on a machine that it shared with other runs."
    )
    yield Table(
        "runs",
        "The runs: every step is 0.1 degree. Variants of the force start from the run without them.",
        ("run", "from / degree", "to / degree", "corrections", "seconds", "started", "ending"),
        tuple(
            (
                record.run.name,
                f"{record.run.range_deg[0]:g}",
                f"{record.angles_deg[-1]:.1f}" if len(record.angles_deg) else "-",
                f"{record.corrections}",
                f"{record.seconds:.1f}",
                record.started,
                "complete" if record.ended is None else record.reason,
            )
            for record in records
        ),
    )
