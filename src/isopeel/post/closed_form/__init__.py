"""Closed forms, with which runs are compared.

`expected` and `beam_peeling` read a problem; the others are functions of numbers, in any consistent units.
That of a rigid cylinder is in `closed_form.rigid_cylinder`, which loads SciPy's quadrature: time that most
runs can save.
"""

from isopeel.post.closed_form.beams import (
    beam_moment,
    composite_stiffness,
    double_cantilever_force,
    double_cantilever_moment,
)
from isopeel.post.closed_form.bonded_beams import BondedBeams
from isopeel.post.closed_form.cohesive_cylinder import (
    CohesiveCylinder,
    maugis_cylinder,
    maugis_cylinder_pull_off,
)
from isopeel.post.closed_form.expected import Expected, expected
from isopeel.post.closed_form.laminate import laminate
from isopeel.post.closed_form.line_contact import HertzLine, hertz_line, jkr_line_load, jkr_line_pull_off
from isopeel.post.closed_form.strip import BeamPeeling, beam_peeling
from isopeel.post.closed_form.t_peel import t_peel
from isopeel.post.closed_form.tape import kendall_force, sliding_tape_force, t_peel_force
from isopeel.post.closed_form.tape_on_body import tape_on_body

__all__ = [
    "BeamPeeling",
    "BondedBeams",
    "CohesiveCylinder",
    "Expected",
    "HertzLine",
    "beam_moment",
    "beam_peeling",
    "composite_stiffness",
    "double_cantilever_force",
    "double_cantilever_moment",
    "expected",
    "hertz_line",
    "jkr_line_load",
    "jkr_line_pull_off",
    "kendall_force",
    "laminate",
    "maugis_cylinder",
    "maugis_cylinder_pull_off",
    "sliding_tape_force",
    "t_peel",
    "t_peel_force",
    "tape_on_body",
]
