"""Texts of cases for the tests of this folder, each with one thing changed."""

from importlib import resources

import numpy as np

from isopeel.problem import Boundary, MovedSide, PulledSide

#: The shipped strip as it is written.
STRIP = resources.files("isopeel").joinpath("cases", "strip", "case.toml").read_text("utf-8")


def changed(old: str, new: str) -> str:
    assert STRIP.count(old) == 1
    return STRIP.replace(old, new)


#: Tables of a case whose other keys are left out.
PARTS = {
    "body": 'length = "200 nm"\nheight = "10 nm"',
    "material": 'law = "neo-hooke"\nyoungs_modulus = "2 GPa"\npoissons_ratio = 0.2',
    "adhesion": 'law = "bilinear"\nstrength = "100 MPa"\nwork_of_adhesion = "0.03 J/m^2"\nrise = 0.2\n'
    'equilibrium_gap = "0.3 nm"',
}


def case_with(**parts: str) -> str:
    """A case with other or further tables, or with lines before the first one, as `head`."""
    head = parts.pop("head", "")
    tables = (f"[{name}]\n{keys}\n" for name, keys in (PARTS | parts).items() if not name.startswith("_"))
    return f'name = "test"\n{head}\n' + "".join(tables)


def two_stages(second: str) -> str:
    return case_with() + f'[[drive]]\nside = "right"\nto = "3 deg"\nstep = "1 deg"\n[[drive]]\n{second}'


#: A substrate.
BACKING = 'kind = "circle"\nradius = "100 nm"\n'

#: Drives with all keys of a stage, what they mean, and their parameters.
STAGES = [
    ('kind = "displacement"\nside = "right"\nangle = "90 deg"\nto = "-2 nm"\nstep = "8 angstrom"',
     MovedSide("right", np.pi / 2), [0.0, -0.8, -1.6, -2.0]),
    ('kind = "force"\nside = "right"\nangle = "45 deg"\nto = "3 nm"\nstep = "1 nm"\nstart = 0.25',
     PulledSide(Boundary("body", "right", 0.25), np.pi / 4), [0.0, 1.0, 2.0, 3.0]),
    ('kind = "force"\nside = "top"\nangle = "90 deg"\ncontrol = "force"\nfollows = true\n'
     'to = "0.06 N/m"\nstep = "0.02 N/m"',
     PulledSide("top", np.pi / 2, follows=True, control="force"), [0.0, 0.01, 0.02, 0.03]),
]  # fmt: skip
