"""Notes on the results of a run: which of them may be wrong, and which are missing."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

#: The subject of a note. All except `reading` and `bifurcation` mean that numbers of the run may be wrong.
Subject: TypeAlias = Literal[
    "reading",
    "bifurcation",
    "resolution",
    "locking",
    "stability",
    "closed form",
    "penetration",
    "history",
    "law",
]


class Remedy(NamedTuple):
    """A sufficient discretization: elements along and across, and their grading if it is changed.

    Each of `instead` is another remedy, which is sufficient without a new mesh.
    """

    mesh: tuple[int, int]
    grading: tuple[float, float] | None = None
    instead: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The remedy as keys of a case file."""
        mesh = f"mesh = '{self.mesh[0]}x{self.mesh[1]}'"
        if self.grading is not None:
            mesh += f" with grading = [{self.grading[0]:g}, {self.grading[1]:g}]"
        return ", or ".join([mesh, *self.instead])


@dataclass(frozen=True)
class Note:
    """One sentence on the results of a run, for the summary, the report and the terminal."""

    subject: Subject
    text: str
    remedy: Remedy | None = None


def with_one_remedy(notes: Sequence[Note]) -> list[Note]:
    """Return the notes with one remedy only, at the end of the first note that has one.

    It is the finest discretization of all remedies; a graded mesh counts as finer at the front than any
    other. If the notes have different remedies, the ones without a new mesh are left out, because each of
    them was computed for one note only.
    """
    remedies = list(dict.fromkeys(note.remedy for note in notes if note.remedy is not None))
    if not remedies:
        return list(notes)
    graded = [remedy for remedy in remedies if remedy.grading is not None]
    chosen = max(graded or remedies, key=lambda remedy: remedy.mesh)
    if len(remedies) > 1:
        across = max(remedy.mesh[1] for remedy in remedies)
        chosen = Remedy((chosen.mesh[0], max(chosen.mesh[1], across)), chosen.grading)
    first = next(k for k, note in enumerate(notes) if note.remedy is not None)
    return [
        Note(note.subject, f"{note.text}; use {chosen.text}" if k == first else note.text)
        for k, note in enumerate(notes)
    ]
