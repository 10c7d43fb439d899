"""Options of the command line that set keys of a case."""

from collections.abc import Mapping, Sequence

from isopeel.case.case import Case
from isopeel.case.several_bodies import SeveralBodies
from isopeel.case.values import as_written
from isopeel.common.errors import InputError

#: Options that set one key.
_KEYS = {
    "space": "discretization.space",
    "mesh": "discretization.mesh",
    "contact_points": "discretization.contact_points",
    "fields_every": "output.fields_every",
}


def with_options(
    case: Case,
    *,
    space: str | None = None,
    mesh: str | None = None,
    to: str | float | None = None,
    step: str | float | None = None,
    traction: str | None = None,
    contact_points: int | None = None,
    path_control: str | None = None,
    fields_every: str | float | None = None,
) -> Case:
    """Return the case with other values of keys: `to`, `step` and `fields_every` those of the last stage.

    `path_control` is that of all stages, and `traction` that of all interfaces. Values are texts with units;
    plain numbers are degrees of an angle, and refused elsewhere. Raises InputError whose field is the option
    of the command line, such as --mesh.
    """
    dimension = case.drive[-1].dimension
    given = {
        "space": space,
        "mesh": mesh,
        "to": None if to is None else as_written(dimension, to),
        "step": None if step is None else as_written(dimension, step),
        "traction": traction,
        "contact_points": contact_points,
        "path_control": path_control,
        "fields_every": None if fields_every is None else as_written(dimension, fields_every),
    }
    written = {"to": to, "step": step, "fields_every": fields_every}
    chosen = {option: value for option, value in given.items() if value is not None}
    if not chosen:
        return case
    if isinstance(case, SeveralBodies):
        _check_effect(case, chosen)
    keys = {option: _keys(case, option) for option in chosen}
    try:
        return case.with_values({key: chosen[option] for option in chosen for key in keys[option]})
    except InputError as error:
        for option in chosen:
            if error.field in _blamed(option, keys[option], chosen):
                name = "control" if option == "path_control" else option.replace("_", "-")
                value = written.get(option, chosen[option])
                raise InputError(f"--{name}", value, error.allowed) from error
        raise


def _check_effect(case: SeveralBodies, chosen: Mapping[str, object]) -> None:
    """Raise InputError for an option without an effect."""
    for option in ("space", "mesh"):
        if option in chosen and case.each_has(option):
            allowed = f"each body has its own {option}; set body.1.{option} and so on instead"
            raise InputError(f"--{option}", chosen[option], allowed)
    if "traction" in chosen and not case.interface:
        raise InputError("--traction", chosen["traction"], "the case has no [[interface]]")


def _keys(case: Case, option: str) -> list[str]:
    """Return the keys that an option sets."""
    if option == "traction":
        if isinstance(case, SeveralBodies):
            return case.keys_of_tables("interface", "traction")
        return ["adhesion.traction"]
    if option in ("to", "step", "path_control"):
        keys = case.keys_of_tables("drive", option) or [f"drive.{option}"]
        return keys if option == "path_control" else keys[-1:]
    return [_KEYS[option]]


def _blamed(option: str, keys: Sequence[str], chosen: Mapping[str, object]) -> list[str]:
    """Return the keys whose error an option has caused."""
    blamed = list(keys)
    if option == "to" and "step" not in chosen:
        # it was good until the path became longer
        blamed += [key.removesuffix("to") + "step" for key in keys]
    if option in ("to", "step"):
        blamed.append("drive")  # of all stages together
    return blamed
