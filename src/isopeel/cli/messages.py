"""What a command writes beside its results: nothing, one JSON object, or a log."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print one JSON object in place of tables and notes.")
]
VerboseOption = Annotated[
    int,
    typer.Option(
        "-v", count=True, help="Write a log of the stages to standard error; -vv logs each step, too."
    ),
]

_LEVELS = (logging.WARNING, logging.INFO, logging.DEBUG)


@contextmanager
def logged(verbose: int) -> Iterator[None]:
    """Write the log of isopeel to standard error: with 1 its stages, with 2 or more each step."""
    if not verbose:
        yield
        return
    logger = logging.getLogger("isopeel")
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s", "%H:%M:%S"))
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(_LEVELS[min(verbose, len(_LEVELS) - 1)])
    try:
        yield
    finally:
        logger.setLevel(level)
        logger.removeHandler(handler)
