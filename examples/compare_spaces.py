"""Compare spaces by the oscillation of their plateau: enriching one row does much of the work."""

import numpy as np

import isopeel
from isopeel.post.plateau import read_plateau


def main(
    names: tuple[str, ...] = ("N4", "Q1N2.1", "N2.1"),
    elements: tuple[int, int] = (200, 10),
    window: tuple[float, float] = (95.0, 98.3),
) -> dict[str, float]:
    """Return the peak-to-peak oscillation of the moment in a window of angles, in E0 L0^3, of each space."""
    problem = isopeel.strip()
    # equilibria do not depend on the steps before them: coarse ones up to the window
    degrees = np.concatenate([np.arange(0, window[0], 0.5), np.arange(window[0], window[1] + 0.05, 0.1)])
    amplitudes = {}
    for name in names:
        space = isopeel.row_space(name, elements)
        curve = isopeel.Curve.of(isopeel.trace(problem, space, np.radians(degrees)), problem.drive)
        reading = read_plateau(curve, window)
        assert reading is not None  # the curve covers the window
        amplitudes[name] = reading.amplitude
        print(f"{name:7}  {2 * space.size:6d} DOFs  oscillation {reading.amplitude:.2e} E0 L0^3")
    return amplitudes


if __name__ == "__main__":
    main()
