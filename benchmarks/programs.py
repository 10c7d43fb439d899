"""Programs in separate processes, and their communication with the benchmark."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from peers.names import PROGRAMS
from peers.newton import LoadStep

HERE = Path(__file__).parent
SYSTEM_PYTHON = "/usr/bin/python3"
# these make OpenBLAS use the kernels of another processor
NOT_HANDED_ON = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")
ONE_THREAD = dict.fromkeys(
    [*(f"{name}_NUM_THREADS" for name in ("OMP", "MKL", "OPENBLAS", "NUMBA", "NGS")), "NUTILS_NPROCS"], "1"
)
OTHER_SETTINGS = {"NUTILS_MATRIX": "scipy"}


class GoneError(Exception):
    """A program is not available, or has ended; the text is the reason."""


@dataclass(frozen=True)
class Block:
    """Consecutive load steps of one program, and the reason if it found no more."""

    steps: list[LoadStep]
    stopped: str | None = None
    peak_megabytes: float = 0.0


class Program:
    """A program that traces the path in a separate process."""

    def __init__(self, name: str, degree: int, elements: tuple[int, int]) -> None:
        """Start the process, and wait until it is ready. Raises GoneError if it is not available."""
        self.label = PROGRAMS[name].label
        self._errors = TemporaryFile()  # noqa: SIM115 - as long as the process
        self._process = subprocess.Popen(
            [_interpreter(name), "-m", "peers", name, str(degree), *map(str, elements)],
            cwd=HERE,
            env=environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
        )
        answer = self._answer()
        if "absent" in answer:
            self.close()
            raise GoneError(answer["absent"])
        self.versions: dict[str, str] = answer["ready"]

    def begin(self, angles: Sequence[float]) -> None:
        """Start the computation of the equilibria at these angles (radians)."""
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # then `finish` gets no answer, and raises the error
            self._process.stdin.write(json.dumps(list(angles)) + "\n")
            self._process.stdin.flush()

    def finish(self) -> Block:
        """Return the result of the computation. Raises GoneError if the program has ended."""
        answer = self._answer()
        steps = [LoadStep(**step) for step in answer["steps"]]
        return Block(steps, answer["stopped"], answer["peak_megabytes"])

    def close(self) -> None:
        """End the process by closing its input."""
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with suppress(BrokenPipeError):
                pipe.close()
        self._process.wait()
        self._errors.close()

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if line:
            answer: dict[str, Any] = json.loads(line)
            return answer
        status = self._process.wait()
        self._errors.seek(0)
        said = self._errors.read().decode(errors="replace").strip().splitlines()
        self.close()
        raise GoneError(f"it ended with status {status}" + (f": {said[-1]}" if said else ""))


def environment() -> dict[str, str]:
    """Return the environment of all programs: one thread, and the commands of this Python first."""
    kept = {name: value for name, value in os.environ.items() if name not in NOT_HANDED_ON}
    # NGSolve's compiler is a script that runs the first Python of the path
    path = os.pathsep.join([str(Path(sys.executable).parent), kept.get("PATH", os.defpath)])
    return {**kept, **ONE_THREAD, **OTHER_SETTINGS, "PATH": path}


def _interpreter(name: str) -> str:
    """Return the Python of a program: that of the system for DOLFINx, which is a package of the system."""
    if name == "dolfinx":
        for python in (sys.executable, SYSTEM_PYTHON):
            if (
                Path(python).exists()
                and not subprocess.run(
                    [python, "-c", "import dolfinx"], capture_output=True, check=False
                ).returncode
            ):
                return python
    return sys.executable
