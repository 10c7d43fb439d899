"""Values that a shell completes on the command line."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import get_args

from isopeel.common.path_control import PathControl

Completion = Callable[[str], list[str]]

#: Spaces that a shell offers; there are more, see `isopeel.splines.names`.
SPACES = ("L1", "L2", "L4", "N2", "N2.1", "N3", "N4", "L1+N2.1", "Q1N2", "Q1N2.1", "Q1C4", "Q1CH")


def one_of(*values: str) -> Completion:
    """Return the completion of an argument that is one of some values."""
    return lambda incomplete: _beginning_with(incomplete, values)


path_controls = one_of(*get_args(PathControl))
spaces = one_of(*SPACES)


def shipped(incomplete: str) -> list[str]:
    """Complete the name of a shipped case."""
    from isopeel.case import shipped_cases

    return _beginning_with(incomplete, shipped_cases())


def cases(incomplete: str) -> list[str]:
    """Complete a case: a shipped one, or a TOML file."""
    return shipped(incomplete) + _files(incomplete)


def laws(incomplete: str) -> list[str]:
    """Complete an adhesion law, or a case whose law is shown."""
    from isopeel.common.registry import discover

    return _beginning_with(incomplete, discover("isopeel.physics.adhesion")) + cases(incomplete)


def keys(incomplete: str) -> list[str]:
    """Complete a key of a case, as TABLE.KEY."""
    from isopeel.output.key_reference import paths

    return _beginning_with(incomplete, paths())


def checks(incomplete: str) -> list[str]:
    """Complete a check of `isopeel validate`."""
    from isopeel.validation.report import CHECKS

    return _beginning_with(incomplete, CHECKS)


def parts(incomplete: str) -> list[str]:
    """Complete a part of `isopeel paper`."""
    from isopeel.paper.report import PARTS

    return _beginning_with(incomplete, PARTS)


def _beginning_with(incomplete: str, values: Iterable[str]) -> list[str]:
    return [value for value in values if value.startswith(incomplete)]


def _files(incomplete: str) -> list[str]:
    """Return the TOML files and the folders that a path may become."""
    folder, _, name = incomplete.rpartition("/")
    start = Path(f"{folder}/" if folder or incomplete.startswith("/") else ".")
    if not start.is_dir():
        return []
    found = (path for path in sorted(start.iterdir()) if path.name.startswith(name))
    shown = [(path, f"{incomplete.removesuffix(name)}{path.name}") for path in found if path.name[0] != "."]
    return [
        f"{text}/" if path.is_dir() else text
        for path, text in shown
        if path.is_dir() or path.suffix == ".toml"
    ]
