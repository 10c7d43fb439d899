"""Peel the strip of the literature, and hold its plateau against the closed form of beam theory."""

import numpy as np

import isopeel
from isopeel.post.closed_form import beam_peeling


def main(elements: tuple[int, int] = (200, 10), degrees: float = 90.0) -> tuple[float, float]:
    """Return the moment at an angle and the closed form of the plateau, in E0 L0^3."""
    problem = isopeel.strip()
    space = isopeel.row_space("N2.1", elements)
    moment = 0.0
    for step in isopeel.trace(problem, space, np.radians(np.arange(0, degrees + 1))):
        moment = step.reaction
        if step.number % 10 == 0:
            print(f"{np.degrees(step.parameter):5.1f} degrees  moment {moment:.6f}")
    closed_form = beam_peeling(problem)
    assert closed_form is not None  # the strip has one
    print(f"closed form of the plateau  {closed_form.moment:.6f}")
    return moment, closed_form.moment


if __name__ == "__main__":
    main()
