"""The case text of two arms, one above the other, each clamped at its left end."""

_ARM = """
[[body]]
name = "{name}"
at = ["0 nm", "{at}"]
length = "20 nm"
height = "2 nm"
material = {{ law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.3 }}

[[support]]
boundary = "{name}.left"
holds = "xy"
"""
#: Without a drive.
TWO_ARMS = (
    'name = "two-arms"\n[discretization]\nspace = "N2"\nmesh = "10x1"\n'
    + _ARM.format(name="upper", at="0 nm")
    + _ARM.format(name="lower", at="-3 nm")
)
#: The boundaries of the last drive in the text: the right ends, which it pulls apart.
PULLED_APART = """
[[drive.on]]
boundary = "upper.right"

[[drive.on]]
boundary = "lower.right"
factor = -1.0
"""
