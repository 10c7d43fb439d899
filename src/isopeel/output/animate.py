"""Animate a stored run: the body and its curve, side by side."""

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from fractions import Fraction
from itertools import chain
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from PIL import Image
from psutil import NoSuchProcess, Process
from rich.console import Console

from isopeel.common.errors import InputError
from isopeel.common.interrupts import check, cleared_up, leave_time
from isopeel.output.selection import shown_stages
from isopeel.post.figures.moving import MovingFigure, Picture
from isopeel.results.files import MAKER, replacing
from isopeel.running.folder import FIGURES, check_overwritten, make_folder
from isopeel.running.progress import counted
from isopeel.running.run_reader import StoredStage

#: Range of pictures per second: a gif counts hundredths of a second, and shows at most 50 pictures.
FEWEST, MOST = 0.1, 50.0
#: Range of width and height, in pixels.
SMALLEST_SIZE, LARGEST_SIZE = 200, 4096
_USUAL_SECONDS = 8.0  # length of an animation by default
_USUAL_PACE = (2.0, 25.0)


def animate_run(
    folder: Path,
    suffix: str,
    fps: float | None,
    size: str,
    out: Path | None,
    console: Console,
    *,
    force: bool = False,
) -> None:
    """Animate the states whose displacement is stored in the folder of a run, in one file for each stage.

    `suffix` is mp4 or gif. `fps` is the number of states per second; by default the animation takes some
    seconds. `size` is the width and height in pixels, such as 1280x600. The files are animation.mp4 in the
    folder `figures` of the run, or in `out`. Raises InputError if an argument is invalid, or if a stage has
    one state only; OSError if a file cannot be written. If the process is ended early, the old file remains.
    """
    if suffix not in _WRITERS:
        raise InputError("--format", suffix, f"it must be one of {', '.join(_WRITERS)}")
    if fps is not None and not FEWEST <= fps <= MOST:
        raise InputError("--fps", fps, f"it must be from {FEWEST:g} to {MOST:g} pictures per second")
    pixels = _pixels(size)
    stages = shown_stages(folder)
    moving = [stage for stage in stages if len(stage.run.states) > 1]
    if not moving:
        allowed = "two or more stored states are needed; `isopeel run --fields-every` stores more"
        raise InputError("DIR", str(folder), allowed)
    leave_time()
    for stage in moving:
        into = stage.folder / FIGURES if out is None else out / stage.folder.relative_to(folder)
        check_overwritten("--out", [into / f"animation.{suffix}"], force)
        make_folder(into)
        count = len(stage.run.states)
        pace = fps or min(max(count / _USUAL_SECONDS, _USUAL_PACE[0]), _USUAL_PACE[1])
        path = into / f"animation.{suffix}"
        with replacing(path) as part, counted(console, f"drawing {stage.title}", count) as next_one:
            _WRITERS[suffix](part, _pictures(stage, pixels, next_one), pixels, pace)
        console.print(f"{path}: {count} states, {pace:g} per second", soft_wrap=True)


def _pixels(size: str) -> tuple[int, int]:
    parts = re.fullmatch(r"(\d{1,5})x(\d{1,5})", size)
    pixels = (int(parts[1]), int(parts[2])) if parts else (0, 0)
    if not all(SMALLEST_SIZE <= length <= LARGEST_SIZE and length % 2 == 0 for length in pixels):
        allowed = f"even numbers of pixels from {SMALLEST_SIZE} to {LARGEST_SIZE} are needed, as in 1280x600"
        raise InputError("--size", size, allowed)
    return pixels


def _pictures(stage: StoredStage, size: tuple[int, int], next_one: Callable[[], None]) -> Iterator[Picture]:
    run = stage.run
    figure = MovingFigure(stage.stage.problem, stage.spaces, run.curve, run.states, size, stage.laboratory)
    for number in range(len(figure)):
        check()
        yield figure.picture(number)
        next_one()


def _write_mp4(path: Path, pictures: Iterable[Picture], size: tuple[int, int], fps: float) -> None:
    every = iter(pictures)
    first, count = next(every), 0  # no file before the first picture
    # the writer does not pass Ctrl-C to ffmpeg, and ends ffmpeg when the generator is closed; players need
    # colours in blocks of two pixels
    writer = imageio_ffmpeg.write_frames(
        path,
        size,
        fps=Fraction(fps).limit_denominator(1000),
        quality=8,
        macro_block_size=2,
        ffmpeg_log_level="error",
        output_params=["-metadata", f"comment={MAKER}"],
    )
    others = Process().children()
    writer.send(None)
    ffmpeg = [process for process in Process().children() if process not in others]
    # without this, ffmpeg would still write its file when Ctrl-C ends this process
    with cleared_up(lambda: _killed(ffmpeg)):
        try:
            for picture in chain([first], every):
                writer.send(picture)
                count += 1
        finally:
            writer.close()
    # a full disk ends ffmpeg without an error here
    written = imageio_ffmpeg.count_frames_and_secs(path)[0] if path.exists() else 0
    if written != count:
        raise OSError(None, f"ffmpeg has written {written} of {count} pictures", str(path))


def _killed(processes: Iterable[Process]) -> None:
    """End processes that have not ended yet."""
    for process in processes:
        with suppress(NoSuchProcess):
            process.kill()
            process.wait()


def _write_gif(path: Path, pictures: Iterable[Picture], _size: tuple[int, int], fps: float) -> None:
    every = iter(pictures)
    first = next(every)
    # each picture has the colour bar, so that all pictures can use the palette of the first one
    found = Image.fromarray(first).quantize(255, Image.Quantize.MAXCOVERAGE).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette([255, 255, 255, *found[: 3 * 255]])
    same = (_in_colours_of(palette, picture) for picture in chain([first], every))
    next(same).save(
        path, "GIF", save_all=True, append_images=same, duration=round(1000 / fps), loop=0, comment=MAKER
    )


def _in_colours_of(palette: Image.Image, picture: Picture) -> Image.Image:
    """Return a picture in the colours of a palette whose first colour is white."""
    numbers = np.array(Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE))
    # the search for the nearest colour is coarse, and an almost white background would look dirty
    numbers[(picture == 255).all(axis=2)] = 0
    image = Image.fromarray(numbers)
    image.putpalette(palette.getpalette() or [])
    return image


_WRITERS: dict[str, Callable[[Path, Iterable[Picture], tuple[int, int], float], None]] = {
    "mp4": _write_mp4,
    "gif": _write_gif,
}
