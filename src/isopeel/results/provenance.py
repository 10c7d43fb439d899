"""The provenance of results: versions, machine, source revision, time and command."""

import platform
import shlex
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType

import isopeel

PACKAGES = ("numpy", "scipy", "numba")
_GIT_SECONDS = 5


@dataclass(frozen=True)
class Provenance:
    """The data needed to compute a result again. `git_revision` is None outside of a checkout."""

    versions: Mapping[str, str]
    platform: str
    git_revision: str | None
    started: str  # UTC, ISO 8601
    command_line: str

    @classmethod
    def of_this_process(cls) -> "Provenance":
        """Return the provenance of this process, as of now."""
        versions = {
            "isopeel": isopeel.__version__,
            "python": platform.python_version(),
            **{name: version(name) for name in PACKAGES},
        }
        return cls(
            MappingProxyType(versions),
            platform.platform(),
            git_revision(),
            datetime.now(UTC).isoformat(timespec="seconds"),
            # the bytes of a path need not be text
            shlex.join(sys.argv).encode("utf-8", "backslashreplace").decode("utf-8"),
        )


def git_revision() -> str | None:
    """Return the commit of the checkout that the package runs from, plus "-dirty" where files differ from it.

    Returns None where the package is installed elsewhere, or where git is missing or fails.
    """
    root = Path(isopeel.__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return None
    command = [
        "git",
        "--no-optional-locks",
        "-C",
        str(root),
        "describe",
        "--always",
        "--dirty",
        "--abbrev=40",
        "--exclude=*",
    ]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=_GIT_SECONDS, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return answer.stdout.strip()
