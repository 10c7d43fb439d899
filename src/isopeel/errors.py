"""What can go wrong, as a user meets it: one clear line each."""


class InputError(ValueError):
    """A value that the user gave and that cannot be used.

    The message is one line that names the field, the value and what is allowed.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        self.field = field
        self.value = value
        self.allowed = allowed
        super().__init__(" ".join(f"{field}: {value!r} cannot be used; {allowed}".split()))

    def __reduce__(self) -> tuple[type["InputError"], tuple[str, object, str]]:
        """Go from process to process with its parts."""
        return type(self), (self.field, self.value, self.allowed)
