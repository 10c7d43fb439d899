"""Print the numbers of an adhesion law, and draw it."""

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
from isopeel.running.folder import check_overwritten, make_folder, part_of_name

LAWS = discover("isopeel.physics.adhesion")


def show_law(name: str, out: Path | None, console: Console, *, force: bool = False) -> None:
    """Print the numbers of a law, and draw it to a file.

    `name` is that of a law, which then has the strength and the work of adhesion of the law of the shipped
    strip; or that of a case, whose law is shown. If the case has several interfaces, each has its own table
    and file. Raises InputError if the name is neither, or for an unknown kind of file, and OSError if the
    file cannot be written.
    """
    laws, units = _like_the_strip(name) if name in LAWS else _of_the_case(name)
    path = out or Path("out") / f"{Path(name).stem}.png"
    paths = [path]
    if len(laws) > 1:
        parts = [part_of_name(one, list(laws)) for one in laws]
        paths = [path.with_name(f"{path.stem}-{part}{path.suffix}") for part in parts]
    characters = [law_character(_whole(law)) for law in laws.values()]
    check_overwritten("--out", paths, force)
    make_folder(path.parent)
    for (title, law), character, file in zip(laws.items(), characters, paths, strict=True):
        try:
            save(law_figure(_whole(law), Laboratory(units)), file)
        except InputError as error:
            raise InputError(
                "--out" if error.field == "figure" else error.field, error.value, error.allowed
            ) from error
        console.print(law_table(title, character, units))
        if isinstance(law, Mirrored):
            console.print(
                "these values are those of the whole joint, over the separation of both faces; the modelled"
                " half has half of the work of adhesion, and half of the separation",
                soft_wrap=True,
            )
        console.print(f"drawn in {file}", soft_wrap=True)


def _whole(law: AdhesionLaw) -> AdhesionLaw:
    """Return the law of the whole joint."""
    return law.law if isinstance(law, Mirrored) else law


def _of_the_case(name: str) -> tuple[dict[str, AdhesionLaw], UnitSystem]:
    """Return the laws of a case by their titles: its name, or those of its interfaces."""
    try:
        case = load_case(name)
    except InputError as error:
        if error.field != "CASE":
            raise
        allowed = f"it is neither a law ({', '.join(LAWS)}) nor a case: {error.allowed}"
        raise InputError("NAME", name, allowed) from error
    problem = case.problem()
    laws = {interface: one.law for interface, one in zip(problem.interface_names, problem.faces, strict=True)}
    if not laws:
        raise InputError("NAME", name, "the case has no interface, so it has no law")
    return {name: next(iter(laws.values()))} if len(laws) == 1 else laws, case.units.system()


def _like_the_strip(name: str) -> tuple[dict[str, AdhesionLaw], UnitSystem]:
    known = law_character(load_case("strip").problem().adhesion.law)
    law: AdhesionLaw = LAWS[name].like(known.strength, known.work_of_adhesion, known.equilibrium_gap)
    return {name: law}, UnitSystem()


def law_table(name: str, character: LawCharacter, units: UnitSystem) -> Table:
    """Tabulate a law's numbers in E0 and L0, the units, and in SI units."""
    c = character
    caption = "dissipated: only if the adhesion is irreversible"
    scales = f"in E0 = {shown(1.0, units, stress=1)}, L0 = {shown(1.0, units, length=1)}"
    table = Table("", scales, "", title=name, caption=caption, box=SIMPLE_HEAD)
    for label, value, stress, length in (
        ("equilibrium gap", c.equilibrium_gap, 0, 1),
        ("strength", c.strength, 1, 0),
        ("gap at the strength", c.strongest_gap, 0, 1),
        ("work of adhesion", c.work_of_adhesion, 1, 1),
        ("stiffness at equilibrium", c.stiffness, 1, -1),
        ("gap at half of the strength", c.softened_gap, 0, 1),
        ("  dissipated energy there", c.dissipated_energy, 1, 1),
        ("  dissipated / work there", c.dissipated_share, 0, 0),
        ("dissipated after separation", c.work_of_adhesion, 1, 1),
    ):
        si = shown(value, units, stress, length) if stress or length else f"{100 * value:.1f} %"
        table.add_row(label, f"{value:.6g}", si)
    return table
