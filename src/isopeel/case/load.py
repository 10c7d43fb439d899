"""The cases that come with the package, and those in files."""

from importlib import resources
from pathlib import Path

from isopeel.case.case import Case
from isopeel.common.errors import InputError

#: Bytes; the shipped cases have a thousand.
LARGEST_FILE = 20_000


def shipped_cases() -> tuple[str, ...]:
    """Return names of the cases that come with the package."""
    folders = resources.files("isopeel").joinpath("cases").iterdir()
    return tuple(sorted(folder.name for folder in folders if folder.is_dir() and folder.name[0] not in "._"))


def shipped_text(name: str) -> str:
    """Return the file of a shipped case. Raises InputError where there is no such case."""
    if name not in shipped_cases():
        raise InputError("NAME", name, f"the shipped cases are {', '.join(shipped_cases())}")
    return resources.files("isopeel").joinpath("cases", name, "case.toml").read_text("utf-8")


def load_case(case: str | Path) -> Case:
    """Load a shipped case by its name, or a TOML file by its path.

    Raises InputError; its field is the key's path, or CASE where the file itself cannot be used.
    """
    if case in shipped_cases():
        return Case.parse(shipped_text(str(case)))
    path = Path(case)
    try:
        # what is no file, such as a pipe, could be waited for without an end
        if not path.is_file():
            kind = "is no file" if path.exists() else "does not exist"
            allowed = f"it {kind}; give a TOML file or a shipped case: {', '.join(shipped_cases())}"
            raise InputError("CASE", str(case), allowed)
        with path.open("rb") as opened:
            content = opened.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise InputError("CASE", str(case), f"a case has at most {LARGEST_FILE} bytes")
        text = content.decode()
    except OSError as error:
        raise InputError("CASE", str(case), f"it cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        is_utf_16 = content.startswith((b"\xff\xfe", b"\xfe\xff"))
        allowed = "a TOML file is UTF-8 text; " + (
            "it is UTF-16, to be saved as UTF-8" if is_utf_16 else f"byte {error.start} is not"
        )
        raise InputError("CASE", str(case), allowed) from error
    return Case.parse(text.replace("\r\n", "\n"), str(case), path.parent)
