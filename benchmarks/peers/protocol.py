"""How a program talks: a line of JSON comes in, a line of JSON goes out.

First it says {"ready": {library: version}} or {"absent": reason}. A list of angles in radians it answers with
{"steps": [LoadStep], "stopped": reason or null, "peak_megabytes": number}; once it stopped, it finds no more.
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

#: From a degree, the elements (along x, along y) and the angles to come to the steps there.
Start: TypeAlias = Callable[[int, tuple[int, int], Iterator[float]], Iterator[LoadStep]]


class AbsentError(Exception):
    """A peer cannot take part; says why."""


def own_output() -> TextIO:
    """Return what standard output was, and send there to standard error: libraries print what they like."""
    output = os.fdopen(os.dup(sys.stdout.fileno()), "w", buffering=1)
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    return output


def serve(steps: Iterator[LoadStep], pending: deque[float], output: TextIO) -> None:
    """Find the steps at the angles that come in, which the path takes from `pending`."""
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
    """Return the most memory that this process has had at a time."""
    status = Path("/proc/self/status")
    if status.exists():  # Linux counts what the parent had into ru_maxrss
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
