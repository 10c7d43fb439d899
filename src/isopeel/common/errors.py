"""The error for bad input: one line, whatever the input contains."""

from reprlib import Repr

_LONGEST = 200  # characters of what a user wrote
_REPR = Repr()
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = _LONGEST
_REPR.maxlist = _REPR.maxtuple = _REPR.maxdict = 10


def one_line(text: str) -> str:
    """Return a text as one line, which a terminal prints as it is, for any input."""
    return visible(" ".join(text.split()))


def visible(text: str) -> str:
    """Return a text with visible control characters, such as escape sequences and marks of text direction."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() or one in "\n\xa0" else repr(one)[1:-1] for one in text)


class InputError(ValueError):
    """A value that the user gave and that cannot be used, or a missing value, which is None.

    The message is one line that names the field, the value if there is one, and what is allowed.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        self.field = field
        self.value = value
        self.allowed = allowed
        shown = field if len(field) <= _LONGEST else f"{field[:_LONGEST]}..."
        refused = "" if value is None else f"{_REPR.repr(value)} cannot be used; "
        super().__init__(one_line(f"{shown}: {refused}{allowed}"))

    def __reduce__(self) -> tuple[type["InputError"], tuple[str, object, str]]:
        """Pickle the error with its arguments."""
        return type(self), (self.field, self.value, self.allowed)
