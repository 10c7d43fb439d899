"""Write an adhesion law and a material as one formula each, and compare with the built-in ones.

The law is van der Waals without its regularisation below the equilibrium gap, the material Mooney-Rivlin with
the small-strain moduli of the built-in neo-Hooke.
"""

import numpy as np

import isopeel


def main(elements: tuple[int, int] = (120, 4), degrees: float = 70.0) -> tuple[float, float]:
    """Return the moments at an angle, with the built-in laws and with our own."""
    built_in = isopeel.NeoHooke(youngs_modulus=1.0, poissons_ratio=0.2)
    mu, lame_lambda = built_in.shear_modulus, built_in.lame_lambda
    # a + b = mu/2, and 4 b + 2 c = lambda
    material = isopeel.FormulaMaterial(
        "a*(I1 - 3) + b*(I2 - 3) - (2*a + 4*b)*log(J) + c*(J - 1)**2",
        {"a": 0.4 * mu, "b": 0.1 * mu, "c": lame_lambda / 2 - 0.2 * mu},
    )
    law = isopeel.FormulaAdhesion(
        "A/(2*pi*r0**3) * (r0**9/(360*r**8) - r0**3/(6*r**2))", {"A": 0.05, "r0": 0.4}
    )
    space = isopeel.row_space("N2.1", elements)
    angles = np.radians(np.arange(0, degrees + 1))
    moments = []
    for name, problem in (
        ("built-in", isopeel.strip(material=built_in)),
        ("our own", isopeel.strip(material=material, law=law)),
    ):
        *_, last = isopeel.trace(problem, space, angles)
        print(f"{name:9}  moment {last.reaction:.6f} at {degrees:g} degrees")
        moments.append(last.reaction)
    return moments[0], moments[1]


if __name__ == "__main__":
    main()
