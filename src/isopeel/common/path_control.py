"""How a path may be controlled: what it does where a step finds no equilibrium."""

from typing import Literal

#: `newton` ends; `auto` cuts the step, and jumps where the smallest one fails; `jump` does so from the limit
#: point, as a test that prescribes the parameter; `continuation` follows the curve through limit points.
PathControl = Literal["newton", "auto", "jump", "continuation"]
