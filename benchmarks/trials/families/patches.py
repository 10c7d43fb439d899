"""Strips and tapes that are drawn as a patch in a file: the same answers as of strips, whatever the knots.

The rectangle is a B-spline of degree 1 to 3 along the length with one to three inner knots, each as often
as once to the degree, and control points that lie evenly or not: the same shape, drawn in another way.
"""

import json
from dataclasses import replace

import numpy as np

from trials.case import Drawn, Value
from trials.dice import Dice
from trials.families import moments, tapes
from trials.quantities import parsed_length

FILE = "rectangle.json"


def draw(dice: Dice) -> Drawn:
    """Draw a strip or a tape, and its rectangle as a patch."""
    drawn = moments.draw(dice) if dice.chance(0.6) else tapes.draw(dice)
    body = drawn.sections["body"]
    assert isinstance(body, dict)
    length, height = (parsed_length(str(body[key])) for key in ("length", "height"))
    unit = dice.pick((height, 1e-3 if height > 1e-6 else 1e-9))
    text, sort = rectangle(dice, length / unit, height / unit)
    table: dict[str, Value] = {"shape": "patch", "file": FILE, "unit_length": f"{unit:.10g} m"}
    return replace(
        drawn,
        kind=f"{sort}; {drawn.kind}",
        sections={**drawn.sections, "body": table},
        files={FILE: text},
    )


def rectangle(dice: Dice, length: float, height: float) -> tuple[str, str]:
    """The text of a file with a rectangle, and what is particular about it."""
    degree, across = dice.pick((1, 2, 3)), dice.pick((1, 1, 2))
    inner = sorted({round(dice.between(0.1, 0.9), 3) for _ in range(dice.pick((1, 1, 2, 3)))})
    repeated = dice.pick((1, degree))
    ends = degree + 1
    knots = [*[0.0] * ends, *(knot for knot in inner for _ in range(repeated)), *[1.0] * ends]
    points = np.array([np.mean(knots[k + 1 : k + 1 + degree]) for k in range(len(knots) - degree - 1)])
    even = dice.chance(0.5)
    if not even:
        # inner points move by a third of the distance to a neighbour at most, so that none passes another
        room = np.minimum(np.diff(points)[:-1], np.diff(points)[1:])
        points[1:-1] += dice.random.uniform(-1 / 3, 1 / 3, len(room)) * room
    rows = np.linspace(0.0, height, across + 1)
    spline = {
        "SplineType": "BSpline",
        "para_dim": 2,
        "dim": 2,
        "degrees": [degree, across],
        "knot_vectors": [knots, [0.0] * (across + 1) + [1.0] * (across + 1)],
        "control_points": [[float(x * length), float(y)] for y in rows for x in points],
    }
    kink = "kinked" if repeated == degree and not even else "smooth" if not even else "even"
    return json.dumps({"SplineList": [spline]}), kink
