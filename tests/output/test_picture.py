"""A picture that VTK draws of a rational body: where it is, and what field it shows."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bodies import body
from draw import SIZE
from matplotlib.image import imread

from isopeel.common.arrays import FloatArray
from isopeel.post.grids import body_grids, body_mesh
from isopeel.results import vtk
from isopeel.results.fields import StoredState

GRADIENT = np.array([[0.2, 0.1], [-0.3, 0.1]])
CENTRE, HALF, REACH = np.array([0.0, 5.0]), 16.0, 4.0


def picture(source: Path | str, file: Path) -> "subprocess.CompletedProcess[str]":
    program = str(Path(__file__).with_name("draw.py"))
    numbers = [str(number) for number in (*CENTRE, HALF, REACH)]
    return subprocess.run(
        [sys.executable, program, str(source), str(file), *numbers],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.fixture(scope="module")
def _drawing(tmp_path_factory: pytest.TempPathFactory) -> None:
    file = tmp_path_factory.mktemp("empty") / "empty.png"
    tried = picture("", file)
    empty = file.exists() and np.array_equal(
        imread(file)[..., :3], np.broadcast_to([0, 0, 1], (SIZE, SIZE, 3))
    )
    if tried.returncode != 0 or not empty:
        pytest.skip("VTK cannot draw off screen here: it takes EGL, OSMesa, or a display")


@pytest.mark.usefixtures("_drawing")
@pytest.mark.parametrize("pieces", [None, 12], ids=["Bezier", "straight"])
def test_a_half_cylinder_is_drawn_where_it_is(pieces: int | None, tmp_path: Path) -> None:
    problem, space = body("half cylinder")
    shape = problem.body.shape
    u = space.weighted(shape).interpolate(lambda xi, eta: shape.evaluate(xi, eta) @ GRADIENT.T)
    (grid,) = body_grids(problem, space, body_mesh(problem, space, pieces), [StoredState(0, 0.0, u)])
    vtk.write_grid(tmp_path / "body.vtu", grid, 0.0, {})
    drawn = picture(tmp_path / "body.vtu", tmp_path / "picture.png")
    assert drawn.returncode == 0, drawn.stderr
    pixels = imread(tmp_path / "picture.png")[::-1, :, :3]
    at = CENTRE + HALF * ((np.arange(SIZE) + 0.5) / SIZE * 2 - 1)[:, None] * np.ones(2)
    x: FloatArray = np.stack(np.meshgrid(at[:, 0], at[:, 1]), axis=-1)
    X = x @ np.linalg.inv(np.eye(2) + GRADIENT).T
    # half a cylinder of radius 10 that touches y = 0, with its flat face at y = 10
    distance = np.hypot(X[..., 0], X[..., 1] - 10)
    inside, margin = (distance < 10) & (X[..., 1] < 10), 1.5 * 2 * HALF / SIZE
    edge = (np.abs(distance - 10) < margin) | (np.abs(X[..., 1] - 10) < margin)
    covered = (pixels != [0, 0, 1]).any(axis=-1)
    # a pixel and a half at the edge may be either; a polygon of the elements' corners would be 9 pixels off
    assert (covered == inside)[~edge].all()
    assert inside.mean() > 0.15
    grey = pixels[inside & ~edge]
    expected = ((X @ GRADIENT.T)[..., 1][inside & ~edge] + REACH) / (2 * REACH)
    # VTK draws a linear field over the pieces that it cuts cells into: two levels of grey
    assert np.abs(grey - expected[:, None]).max() < 2.5 / 255
    assert np.ptp(grey) > 0.5
