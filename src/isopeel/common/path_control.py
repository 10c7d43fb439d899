"""The kinds of path control: what a path does if a step finds no equilibrium."""

from typing import Literal

#: `newton` ends the path; `auto` cuts the step, and jumps if the smallest step fails; `jump` jumps from the
#: limit point, like a test that prescribes the parameter; `continuation` follows the curve through limit
#: points.
PathControl = Literal["newton", "auto", "jump", "continuation"]
