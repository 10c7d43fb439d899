"""What a run says of its own numbers: where they can be doubted, and what could not be read."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

#: What a note is about. All but `reading` and `bifurcation` say that numbers of the run may be wrong.
Subject: TypeAlias = Literal[
    "reading", "bifurcation", "resolution", "locking", "stability", "closed form", "penetration"
]


@dataclass(frozen=True)
class Note:
    """One sentence on the numbers of a run, for the summary, the report and the terminal."""

    subject: Subject
    text: str
