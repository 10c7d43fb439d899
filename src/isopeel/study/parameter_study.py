"""A study in Python: a case, its factors and the design as arguments in place of a file."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from isopeel.case import Case, load_case
from isopeel.common.errors import InputError
from isopeel.common.processes import cores
from isopeel.study.design import Method
from isopeel.study.on_dask import executor_of
from isopeel.study.run import compute_study, run_study
from isopeel.study.study import Study
from isopeel.study.study_file import read_study, study_of_case
from isopeel.study.table import StudyResults


class ParameterStudy(Study):
    """A study that can be computed. Make one with `parameter_study`, or with `load_study` from a file."""

    def run(
        self,
        out: str | Path | None = None,
        *,
        client: object = None,
        workers: int | None = None,
        force: bool = False,
        verbose: bool = False,
    ) -> StudyResults:
        """Compute the runs, and return their results.

        With a folder `out`, finished runs are stored in it, those that it has are not computed again, and
        tables, figures and a report are written there, as by `isopeel study`. Without it there are no files.

        `client` is a client of Dask's `distributed`, or the address of a scheduler. Without it, the runs are
        computed in `workers` processes of this machine, by default one for each core. `verbose` prints what
        the command prints. Raises InputError and OSError as `isopeel.study.run.run_study`.
        """
        if not (client is None or isinstance(client, str) or hasattr(client, "submit")):
            allowed = "a client of Dask, or the address of a scheduler, is needed"
            raise InputError("client", repr(client), allowed)
        if workers is not None and workers < 1:
            raise InputError("workers", workers, "a whole number from 1 on is needed")
        console = Console(quiet=not verbose)
        executor = executor_of(
            "processes" if client is None else client,
            workers or cores(),
            partial(console.print, soft_wrap=True),
            "client",
        )
        if out is None:
            return compute_study(self, None, console, executor)
        return run_study(self, Path(out), console, executor, force=force)


def load_study(path: str | Path) -> ParameterStudy:
    """Read the file of a study. Raises InputError, whose field is the key, or STUDY for the file itself."""
    return ParameterStudy(**vars(read_study(Path(path))))


def parameter_study(
    case: Case | str | Path,
    factors: Mapping[str, Any],
    *,
    values: Mapping[str, Any] | None = None,
    method: Method = "grid",
    count: int | None = None,
    seed: int = 0,
    outputs: Sequence[str] = (),
    name: str | None = None,
) -> ParameterStudy:
    """Return the study of a case, of a shipped case, or of a case file.

    `factors` gives for each key a sequence of values, or a table as [[factor]] in the file of a study has
    it, such as `{"from": "1 nm", "to": "4 nm", "count": 4}`. `values` are other values of keys in all runs,
    as `set` in the file; `method`, `count` and `seed` are those of its table [design]. The name is that of
    the case by default. Raises InputError, whose field is the key in the file.

    >>> study = parameter_study("tape-angle", {"drive.angle": ["60 deg", "90 deg"]})
    >>> [point["drive.angle"] for point in study.points]
    ['60 deg', '90 deg']
    """
    base = case if isinstance(case, Case) else load_case(case)
    document = {
        "name": base.name if name is None else name,
        "set": _plain(dict(values or {})),
        "factor": [{"key": key, **_factor(given)} for key, given in factors.items()],
        "design": {"method": method, "count": _plain(count), "seed": _plain(seed)},
        "outputs": tuple(outputs),
    }
    return ParameterStudy(**vars(study_of_case(document, base)))


def _factor(given: object) -> dict[str, Any]:
    """Return the table of a factor without its key; what is no sequence of values is refused later."""
    if isinstance(given, Mapping):
        return {str(name): _plain(value) for name, value in given.items()}
    if isinstance(given, Iterable) and not isinstance(given, str):
        return {"values": _plain(list(given))}
    return {"values": given}


def _plain(value: object) -> Any:
    """Return a value with Python's own numbers in place of those of NumPy."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    return value
