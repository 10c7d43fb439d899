"""A law of adhesion, told and drawn."""

from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.case import load_case
from isopeel.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.post.figures import law_figure, save
from isopeel.post.law import LawCharacter, law_character
from isopeel.registry import discover
from isopeel.units import E0

_GIGAPASCAL = float(E0) / 1e9
LAWS = discover("isopeel.physics.adhesion")


def show_law(name: str, out: Path | None, console: Console) -> None:
    """Print the numbers of a law, and draw it to a file.

    `name` is that of a law, which then has the strength and the work of adhesion of the shipped strip's, or
    a case, whose law is shown. Raises InputError for what is neither, or a kind of file that cannot be
    drawn, OSError where the file cannot be written.
    """
    law = _like_the_strip(name) if name in LAWS else _of_the_case(name)
    path = out or Path("out") / f"{Path(name).stem}.png"
    character = law_character(law)
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        save(law_figure(law), path)
    except InputError as error:
        raise InputError(
            "--out" if error.field == "figure" else error.field, error.value, error.allowed
        ) from error
    console.print(law_table(name, character))
    console.print(f"drawn in {path}", soft_wrap=True)


def _of_the_case(name: str) -> AdhesionLaw:
    try:
        return load_case(name).problem().adhesion.law
    except InputError as error:
        if error.field != "CASE":
            raise
        allowed = f"it is neither a law ({', '.join(LAWS)}) nor a case: {error.allowed}"
        raise InputError("NAME", name, allowed) from error


def _like_the_strip(name: str) -> AdhesionLaw:
    known = law_character(load_case("strip").problem().adhesion.law)
    law: AdhesionLaw = LAWS[name].like(known.strength, known.work_of_adhesion, known.equilibrium_gap)
    return law


def law_table(name: str, character: LawCharacter) -> Table:
    """Tabulate a law's numbers in E0 = 2 GPa and L0 = 1 nm, and in SI units."""
    c = character
    caption = "dissipated: if the adhesion is irreversible"
    table = Table("", "in E0, L0", "", title=name, caption=caption, box=SIMPLE_HEAD)
    for label, value, si in (
        ("equilibrium gap", c.equilibrium_gap, f"{c.equilibrium_gap:.5g} nm"),
        ("strength", c.strength, f"{1e3 * _GIGAPASCAL * c.strength:.5g} MPa"),
        ("at the gap", c.strongest_gap, f"{c.strongest_gap:.5g} nm"),
        ("work of adhesion", c.work_of_adhesion, f"{_GIGAPASCAL * c.work_of_adhesion:.5g} J/m^2"),
        ("stiffness at equilibrium", c.stiffness, f"{_GIGAPASCAL * c.stiffness:.5g} GPa/nm"),
        ("half as strong at the gap", c.softened_gap, f"{c.softened_gap:.5g} nm"),
        ("  dissipated by then", c.dissipated_energy, f"{_GIGAPASCAL * c.dissipated_energy:.5g} J/m^2"),
        ("  of the work so far", c.dissipated_share, f"{100 * c.dissipated_share:.1f} %"),
        ("  dissipated when parted", c.work_of_adhesion, f"{_GIGAPASCAL * c.work_of_adhesion:.5g} J/m^2"),
    ):
        table.add_row(label, f"{value:.6g}", si)
    return table
