"""The commands that show stored runs, shipped cases, spaces and laws."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from isopeel.cli import completion
from isopeel.cli.base import COMPLETED, command, console, fail
from isopeel.common.errors import InputError
from isopeel.common.interrupts import INTERRUPTED, reporting

_ForceOption = Annotated[
    bool, typer.Option("--force", help="Replace a file of the same name that isopeel did not write.")
]

_FormatOption = Annotated[
    str,
    typer.Option(
        "--format",
        metavar="png|svg|pdf",
        help="Kind of file.",
        autocompletion=completion.one_of("png", "svg", "pdf"),
    ),
]


@command
def plot(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of one of its stages.")],
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PART",
            help="Figure: curve, plateau, shapes, front or tractions; repeatable. Default: all.",
            autocompletion=completion.one_of("curve", "plateau", "shapes", "front", "tractions"),
        ),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="VALUE",
            help="Parameter of a state to show, with its unit, such as '20 nm'; a plain number is in "
            "degrees; repeatable.",
        ),
    ] = None,
    suffix: _FormatOption = "png",
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the figures; DIR/figures by default.")
    ] = None,
    force: _ForceOption = False,
) -> int:
    """Draw the figures of a stored run: its curve and plateau, deformed shapes, front and tractions."""
    from isopeel.output.plot import plot_run

    plot_run(folder, only or [], at or [], suffix, out, console(), force=force)
    return COMPLETED


@command
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of a stage of one.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File of the page; DIR/report.html by default.")
    ] = None,
    force: _ForceOption = False,
) -> int:
    """Write one HTML page of a run, with its curve, shapes, front and tractions."""
    from isopeel.html_report.write import write_html_report

    console().print(f"the report is {write_html_report(folder, out, force=force)}", soft_wrap=True)
    return COMPLETED


@command
def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run.")],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the files; DIR/paraview by default.")
    ] = None,
    linear: Annotated[
        int | None,
        typer.Option(metavar="N", help="Write N x N straight cells for each element, not Bezier cells."),
    ] = None,
    force: _ForceOption = False,
) -> int:
    """Write the fields of a run for ParaView, as Bezier cells, which represent curved shapes exactly."""
    message = "interrupted; the same command writes all files again"
    try:
        with reporting(message):
            from isopeel.output.export import export_run

            export_run(folder, out, linear, console(), force=force)
    except KeyboardInterrupt:
        return fail(INTERRUPTED, message)
    return COMPLETED


@command
def compare(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR...", help="Folders of two or more runs, or stages of runs.")
    ],
    suffix: _FormatOption = "png",
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the table and the figure.")] = Path(
        "out/compare"
    ),
    force: _ForceOption = False,
) -> int:
    """Compare stored runs: draw their curves in one figure, and write a table of their results."""
    from isopeel.output.compare import compare_runs

    compare_runs(folders, suffix, out, console(), force=force)
    return COMPLETED


@command
def animate(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of one of its stages.")],
    suffix: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="mp4|gif",
            help="Kind of file.",
            autocompletion=completion.one_of("mp4", "gif"),
        ),
    ] = "mp4",
    fps: Annotated[
        float | None,
        typer.Option(metavar="N", help="Stored states per second; by default for a few seconds in all."),
    ] = None,
    size: Annotated[str, typer.Option(metavar="WxH", help="Width and height in pixels.")] = "1280x600",
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the file; DIR/figures by default.")
    ] = None,
    force: _ForceOption = False,
) -> int:
    """Animate a stored run: the deformed body, and the curve with a moving mark."""
    from isopeel.output.animate import animate_run

    animate_run(folder, suffix, fps, size, out, console(), force=force)
    return COMPLETED


@command
def view(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of one of its stages.")],
    at: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE",
            help="Parameter of the state to begin with, with its unit; a plain number is in degrees.",
        ),
    ] = None,
    screenshot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a PNG picture instead of opening a window.")
    ] = None,
    force: _ForceOption = False,
) -> int:
    """Show the deformed body of a stored run in a window, with a slider (needs the extra "view")."""
    from isopeel.output.view import view_run

    view_run(folder, at, screenshot, console(), force=force)
    return COMPLETED


@command
def cases(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME", help="A shipped case, whose file is printed.", autocompletion=completion.shipped
        ),
    ] = None,
    copy: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Write the case to FILE, which must not exist, to change it there."
        ),
    ] = None,
) -> int:
    """List the shipped cases, or print or copy one of them."""
    from isopeel.output.cases import cases_table, copy_case

    if name is None:
        if copy is not None:
            raise InputError("NAME", None, "the name of a shipped case is needed; `isopeel cases` lists them")
        console().print(cases_table())
    else:
        copy_case(name, copy, console())
    return COMPLETED


@command
def new(
    test: Annotated[
        str | None,
        typer.Argument(
            metavar="TEST",
            help="tape, t-peel, double-cantilever or film.",
            autocompletion=completion.one_of("tape", "t-peel", "double-cantilever", "film"),
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File of the case, which must not exist; TEST.toml by default."),
    ] = None,
    thickness: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Thickness of the tape, layer or arm.")
    ] = None,
    modulus: Annotated[str | None, typer.Option(metavar="VALUE", help="Young's modulus.")] = None,
    poissons_ratio: Annotated[str | None, typer.Option(metavar="NUMBER", help="Poisson's ratio.")] = None,
    force: Annotated[
        str | None,
        typer.Option(metavar="VALUE", help="Peel force of a tape's data sheet, such as '5 N/25 mm'."),
    ] = None,
    force_angle: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Angle at which that force was measured.")
    ] = None,
    angle: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Angle at which the tape is pulled.")
    ] = None,
    work: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Work of adhesion; of all but tapes.")
    ] = None,
    crack: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Crack of a double cantilever at the start.")
    ] = None,
    strength: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Strength of the joint; chosen if it is not given.")
    ] = None,
    width: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Width of the specimen, for forces in N.")
    ] = None,
) -> int:
    """Write a case from what a data sheet has. Without an option, a terminal asks for its value."""
    from isopeel.output.asked import write_new_case

    options = {
        "thickness": thickness,
        "modulus": modulus,
        "poissons_ratio": poissons_ratio,
        "force": force,
        "force_angle": force_angle,
        "angle": angle,
        "work": work,
        "crack": crack,
        "strength": strength,
        "width": width,
    }
    given = {name: value for name, value in options.items() if value is not None}
    ask = (lambda text, usual: str(typer.prompt(text, default=usual))) if sys.stdin.isatty() else None
    write_new_case(test, given, out, console(), ask)
    return COMPLETED


@command
def help(
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="KEY",
            help="A key, such as body.height or height, a table, or a kind such as bilinear.",
            autocompletion=completion.keys,
        ),
    ] = None,
) -> int:
    """Show what the keys of a case mean: value, default, range and an example."""
    from isopeel.output.key_reference import show_help

    show_help(key, console())
    return COMPLETED


@command
def schema() -> int:
    """Print the JSON schema of case files, with which editors complete and check them."""
    from isopeel.case.schema import case_schema

    typer.echo(json.dumps(case_schema(), indent=1))
    return COMPLETED


@command
def spaces(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="A spline space, such as N2.1 or L1+N2@2.",
            autocompletion=completion.spaces,
        ),
    ],
    mesh: Annotated[str, typer.Option(metavar="NXxNY", help="Elements, to count DOFs.")] = "200x10",
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File of the figure; out/NAME.png by default.")
    ] = None,
    force: _ForceOption = False,
) -> int:
    """Draw the functions of a spline space, and print their degree, continuity, support and number."""
    from isopeel.output.spaces import show_space

    show_space(name, mesh, out, console(), force=force)
    return COMPLETED


@command
def law(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="A law, such as exponential, or a case whose law is shown.",
            autocompletion=completion.laws,
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File of the figure; out/NAME.png by default.")
    ] = None,
    force: _ForceOption = False,
) -> int:
    """Draw a law of adhesion, and print its strength, work of adhesion and stiffness."""
    from isopeel.output.law import show_law

    show_law(name, out, console(), force=force)
    return COMPLETED
