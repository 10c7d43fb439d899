"""Batch functions of formulas at one point: the loop over the points is written around them.

It is written as a source text, because each law has constants of its own, in any number. Loop and formulas
are compiled as one function, which takes as long as one that is written by hand.
"""

from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from inspect import signature
from typing import Any

from isopeel.common.compilation import inlined
from isopeel.physics.batch import ADHESION_SIGNATURE, SUBSTRATE_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True, eq=False)
class PointLoop:
    """A batch function as a loop over points n, which calls formulas at each of them.

    The formulas name what they need: an argument with a name in `inputs` is that entry, the others are
    constants, `parameters[first]` and so on in the order of the arguments. What they return, in the order of
    `outputs`, is written to these entries.
    """

    kind: Any  # the signature
    arguments: str
    inputs: Mapping[str, str]
    outputs: tuple[str, ...]
    first: int = 0


def constant_names(formulas: Callable[..., Any], inputs: Container[str]) -> tuple[str, ...]:
    """Names of the arguments of formulas that are none of their inputs: the constants, in their order."""
    return tuple(name for name in argument_names(formulas) if name not in inputs)


def check_arguments(formulas: Callable[..., Any], inputs: Container[str], values: Sequence[float]) -> None:
    """Raise TypeError unless there are as many values as constants: others would be read from nowhere."""
    names = constant_names(formulas, inputs)
    if len(values) != len(names):
        allowed = f"its constants are {', '.join(names) or 'none'}"
        raise TypeError(f"{formulas.__qualname__} is given {len(values)} constants; {allowed}")


#: A law T(g) of the gap g; the first parameter is the equilibrium gap.
LAW_LOOP = PointLoop(
    ADHESION_SIGNATURE,
    "gap, curvature, parameters, count, potential, traction, derivative",
    {
        "gap": "gap[n]",
        "opening": "gap[n] - parameter_0",
        "equilibrium_gap": "parameter_0",
        "curvature": "curvature[n]",
    },
    ("potential[n]", "traction[n]", "derivative[n]"),
    first=1,
)
SUBSTRATE_LOOP = PointLoop(
    SUBSTRATE_SIGNATURE,
    "position, parameters, count, gap, normal, curvature",
    {"x": "position[0, n]", "y": "position[1, n]"},
    ("gap[n]", "normal[0, n]", "normal[1, n]", "curvature[n]"),
)


def compile_points(loop: PointLoop, formulas: Callable[..., Any]) -> BatchFunction:
    """Compile a loop over points around formulas, as a function of the file that these stand in."""
    names = constant_names(formulas, loop.inputs)
    constants = {name: f"parameter_{loop.first + k}" for k, name in enumerate(names)}
    values = {**loop.inputs, **constants}
    arguments = [values[name] for name in argument_names(formulas)]
    results = [f"result_{k}" for k in range(len(loop.outputs))]
    lines = [
        f"def batch({loop.arguments}):",
        # read before the loop: arrays that are written to might overlap with the parameters
        *(f"    parameter_{k} = parameters[{k}]" for k in range(loop.first + len(constants))),
        "    for n in range(count):",
        f"        {', '.join(results)} = formulas({', '.join(arguments)})",
        *(f"        {entry} = {result}" for entry, result in zip(loop.outputs, results, strict=True)),
    ]
    return compile_text(loop.kind, "\n".join(lines), {"formulas": inlined(formulas)}, formulas)


@cache
def argument_names(formulas: Callable[..., Any]) -> tuple[str, ...]:
    """Names of the arguments of some formulas."""
    return tuple(signature(formulas).parameters)


def compile_text(kind: Any, text: str, names: Mapping[str, Any], origin: Callable[..., Any]) -> BatchFunction:
    """Compile the function `batch` of a source text, which may use the `names`, for a signature.

    The function is cached by the file, name and line of `origin`, the formulas that the text was written for.
    It is not cached if these depend on variables of another function, or stand in no file.
    """
    namespace = dict(names)
    exec(text, namespace)
    function = namespace["batch"]
    code = origin.__code__
    function.__code__ = function.__code__.replace(
        co_filename=code.co_filename, co_firstlineno=code.co_firstlineno
    )
    function.__module__, function.__qualname__ = origin.__module__, origin.__qualname__
    return compile_batch(kind, function, cache=origin.__closure__ is None)
