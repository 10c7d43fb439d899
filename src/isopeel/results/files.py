"""Writing a file as a whole."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give another name to write a file under; it takes the place of the old file when it is whole.

    Whatever ends the process, the file has its old content or its new one. Raises OSError.
    """
    part = path.with_name(f".{path.stem}.part{path.suffix}")  # the suffix tells the format of a figure
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
