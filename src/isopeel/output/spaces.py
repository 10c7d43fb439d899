"""Print the rows of a spline space, and draw its functions."""

from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.case import parse_mesh
from isopeel.common.errors import InputError
from isopeel.post.figures import save, space_figure
from isopeel.running.folder import check_overwritten, make_folder
from isopeel.splines.names import SplineFamily, parse_space_name
from isopeel.splines.rows import RowSpace, row_space


def show_space(name: str, mesh: str, out: Path | None, console: Console, *, force: bool = False) -> None:
    """Print the rows of a space on a mesh, and draw its functions to a file.

    Raises InputError for an invalid name, mesh or kind of file, OSError where the file cannot be written.
    """
    try:
        space = row_space(name, parse_mesh("--mesh", mesh))
        path = out or Path("out") / f"{space.name}.png"
        check_overwritten("--out", [path], force)
        make_folder(path.parent)
        save(space_figure(space), path)
    except InputError as error:
        field = {"space": "NAME", "mesh": "--mesh", "figure": "--out"}.get(error.field, error.field)
        raise InputError(field, error.value, error.allowed) from error
    console.print(space_table(space))
    console.print(f"a displacement field has {2 * space.size} DOFs on {mesh} elements")
    console.print(f"drawn in {path}", soft_wrap=True)


def space_table(space: RowSpace) -> Table:
    """Tabulate the kinds of rows of a space, from the contact upwards, and the functions across them."""
    name = parse_space_name(space.name)
    across = SplineFamily(space.across.degree, space.across.degree - 1)
    along, height = space.elements
    headings = ("", "rows", "degree", "continuity", "support", "functions", "DOFs")
    table = Table(*headings, title=space.name, box=SIMPLE_HEAD)
    contact = space.rows[: name.contact_rows]
    for place, family, rows in (
        ("contact", name.contact, contact),
        ("bulk" if contact else "all", name.bulk, space.rows[len(contact) :]),
    ):
        if rows:
            functions = sum(row.size for row in rows)
            table.add_row(place, str(len(rows)), *_family(family, along), str(functions), str(2 * functions))
    table.add_row("across", "", *_family(across, height), str(space.across.size), "")
    return table


def _family(family: SplineFamily, elements: int) -> tuple[str, str, str]:
    # the support spans degree + 2 knots, with degree - continuity knots at each breakpoint
    support = min(family.degree // (family.degree - family.continuity) + 1, elements)
    return str(family.degree), f"C{family.continuity}", f"{support} element{'s' * (support > 1)}"
