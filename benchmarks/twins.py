"""Fits of curves that were computed with known values and noise of 1 %: how often are the errors right?"""

from collections.abc import Mapping
from time import perf_counter
from typing import Annotated, Any

import numpy as np
import typer
from scipy.stats import binom

import isopeel
import machine
from isopeel.running.in_memory import traced_stages
from printing import plain_table, wide_console

NOISE = 0.01
POINTS = 300
EXPONENTIAL = {
    "law": "exponential",
    "strength": "40 MPa",
    "work_of_adhesion": "0.02 J/m^2",
    "length": "150 nm",
}
#: Of low strength, so that the curve depends on the form of the law.
TRAPEZOIDAL = EXPONENTIAL | {"law": "trapezoidal", "strength": "10 MPa", "rise": 0.2, "plateau": 0.3}
SETTINGS = {"discretization.mesh": "80x2", "drive.to": "60 deg", "drive.step": "1 deg", "reading": None}
WORK, STRENGTH, MODULUS, PLATEAU = (
    "adhesion.work_of_adhesion",
    "adhesion.strength",
    "material.youngs_modulus",
    "adhesion.plateau",
)
#: Each search begins well away from the true values.
STARTS = {WORK: "0.03 J/m^2", STRENGTH: "20 MPa", MODULUS: "1.6 GPa", PLATEAU: (0.4, 0.02, 0.75)}
#: The experiments: a law, and the parameters that are fitted.
EXPERIMENTS: Mapping[str, tuple[Mapping[str, Any], tuple[str, ...]]] = {
    "W and strength": (EXPONENTIAL, (WORK, STRENGTH)),
    "W, strength and E": (EXPONENTIAL, (WORK, STRENGTH, MODULUS)),
    "a law of three constants": (TRAPEZOIDAL, (WORK, STRENGTH, PLATEAU)),
}


def main(
    seeds: Annotated[int, typer.Option(min=1, help="Noises of each experiment.")] = 40,
    only: Annotated[str, typer.Option(help="The beginning of the name of an experiment.")] = "",
) -> None:
    """Print the share of parameters whose true value is within two standard errors; of noise it is 95 %."""
    console = wide_console()
    table = plain_table(
        f"twin experiments, {seeds} seeds, noise of {100 * NOISE:g} %, {POINTS} points",
        *(
            "experiment",
            "parameter",
            "within 2\nerrors",
            "mean\nerror [%]",
            "mean\ndeviation [errors]",
            "evaluations",
            "s",
        ),
        caption="mean error: the standard error, as a part of the value; mean deviation: of the value from\n"
        "the true one, in standard errors; evaluations and s: of one fit, in the mean",
    )
    inside, whole = 0, 0
    for name, (law, keys) in EXPERIMENTS.items():
        if not name.startswith(only):
            continue
        case = isopeel.load_case("strip").with_values({"adhesion": law, **SETTINGS})
        ((one, run),) = traced_stages(case)
        curve = one.laboratory.curve(run.curve)
        x = np.linspace(0.5, 60.0, POINTS)
        exact = np.interp(x, curve.parameter, curve.reaction)
        fits, began = [], perf_counter()
        for seed in range(seeds):
            noise = NOISE * exact.max() * np.random.default_rng(seed).standard_normal(POINTS)
            measured = isopeel.Measured("twin", ("rotation", "moment"), ("deg", "N m/m"), x, exact + noise)
            start: dict[str, Any] = {key: STARTS[key] for key in keys}
            fits.append(isopeel.fit(case, measured, start, noise=f"{100 * NOISE} %"))
        seconds = (perf_counter() - began) / seeds
        for number, key in enumerate(keys):
            fitted = [found.parameters[number] for found in fits]
            true = float(str(case.value(key)).split()[0])
            off = np.array([(found.value - true) / found.standard_error for found in fitted])
            within = int(np.count_nonzero(np.abs(off) <= 2))
            inside, whole = inside + within, whole + seeds
            table.add_row(
                "" if number else name,
                key,
                f"{within} of {seeds}",
                f"{100 * np.nanmean([found.relative_error for found in fitted]):.2g}",
                f"{np.nanmean(off):+.2f}",
                "" if number else f"{np.mean([found.starts[0].evaluations for found in fits]):.1f}",
                "" if number else f"{seconds:.1f}",
            )
    console.print(table)
    low, high = (binom.ppf(share, whole, 0.9545) / whole for share in (0.005, 0.995))
    console.print(
        f"{inside} of {whole}, {100 * inside / whole:.1f} %; of as many independent ones 99 % of all"
        f" experiments have {100 * low:.1f} to {100 * high:.1f} %",
        soft_wrap=True,
    )
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    typer.run(main)
