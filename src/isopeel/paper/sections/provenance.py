"""The runs and the software that gave each number."""

from collections.abc import Iterator

from isopeel.paper.results import Results
from isopeel.report.document import Block, Table, Text

TITLE = "Where the numbers come from"


def blocks(results: Results) -> Iterator[Block]:
    """Yield one row for each run: its last angle, its effort, its date, and its software."""
    records = sorted(results.records.values(), key=lambda record: record.run.name)
    makers = list(dict.fromkeys((r.software, r.platform, r.revision) for r in records))
    if not records:
        return
    items = [
        f"{n}. {software}, on {platform}" + (f", source revision {revision}" if revision else "")
        for n, (software, platform, revision) in enumerate(makers, start=1)
    ]
    yield Text("Computed by\n\n" + "\n".join(items))
    yield Text(
        "Dates are in UTC. Times are sums over all steps of a run, on a machine that ran other runs at the "
        "same time."
    )
    yield Table(
        "runs",
        "The runs, in steps of 0.1 degree. Variants, timed runs and plain runs start from a state of the run "
        "with the same space and mesh.",
        ("run", "from / degree", "to / degree", "corrections", "seconds", "started", "by", "ending"),
        tuple(
            (
                record.run.name,
                f"{record.run.range_deg[0]:g}",
                f"{record.reached_deg:.1f}",
                f"{record.corrections}",
                f"{record.seconds:.1f}",
                record.started,
                f"{1 + makers.index((record.software, record.platform, record.revision))}",
                record.reason or "complete",
            )
            for record in records
        ),
    )
