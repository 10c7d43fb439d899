"""Show a law of adhesion: its numbers and its figure."""

from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.case import load_case
from isopeel.common.errors import InputError
from isopeel.common.registry import discover
from isopeel.common.units import UnitSystem, shown
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.post.figures import law_figure, save
from isopeel.post.laboratory import Laboratory
from isopeel.post.law import LawCharacter, law_character
from isopeel.running.folder import check_overwritten, make_folder

LAWS = discover("isopeel.physics.adhesion")


def show_law(name: str, out: Path | None, console: Console, *, force: bool = False) -> None:
    """Print the numbers of a law, and draw it to a file.

    `name` is that of a law, which then has the strength and the work of adhesion of the shipped strip's law,
    or a case, whose law is shown. Raises InputError where it is neither, or for an unknown kind of file, and
    OSError where the file cannot be written.
    """
    law, units = _like_the_strip(name) if name in LAWS else _of_the_case(name)
    mirrored = isinstance(law, Mirrored)
    if isinstance(law, Mirrored):
        law = law.law
    path = out or Path("out") / f"{Path(name).stem}.png"
    character = law_character(law)
    check_overwritten("--out", [path], force)
    make_folder(path.parent)
    try:
        save(law_figure(law, Laboratory(units)), path)
    except InputError as error:
        raise InputError(
            "--out" if error.field == "figure" else error.field, error.value, error.allowed
        ) from error
    console.print(law_table(name, character, units))
    if mirrored:
        console.print(
            "of the whole joint, over the separation of both faces; the half that is modelled has half of its"
            " work of adhesion, over half of the separation",
            soft_wrap=True,
        )
    console.print(f"drawn in {path}", soft_wrap=True)


def _of_the_case(name: str) -> tuple[AdhesionLaw, UnitSystem]:
    try:
        case = load_case(name)
    except InputError as error:
        if error.field != "CASE":
            raise
        allowed = f"it is neither a law ({', '.join(LAWS)}) nor a case: {error.allowed}"
        raise InputError("NAME", name, allowed) from error
    return case.problem().adhesion.law, case.units.system()


def _like_the_strip(name: str) -> tuple[AdhesionLaw, UnitSystem]:
    known = law_character(load_case("strip").problem().adhesion.law)
    law: AdhesionLaw = LAWS[name].like(known.strength, known.work_of_adhesion, known.equilibrium_gap)
    return law, UnitSystem()


def law_table(name: str, character: LawCharacter, units: UnitSystem) -> Table:
    """Tabulate a law's numbers in E0 and L0, the units, and in SI units."""
    c = character
    caption = "dissipated: if the adhesion is irreversible"
    scales = f"in E0 = {shown(1.0, units, stress=1)}, L0 = {shown(1.0, units, length=1)}"
    table = Table("", scales, "", title=name, caption=caption, box=SIMPLE_HEAD)
    for label, value, stress, length in (
        ("equilibrium gap", c.equilibrium_gap, 0, 1),
        ("strength", c.strength, 1, 0),
        ("at the gap", c.strongest_gap, 0, 1),
        ("work of adhesion", c.work_of_adhesion, 1, 1),
        ("stiffness at equilibrium", c.stiffness, 1, -1),
        ("half as strong at the gap", c.softened_gap, 0, 1),
        ("  dissipated by then", c.dissipated_energy, 1, 1),
        ("  of the work so far", c.dissipated_share, 0, 0),
        ("  dissipated when parted", c.work_of_adhesion, 1, 1),
    ):
        si = shown(value, units, stress, length) if stress or length else f"{100 * value:.1f} %"
        table.add_row(label, f"{value:.6g}", si)
    return table
