"""The command that fits parameters of a case to measured curves."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from isopeel.cli.base import COMPLETED, command, console, fail
from isopeel.cli.messages import QuietOption
from isopeel.common.errors import InputError
from isopeel.common.interrupts import INTERRUPTED, reporting

if TYPE_CHECKING:
    from isopeel.identification.fit_file import Fit

_PARAMETER = "it is KEY=START or KEY=START:LOW:HIGH, such as material.youngs_modulus='2 GPa:1 GPa:4 GPa'"


@command
def fit(
    case: Annotated[
        str,
        typer.Argument(metavar="FIT|CASE", help="The TOML file of a fit; or a case, with measured curves."),
    ],
    measured: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[MEASURED]...", help="CSV files, with units in their headings."),
    ] = None,
    parameter: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=START[:LOW:HIGH]",
            help="A key of CASE to fit, such as material.youngs_modulus='2 GPa:1 GPa:4 GPa'. Repeatable.",
        ),
    ] = None,
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE",
            help="Standard deviation of a measured value: '1 %' of the largest one, or with a unit.",
        ),
    ] = None,
    assigned: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Set a key of CASE for all runs. Repeatable."),
    ] = None,
    starts: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Starts of the search between the bounds.")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, metavar="N", help="Seed of the starts.")] = None,
    profile: Annotated[
        str | None, typer.Option(metavar="KEY", help="A parameter whose profile likelihood is computed.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the results; out/NAME by default.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write to DIR even if it has other files; these remain.")
    ] = False,
    quiet: QuietOption = False,
) -> int:
    """Fit parameters of a case to measured curves, and write values, errors, figures and a report.

    Finished runs are stored, so that the same command continues an interrupted fit.
    """
    options: dict[str, Any] = {"starts": starts, "seed": seed, "profile": profile}
    search = {name: value for name, value in options.items() if value is not None}
    chosen = _chosen(case, measured or [], parameter or [], noise, assigned or [], search)
    folder = out or Path("out") / chosen.name
    stored = f"finished runs are in {folder}; the same command continues the fit"
    try:
        from isopeel.running.warm_up import warmed_up_beside

        with reporting(f"interrupted; {stored}"), warmed_up_beside():
            from isopeel.identification.run import run_fit

            words = [case, *map(str, measured or [])]
            for name, values in (("parameter", parameter), ("set", assigned)):
                words += [word for value in values or [] for word in (f"--{name}", value)]
            for name, value in {"noise": noise, **search}.items():
                words += [] if value is None else [f"--{name}", str(value)]
            run_fit(
                chosen, folder, console(quiet=quiet), force=force, command=f"isopeel fit {shlex.join(words)}"
            )
    except KeyboardInterrupt:
        return fail(INTERRUPTED, f"interrupted; {stored}")
    console(quiet=quiet).print(f"the report is {folder / 'report.html'}", soft_wrap=True)
    return COMPLETED


def _chosen(
    case: str,
    measured: list[Path],
    parameters: list[str],
    noise: str | None,
    assigned: list[str],
    search: dict[str, Any],
) -> "Fit":
    """Return the fit of a file, or of a case, measured curves and options. Raises InputError."""
    from isopeel.case import assignment, load_case
    from isopeel.identification.fit_file import fit_of, load_fit

    if not measured:
        for option, value in (
            ("--parameter", parameters),
            ("--noise", noise),
            ("--set", assigned),
            ("--starts", search),
        ):
            if value:
                allowed = "options are for CASE and MEASURED; the file of a fit has keys for them"
                raise InputError(option if option != "--starts" else f"--{next(iter(search))}", None, allowed)
        return load_fit(Path(case))
    if not parameters:
        raise InputError("--parameter", None, f"at least one is needed; {_PARAMETER}")
    table: dict[str, Any] = {} if noise is None else {"noise": noise}
    return fit_of(
        {
            "name": f"fit-{load_case(case).name}"[:100],
            "case": case,
            "set": dict(assignment(text) for text in assigned),
            "measured": [{"file": str(path), **table} for path in measured],
            "parameter": [_parameter(text) for text in parameters],
            "search": search,
        }
    )


def _parameter(text: str) -> dict[str, Any]:
    """Read KEY=START[:LOW:HIGH]. Raises InputError."""
    key, equals, written = text.partition("=")
    words = [word.strip() for word in written.split(":")]
    if not equals or not key.strip() or len(words) not in (1, 3) or not all(words):
        raise InputError("--parameter", text, _PARAMETER)
    values: list[str | float] = []
    for word in words:
        try:
            values.append(float(word))
        except ValueError:
            values.append(word)
    return {"key": key.strip(), **dict(zip(("start", "lower", "upper"), values, strict=False))}
