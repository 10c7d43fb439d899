"""The communication of a program: it reads lines of JSON, and writes one line of JSON for each.

Its first line is {"ready": {library: version}} or {"absent": reason}. The answer to a list of angles in
radians is {"steps": [LoadStep], "stopped": reason or null, "peak_megabytes": number}; after a stop there are
no steps.
"""

import json
import os
import resource
import sys
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TextIO, TypeAlias

from peers.newton import LoadStep

#: Maps a degree, the elements (along x, along y) and an iterator of angles to the steps at these angles.
Start: TypeAlias = Callable[[int, tuple[int, int], Iterator[float]], Iterator[LoadStep]]


class AbsentError(Exception):
    """A peer is not available; the text is the reason."""


def own_output() -> TextIO:
    """Return the original standard output, and redirect it to standard error: libraries may print to it."""
    output = os.fdopen(os.dup(sys.stdout.fileno()), "w", buffering=1)
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    return output


def serve(steps: Iterator[LoadStep], pending: deque[float], output: TextIO) -> None:
    """Answer each list of angles read with its steps; the path takes the angles from `pending`."""
    for line in sys.stdin:
        pending.extend(json.loads(line))
        done, stopped = [], None
        try:
            while pending:
                done.append(asdict(next(steps)))
        except ArithmeticError as error:
            stopped = str(error)
            pending.clear()
        say(output, steps=done, stopped=stopped, peak_megabytes=peak_megabytes())


def say(output: TextIO, **message: object) -> None:
    output.write(json.dumps(message) + "\n")


def peak_megabytes() -> float:
    """Return the peak memory of this process."""
    status = Path("/proc/self/status")
    if status.exists():  # on Linux, ru_maxrss includes the peak of the parent process
        peak = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM:"))
        return int(peak.split()[1]) * 1024 / 1e6
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


def versions(libraries: tuple[str, ...]) -> dict[str, str]:
    """Return the versions of those that are installed."""
    found = {}
    for name in libraries:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
