"""Programs trace the same path in turn; their moments are compared."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from peers.newton import LoadStep
from programs import Block, GoneError

MOMENT_TOLERANCE = 1e-8  # E0 L0^3


class Traced(Protocol):
    """The interface of a program, such as `programs.Program`."""

    label: str
    versions: dict[str, str]

    def begin(self, angles: Sequence[float]) -> None:
        """Start the computation of the equilibria at these angles (radians)."""

    def finish(self) -> Block:
        """Return the result of the computation. Raises GoneError if the program has ended."""

    def close(self) -> None:
        """End the program."""


@dataclass
class Entry:
    """A program in the comparison, its timed blocks of load steps, and its peak memory."""

    program: Traced
    blocks: list[list[LoadStep]] = field(default_factory=list)
    peak_megabytes: float = 0.0

    @property
    def steps(self) -> list[LoadStep]:
        """All timed steps."""
        return [step for block in self.blocks for step in block]


@dataclass
class Comparison:
    """Programs that agree so far, isopeel first, and notes on the others.

    The largest difference from isopeel's moments is over all compared steps. `ended` is set if a program
    found no equilibrium: the comparison ends there.
    """

    entries: list[Entry]
    notes: list[str] = field(default_factory=list)
    largest_difference: float = 0.0
    compared: int = 0
    ended: bool = False

    def trace(self, angles: Sequence[float], *, timed: bool) -> None:
        """Trace the next angles by all programs, in turn if timed; exclude programs that end or differ.

        Raises GoneError if isopeel itself ends."""
        blocks = {}
        if not timed:
            for entry in self.entries:
                entry.program.begin(angles)
        for entry in list(self.entries):
            if timed:
                entry.program.begin(angles)
            try:
                blocks[id(entry)] = entry.program.finish()
            except GoneError as error:
                if entry is self.entries[0]:
                    raise
                self._leave_out(entry, str(error))
        self._compare(blocks, angles)
        count = min(len(blocks[id(entry)].steps) for entry in self.entries)
        self.compared += count
        stopped = {
            entry.program.label: blocks[id(entry)].stopped
            for entry in self.entries
            if len(blocks[id(entry)].steps) == count < len(angles)
        }
        if stopped:
            self.ended = True
            who = ", ".join(f"{label} ({reason})" for label, reason in stopped.items())
            place = f"{np.rad2deg(angles[count]):g} degrees"
            self.notes.append(f"no equilibrium at {place}, where the comparison ends: {who}")
        for entry in self.entries:
            block = blocks[id(entry)]
            entry.peak_megabytes = block.peak_megabytes
            if timed and count:
                entry.blocks.append(block.steps[:count])

    def _compare(self, blocks: dict[int, Block], angles: Sequence[float]) -> None:
        ours = blocks[id(self.entries[0])].steps
        for entry in self.entries[1:]:
            theirs = blocks[id(entry)].steps
            differences = [abs(a.moment - b.moment) for a, b in zip(ours, theirs, strict=False)]
            wrong = next((n for n, size in enumerate(differences) if not size <= MOMENT_TOLERANCE), None)
            if wrong is None:
                self.largest_difference = max([self.largest_difference, *differences])
            else:
                moments = f"{theirs[wrong].moment:.10f}, not {ours[wrong].moment:.10f} E0 L0^3"
                self._leave_out(entry, f"its moment at {np.rad2deg(angles[wrong]):g} degrees is {moments}")

    def _leave_out(self, entry: Entry, reason: str) -> None:
        self.notes.append(f"{entry.program.label} is left out: {reason}")
        self.entries = [other for other in self.entries if other is not entry]
        entry.program.close()
