"""Case files for property-based tests: parts that fit together, and what may be written in their place."""

import json
import math
import os
from pathlib import Path
from typing import Any

import tomli_w
from hypothesis import strategies as st

BODIES: list[dict[str, Any]] = [
    {"shape": "strip", "length": "200 nm", "height": "10 nm"},
    {"length": "0.2 µm", "height": "1e-8 m"},
    {"shape": "tapered-strip", "length": "200 nm", "height": "10 nm", "end_height": "5 nm"},
    {"shape": "curved-strip", "length": "100 nm", "height": "5 nm", "radius": "300 nm", "bends": "up"},
    {"shape": "curved-strip", "length": "100 nm", "height": "5 nm", "radius": "300 nm", "bends": "down"},
    {"shape": "half-cylinder", "radius": "20 nm"},
    {"shape": "quarter-cylinder", "radius": "20 nm"},
    {"shape": "patch", "file": "patch.json", "unit_length": "10 nm"},
]
#: Control points of a patch, and its weights; the last ones are degenerate.
_PATCHES: dict[str, tuple[list[list[float]], list[float] | None]] = {
    "patch": ([[0, 0], [10, 0], [0, 1], [10, 1]], None),
    "light": ([[0, 0], [10, 0], [0, 1], [10, 1]], [1, 1e-300, 1, 1]),
    "heavy": ([[0, 0], [10, 0], [0, 1], [10, 1]], [1, 1e300, 1, 1]),
    "steep": ([[0, 0], [10, 0], [0, 1], [10, 1]], [1, 1e-5, 1, 1]),
    "point": ([[0, 0], [10, 0], [0, 0], [10, 1]], None),
    "thin": ([[0, 0], [10, 0], [0, 1e-9], [10, 1e-9]], None),
    "folded": ([[0, 0], [10, 0], [10, 1], [0, 1]], None),
    "inside out": ([[0, 1], [10, 1], [0, 0], [10, 0]], None),
    "endless": ([[0, 0], [1e308, 0], [0, 1], [10, 1]], None),
}


def lay_files(folder: Path) -> None:
    """Write the files that cases name to a folder: patches, a pipe, and links."""
    for name, (points, weights) in _PATCHES.items():
        spline = {"para_dim": 2, "dim": 2, "degrees": [1, 1], "control_points": points}
        spline |= (
            {"SplineType": "Bezier"}
            if weights is None
            else {"SplineType": "RationalBezier", "weights": weights}
        )
        (folder / f"{name}.json").write_text(json.dumps({"SplineList": [spline]}))
    (folder / "link.json").symlink_to("patch.json")
    (folder / "dangling.json").symlink_to("nowhere")
    os.mkfifo(folder / "pipe.json")


MATERIALS: list[dict[str, Any]] = [
    {"law": "neo-hooke", "youngs_modulus": "2 GPa", "poissons_ratio": 0.2},
    {"law": "neo-hooke", "youngs_modulus": "2 GPa", "poissons_ratio": 0.2, "prestretch": 1.05},
    {"law": "saint-venant-kirchhoff", "youngs_modulus": "2000 N/mm^2", "poissons_ratio": 0.45},
    {"law": "mooney-rivlin", "c10": "200 MPa", "c01": "50 MPa", "bulk_modulus": "2 GPa"},
    {"law": "yeoh", "c10": "200 MPa", "c20": "-1 MPa", "c30": "1 MPa", "bulk_modulus": "2 GPa"},
    {
        "law": "formula",
        "energy": "mu/2*(I1 - 3 - 2*log(J)) + la/2*log(J)**2",
        "constants": {"mu": "1 GPa", "la": "1 GPa"},
    },
]
LAWS: list[dict[str, Any]] = [
    {"law": "van-der-waals", "hamaker_constant": "1e-19 J", "equilibrium_distance": "0.4 nm"},
    {"law": "exponential", "strength": "50 MPa", "work_of_adhesion": "0.03 J/m^2"},
    {"law": "exponential", "strength": "50 MPa", "work_of_adhesion": "0.03 J/m^2", "irreversible": True},
    {"law": "bilinear", "strength": "50 MPa", "work_of_adhesion": "0.03 J/m^2", "rise": 0.2},
    {"law": "dugdale", "strength": "50 MPa", "work_of_adhesion": "0.03 J/m^2", "transition": 0.2},
    {
        "law": "trapezoidal",
        "strength": "50 MPa",
        "work_of_adhesion": "0.03 J/m^2",
        "rise": 0.2,
        "plateau": 0.3,
    },
    {"law": "lennard-jones", "work_of_adhesion": "0.03 J/m^2", "equilibrium_gap": "0.25 nm"},
    {
        "law": "formula",
        "potential": "W*((s/r)**8/3 - 4/3*(s/r)**2)",
        "constants": {"W": "0.03 J/m^2", "s": "0.25 nm"},
    },
]
SUBSTRATES: list[dict[str, Any]] = [
    {},
    {"kind": "flat"},
    {"kind": "flat", "gap": "0.5 nm"},
    {"kind": "circle", "radius": "400 nm"},
    {"kind": "circle", "radius": "400 nm", "solid": "outside"},
    {"kind": "wavy", "amplitude": "0.2 nm", "wavelength": "50 nm"},
    {"kind": "formula", "formula": "a*cos(x/l)", "constants": {"a": "0.1 nm", "l": "30 nm"}},
]
DRIVES: list[Any] = [
    {},
    {"kind": "rotation", "to": "4 deg", "step": "1 deg"},
    {"kind": "rotation", "to": "0.05 rad", "step": "0.02 rad", "jumps": True},
    {"kind": "displacement", "side": "right", "angle": "90 deg", "to": "1 nm", "step": "0.3 nm"},
    {
        "kind": "displacement",
        "side": "top",
        "angle": "90 deg",
        "to": "-0.1 nm",
        "step": "0.05 nm",
        "transverse": "held",
    },
    {"kind": "force", "side": "right", "angle": "60 deg", "to": "1 nm", "step": "0.5 nm", "follows": True},
    {
        "kind": "force",
        "control": "force",
        "side": "top",
        "angle": "90 deg",
        "to": "0.01 N/m",
        "step": "0.005 N/m",
    },
    [
        {
            "name": "press",
            "kind": "displacement",
            "side": "top",
            "angle": "90 deg",
            "to": "-0.1 nm",
            "step": "0.1 nm",
        },
        {"name": "peel", "kind": "rotation", "to": "2 deg", "step": "1 deg"},
    ],
    [
        {"kind": "rotation", "to": "1 deg", "step": "1 deg"},
        {
            "kind": "force",
            "side": "right",
            "angle": "90 deg",
            "to": "0.1 nm",
            "step": "0.1 nm",
            "follows": True,
        },
        {"kind": "displacement", "side": "top", "angle": "90 deg", "to": "0.1 nm", "step": "0.1 nm"},
    ],
    [{"to": "100 deg", "step": "0.001 deg"}] * 3,
    [{"to": "1 deg", "step": "1 deg"}] * 101,
]
SPACES = [
    "L1", "L2", "N2", "N2.1", "L1+N2", "Q1CH", "N4", "L1+N2.1@2",
]  # fmt: skip
MESHES = ["8x2", "6x1", "1x1", "2x3", "12x2"]

#: What stands in place of a quantity, a number or a text.
QUANTITIES = [
    "0 nm", "-1 nm", "1e-300 nm", "1e400 nm", "1e308 m", "1e-12 nm", "nan nm", "inf nm", "-inf deg", "1 nm",
    "2 GPa", "1 nm^9", "1 furlong", "1 kg", "1 nm nm", "10**10**10 nm", "1e999999999999 nm", "nm", "1", "",
    " ", "1 nm/0", "1 nm^99999999", "1 (nm)", "1 degC", "1 dB", "3 mrad", "1 J/m^2",
    "1 nm*__import__('os')", "１ nm", "1 Å", "5 °", "1 mol", "1 GPa*nm^3", "9" * 99, "1e-999 nm", "0x10 nm",
    "1_0 nm", "1 count", "1 nm\u00a0", "1 delta_degC", "1 pH", "1e12 nm", "1e-11 nm", "1e11 GPa", "180 deg",
    "181 deg", "1e-6 deg", "0.1 J", "1 N/m", "1 lb", "1 in", "1 π", "1 nm²", "1 nm³", "1 kilonm", "1 E0",
    "1 L0", "1 _", "1 [length]", "1 %", "1 Mpa", "+1 nm", "1. nm", ".1 nm", "1e3nm",
    "30 mJ m-2", "1 N m-1", "1 e-3 m", "1e-3m", "1 N·m⁻¹", "1 J/m nm", "5×10⁻³ nm", "1 nm^0.5", "1 (((nm",
    "1 nm)", "−1 nm", "1 mil", "2 mils", "5 N/25 mm", "5 N/25mm", "1 N/0 mm", "1 N/(25 mm", "1 Newton",
    "0.03 J/(m²)", "1 N.m-1", "1 m**-2", "1 nm^(1/2)", "2 GPa\x00", "0.03 kN/km",
]  # fmt: skip
NUMBERS: list[Any] = [
    0, 1, -1, 0.0, -0.0, 0.5, 0.4999999, 0.49999999999999994, math.nan, math.inf, -math.inf, 1e308, 5e-324,
    1e-12, 2**63, 10**400, True, False, 1e6, 200, 0.2, -0.999, 1.0000001, 1e12, 3, 100,
]  # fmt: skip
TEXTS = [
    "", " ", "\x7f", "\u2028", "ü", "x" * 3000, "../x", "/etc/passwd", "~", "neo-hooke", "flat", "strip",
    "left", "right", "free", "🪟", "\\", '"', "\n", "a\nb", "formula", "patch.json", "nothing.json",
    "/dev/zero", "/", ".", "-", "xy", "yx", "projected", "reference", "None", "__class__", "a.b", "\u202e",
    "down", "inside", "top", "\x00\x1b[2J\x7f", "a\r\nb\tc", "\x85\x9b", "a.b." * 30, "'\"\"\"", "#",
]  # fmt: skip
FORMULAS = [
    '__import__("os").system("x")', "9**9**9**9*r", "exp(exp(exp(exp(100))))*r", "factorial(10**9)",
    "r.real", "lambda: r", "r**r**r**r**r", "1/0*r", "log(0)*r", "0**-1", "r/(r-r)", "Integral(r)",
    "Sum(r)", "r if r else 1", "r**1e308", "abs(r)", "Piecewise((r, True))", "x", "I1", "sqrt(-r)",
    "log(-1)", "(" * 80 + "r" + ")" * 80, "-" * 500 + "r", "r**-9999", "1e999*r",
    "exp(" * 90 + "r" + ")" * 90, "r*" * 400 + "r", "(r+1)*" * 200 + "r", "ｒ**2", "r²", "0*r", "5", "pi",
    "tan(1e300)*r", "W*((s/r)**8/3 - 4/3*(s/r)**2) + 0*unknown", "exp(r**99)", "(r**99)**99", "r**(1/3)",
    "sin(r)**-2", "nan", "inf*r", "I1*I2*J*F11", "log(J)**2", "J**-50*I1**9", "x**2*1e-300", "1e300*x**2",
    "exp(x)", "tan(x)", "log(x)", "sqrt(x)", "1/x", "a*cos(x/30)", "a*cos(x/l)", "a**l*x",
    "W*(s/r)**s", "0 + 0*r", "-W/(r/s - 1)**2", "-W*s/(r-s)", "-W/cosh(r/s)",
    "W*((s/(r+s))**8/3 - 4/3*(s/(r+s))**2)",
    "W*((s/r)**8/3 - 4/3*(s/r)**2) + W*s**2/(r - 2*s)**2", "W*log((r-s)**2/s**2)*exp(-r/s)",
    "-W*exp(-r**2/s**2)",
]  # fmt: skip
SPACE_NAMES = [
    "L0", "L20", "L21", "N9", "N99", "N2.20", "L1+L1@99", "H3", "H2", "", "Q1C4", "N2.1@2", "L1+N2@3", "n2",
    "N-1", "Ｎ2",
]  # fmt: skip
MESH_TEXTS = [
    "0x0", "0x1", "-1x2", "8 x 2", "8x2x2", "1000000x1000000", "100000x1000", "99999x1", "1x999", "1e3x2",
    "8", "", "x", "９x2", "999999999999999x1", "9" * 30 + "x1", "3000x1000", "40x1", "1x9",
]  # fmt: skip
STEPS = [
    "0 deg", "-1 deg", "1e-300 deg", "1e-9 deg", "500 deg", "0 nm", "-1 nm", "1e-9 nm", "9 nm", "inf nm",
    "1", "1 N/m",
]  # fmt: skip
ANYTHING = st.one_of(
    st.sampled_from(QUANTITIES),
    st.sampled_from(NUMBERS),
    st.sampled_from(TEXTS),
    st.text(max_size=20),
    st.integers(),
    st.floats(),
    st.booleans(),
    st.lists(st.sampled_from([*NUMBERS, *QUANTITIES]), max_size=3),
    st.just({}),
    st.builds(lambda: {"a": {"b": {"c": 1}}}),  # a new one each time, as it may be changed
    st.just([[[[]]]]),
    st.dictionaries(st.text(max_size=5), st.integers(), max_size=2),
    st.floats(min_value=-1e15, max_value=1e15).map(lambda value: f"{value!r} nm"),
    st.floats().map(lambda value: f"{value!r} GPa"),
)
KEYS = st.one_of(
    st.sampled_from(
        [
            "length",
            "Length",
            "shape",
            "law",
            "kind",
            "",
            "extra",
            "gap",
            "symmetric",
            "sliding_length",
            "traction",
        ]
    ),
    st.text(max_size=8),
)
#: What may stand at a key besides anything.
LIKELY: dict[str, list[Any]] = {
    "potential": FORMULAS,
    "energy": FORMULAS,
    "formula": FORMULAS,
    "space": SPACE_NAMES,
    "mesh": MESH_TEXTS,
    "step": STEPS,
    "to": [*QUANTITIES, "2 deg", "0.2 nm"],
    "grading": [
        [1, 1],
        [0, 1],
        [-1, 1],
        [math.nan, 1],
        [1e300, 1e-300],
        [1e5, 1],
        [1],
        5,
        [math.inf, 1],
        [100, 0.01],
    ],
    "contact_points": [0, 1, -1, 2, 100, 101, 10**30, 2.0, True],
    "across_degree": [0, 1, 2, 8, 9, -1, 1.5],
    "prestretch": NUMBERS,
    "fields_every": ["1e-12 nm", "0 nm", "1 deg", "1 nm", "-1 deg", 3, "1e-9 deg"],
    "window": [
        ["1 deg", "2 deg"],
        ["0.1 nm", "0.2 nm"],
        ["2 deg", "1 deg"],
        [1, 2],
        ["1 deg"],
        ["0 nm", "inf nm"],
    ],
    "centre": [["0 nm", "-400 nm"], ["1 nm"], 3, ["nan nm", "0 nm"], ["1 deg", "1 nm"]],
    "constants": [
        {},
        {"W": "1 nm"},
        {"r": 1.0},
        {"lambda": 1},
        {"W": math.nan},
        {"W": "1 deg"},
        {"é": 1},
        {"x y": 1},
        7,
        {"__class__": 1},
        {"exp": 1},
        {"W": 10**400},
        {"W": "50 N", "s": "0.25 nm"},
        {"W": "30 mJ m-2", "s": 0.25},
        {"mu": "1 N", "la": 1},
        {"a": "1 nm^0.5", "l": "30 nm"},
        {"a": "0.1 nm", "l": "30 nm", "unused": "3 MPa m^0.5"},
        {f"a{k}": 1 for k in range(500)},
    ],
    "start": [0.0, 0.5, 1.0, -1.0, math.nan],
    "end": [0.0, 0.5, 1.0, 2.0, math.inf],
    "file": [
        *(f"{name}.json" for name in (*_PATCHES, "link", "dangling", "pipe", "nothing")),
        "case.toml",
        "",
        ".",
        "/dev/zero",
        "/dev/stdin",
        "/proc/self/mem",
        "x\x7f.json",
        "patch.json\n",
    ],
    "held": [
        {"left": "x"},
        {"left": "xy"},
        {"right": "y"},
        {"bottom": "x"},
        {"top": "z"},
        {"right": "xy"},
        {"top": "xy"},
        {"bottom": "y", "top": "y"},
        {"left": "xy", "right": "xy", "bottom": "xy", "top": "xy"},
        {},
        {"front": "x"},
    ],
    "length": ["1e-6 nm", "1e9 nm", "200 nm", "1 m", "150 nm", "1 pm"],
    "height": ["1e-6 nm", "1e9 nm", "10 nm", "1 m", "-5 nm"],
    "radius": ["1e-6 nm", "1e9 nm", "1 nm", "3 nm", "-400 nm", "1 m"],
    "stress": ["1 Pa", "1e-30 Pa", "1e40 Pa", "0 Pa", "1 nm", "2 TPa"],
    "gap": ["0 nm", "-1 nm", "1e-9 nm", "1e9 nm", "0.3 nm"],
    "poissons_ratio": [0.5, 0.4999999999, 0.0, -0.9, -1.0, 0.49, 0.3],
    "name": ["x", "", "a/b", "..", "-x", "x" * 101, "x\n", "con", "press", "peel"],
}
OPTIONS: list[list[str]] = [
    [], [], [], [], ["--mesh", "4x1"], ["--space", "N3"], ["--to", "1"], ["--step", "0.5"], ["--to", "nan"],
    ["--mesh", "0x0"], ["--contact-points", "3"], ["--traction", "projected"], ["--to", "1e-300 nm"],
    ["--step", "9 parsec"], ["--space", ""], ["--to", "1 e-3 m"], ["--fields-every", "30 mJ m-2"],
    ["--to", "0.5Å"], ["--control", "jump"], ["--strict"], ["--out", "/proc/x"], ["--out", "/dev/null"],
]  # fmt: skip


@st.composite
def documents(draw: st.DrawFn) -> dict[str, Any]:
    """A case, whose parts may be changed in a few places."""
    drive = draw(st.sampled_from(DRIVES))
    document: dict[str, Any] = {
        "name": "case",
        "body": dict(draw(st.sampled_from(BODIES))),
        "material": dict(draw(st.sampled_from(MATERIALS))),
        "adhesion": dict(draw(st.sampled_from(LAWS))),
        "substrate": dict(draw(st.sampled_from(SUBSTRATES))),
        "discretization": {"space": draw(st.sampled_from(SPACES)), "mesh": draw(st.sampled_from(MESHES))},
        "drive": [dict(stage) for stage in drive] if isinstance(drive, list) else dict(drive),
    }
    if document["drive"] == {}:
        document["drive"] = {"to": "3 deg", "step": "1 deg"}
    for _ in range(draw(st.sampled_from([0, 1, 1, 1, 2, 3]))):
        _change(draw, document)
    return document


def _change(draw: st.DrawFn, document: dict[str, Any]) -> None:
    """Change a key, a table, or add or remove one."""
    tables = [key for key in document if key != "name"]
    section = draw(st.sampled_from([*tables, "units", "held", "held", "reading", "output"]))
    if draw(st.integers(0, 19)) == 0:
        document["about"] = draw(st.one_of(st.text(max_size=30), st.sampled_from(TEXTS)))
        return
    if draw(st.integers(0, 39)) == 0:
        section = "name"
    if draw(st.integers(0, 39)) == 0:
        document[draw(st.sampled_from([section, "extra"]))] = draw(ANYTHING)
        return
    if draw(st.integers(0, 39)) == 0:
        document.pop(section, None)
        return
    if section == "held" and draw(st.integers(0, 1)) == 0:
        document["held"] = dict(draw(st.sampled_from(LIKELY["held"])))
        return
    table = document.setdefault(section, {})
    if isinstance(table, list) and table:
        table = table[draw(st.integers(0, len(table) - 1))]
    if not isinstance(table, dict):
        document[section] = draw(st.one_of(ANYTHING, st.sampled_from(LIKELY["name"])))
        return
    known = {
        "units": ["length", "stress"],
        "held": ["left", "right", "bottom", "top"],
        "reading": ["window"],
        "output": ["fields_every"],
        "discretization": ["space", "mesh", "contact_points", "across_degree", "grading"],
        "drive": ["to", "step", "jumps", "name", "start", "end"],
        "adhesion": ["length", "irreversible", "traction", "sliding_length", "symmetric"],
        "substrate": ["gap"],
    }.get(section, [])
    key = draw(st.sampled_from([*table, *known] or ["extra"]))
    if draw(st.integers(0, 19)) == 0:
        key = draw(KEYS)
    likely = LIKELY.get(key)
    if likely is not None and draw(st.integers(0, 4)) > 0:
        table[key] = draw(st.sampled_from(likely))
    elif draw(st.integers(0, 9)) == 0:
        table.pop(key, None)
    else:
        table[key] = draw(ANYTHING)


def toml(document: dict[str, Any]) -> str:
    """Write a document."""
    return tomli_w.dumps(document)


#: What a text may begin or end with, besides what a document makes of it.
AROUND: list[tuple[str, str]] = [
    *[("", "")] * 40,
    ("\ufeff", ""),
    ("\ufeff\ufeff", ""),
    ("", "\n[extra]\n" + "a." * 60_000 + "a = 1\n"),
    ("", "\n[extra]\n" + ".".join(["a"] * 15) + " = 1\n"),
    ("#" + "\x7f", ""),
    ("", "\n# " + "x" * 30_000),
    ("", "\x00"),
    ("[[[[", ""),
    ("", "\n[material]\n"),
]
