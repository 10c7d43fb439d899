"""The case text of two tapes, each with an interface and a support, and with one thing changed."""

TWO = """
name = "two-tapes"

[[body]]
name = "upper"
length = "20 nm"
height = "2 nm"
at = ["0 nm", "10 nm"]
material = { law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.2 }
space = "L1+N2"
mesh = "20x2"
across_degree = 1

[[body]]
name = "lower"
length = "30 nm"
height = "2 nm"
material = { law = "neo-hooke", youngs_modulus = "1 GPa", poissons_ratio = 0.3, prestretch = 1.1 }

[[interface]]
boundary = "upper.bottom"
law = "van-der-waals"
hamaker_constant = "1e-19 J"
equilibrium_distance = "0.4 nm"
length = "15 nm"

[[interface]]
boundary = "lower.bottom"
law = "exponential"
strength = "80 MPa"
work_of_adhesion = "0.03 J/m^2"
start = "6 nm"
end = 0.8
irreversible = true

[[support]]
boundary = "upper.left"
holds = "x"

[[support]]
boundary = "lower.top"
length = "3 nm"
holds = "xy"

[discretization]
space = "N2"
mesh = "16x2"

[drive]
boundary = "upper.right"
to = "10 deg"
step = "1 deg"
"""


def changed(old: str, new: str) -> str:
    assert old in TWO
    return TWO.replace(old, new, 1)
