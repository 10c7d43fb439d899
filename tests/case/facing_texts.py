"""The case text of two strips that adhere to each other, and with one thing changed."""

FACING = """
name = "facing"

[[body]]
name = "lower"
at = ["-2 nm", "0 nm"]
length = "24 nm"
height = "2 nm"
material = { law = "neo-hooke", youngs_modulus = "1 GPa", poissons_ratio = 0.3 }

[[body]]
name = "upper"
on = "lower.top"
length = "20 nm"
height = "2 nm"
material = { law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.2 }

[[interface]]
between = ["upper.bottom", "lower.top"]
law = "van-der-waals"
hamaker_constant = "1e-19 J"
equilibrium_distance = "0.4 nm"
length = "15 nm"

[[support]]
boundary = "lower.bottom"
holds = "xy"

[[support]]
boundary = "upper.left"
holds = "x"

[discretization]
space = "N2"
mesh = "20x1"

[drive]
boundary = "upper.right"
to = "10 deg"
step = "1 deg"
"""


def changed(old: str, new: str) -> str:
    assert old in FACING
    return FACING.replace(old, new, 1)
