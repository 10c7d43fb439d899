"""A drawn case with its known answer, and the text of its case file."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

#: The quantity that a user of a drive reads from a run.
Reading: TypeAlias = Literal["plateau", "largest", "pull-off", "push", "buckling"]

Value: TypeAlias = "str | float | int | bool | Sequence[object] | Mapping[str, str]"
Table: TypeAlias = Mapping[str, Value]


@dataclass(frozen=True)
class Answer:
    """The expected result of the run: a reaction per width in SI units (N/m, or N for a moment)."""

    reading: Reading
    value: float


@dataclass(frozen=True)
class Drawn:
    """A draw of a family: the tables of a case file, files beside it, and the answer.

    `kind` describes the draw in a few words. `element` is the size of an element along the length over that
    of the process zone; None if there is no process zone.
    """

    kind: str
    sections: Mapping[str, Table | Sequence[Table]]
    answer: Answer
    element: float | None = None
    files: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Trial:
    """The case with a number of a seed."""

    seed: int
    number: int
    family: str
    drawn: Drawn

    @property
    def name(self) -> str:
        """The name of the case."""
        return f"trial-{self.seed}-{self.number}"

    @property
    def text(self) -> str:
        """The case file."""
        return case_text(self.name, self.drawn.sections)

    @property
    def default_mesh(self) -> bool:
        """Whether the case names no mesh."""
        return "mesh" not in self._discretization

    @property
    def default_space(self) -> bool:
        """Whether the case names no space."""
        return "space" not in self._discretization

    @property
    def _discretization(self) -> Table:
        table = self.drawn.sections.get("discretization", {})
        assert isinstance(table, Mapping)
        return table


def case_text(name: str, sections: Mapping[str, Table | Sequence[Table]]) -> str:
    """Write the tables of a case as TOML; a list of tables becomes stages."""
    lines = [f'name = "{name}"']
    for title, tables in sections.items():
        several = not isinstance(tables, Mapping)
        for table in tables if not isinstance(tables, Mapping) else [tables]:
            lines += ["", f"[[{title}]]" if several else f"[{title}]"]
            lines += [f"{key} = {_value(value)}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _value(value: Value) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {json.dumps(text)}" for key, text in value.items()) + " }"
    return json.dumps(value)
