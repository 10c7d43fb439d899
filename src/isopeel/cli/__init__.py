"""The command line: arguments and exit codes; no logic."""

import gc
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import TextIOWrapper

from typer.exceptions import TyperException

from isopeel.cli import compute_commands, fit_command, output_commands
from isopeel.cli.base import BAD_INPUT, COMPLETED, app, fail, unwritten
from isopeel.common.errors import InputError
from isopeel.common.interrupts import ending_this_process

__all__ = ["app", "compute_commands", "fit_command", "main", "output_commands"]

#: Threshold of the garbage collector: objects made minus objects removed. Python's own is 700.
_ALLOCATIONS = 20_000


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line, by default the process's own, and return its exit code.

    0: done; 2: bad input, or a file that cannot be written; 3: no equilibrium; 130: interrupted. Errors are
    written to standard error.
    """
    if isinstance(sys.stdout, TextIOWrapper):
        # a character that the terminal's encoding lacks must not end a run
        sys.stdout.reconfigure(errors="replace")
    if arguments is None:
        # child processes must not import modules from the current folder
        os.environ.setdefault("PYTHONSAFEPATH", "1")
        with ending_this_process(), _few_collections():
            return _code_of(None)
    return _code_of(arguments)


@contextmanager
def _few_collections() -> Iterator[None]:
    """Collect unreachable objects less often, and not at the end: most objects are of modules."""
    gc.set_threshold(_ALLOCATIONS, 20, 20)
    try:
        yield
    finally:
        gc.freeze()


def _code_of(arguments: Sequence[str] | None) -> int:
    try:
        return int(app(arguments, standalone_mode=False) or COMPLETED)
    except InputError as error:
        return fail(BAD_INPUT, str(error))
    except TyperException as error:
        return fail(BAD_INPUT, " ".join(error.format_message().split()))
    except OSError as error:
        return fail(BAD_INPUT, unwritten(error))
    except MemoryError:
        return fail(BAD_INPUT, "there is not enough memory; use a coarser --mesh")
