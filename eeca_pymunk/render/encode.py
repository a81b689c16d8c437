"""Encoders: frames to GIF (Pillow), MP4 (ffmpeg of the `imageio-ffmpeg` wheel) or a self-contained HTML page."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable, Iterable, Iterator
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen

import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb
from PIL import Image

from eeca_pymunk.arguments import check_finite

from .drawing import COLORS

Frames = Iterable[npt.NDArray[np.uint8]]
_SLOWEST, _FASTEST = 0.002, 1000.0  # frames per second; a GIF has delays up to 655 s, a page whole milliseconds
_SHADES = 9  # of each colour towards white, for smooth edges; few colours make small files


def encoder(suffix: str) -> Callable[[Frames, Path, float], None]:
    """The function that writes frames to a file, so many in a second; ValueError for a suffix other than .gif, .mp4 and
    .html, and for .mp4 without ffmpeg."""
    if suffix not in _ENCODERS:
        raise ValueError(f"cannot write films to {suffix!r} files: choose one of {', '.join(_ENCODERS)}")
    if suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        raise ValueError("MP4 needs ffmpeg: pip install 'eeca-pymunk[video]', or choose .gif or .html")
    return _ENCODERS[suffix]


def check_fps(fps: float) -> float:
    """A number of frames per second; ValueError unless all formats and players can show so many, or so few."""
    if not _SLOWEST <= check_finite("fps", fps) <= _FASTEST:
        raise ValueError(f"fps = {fps}: give a number from {_SLOWEST:g} to {_FASTEST:g}")
    return float(fps)


def _gif(frames: Frames, path: Path, fps: float) -> None:
    images = _few_colors(frames)
    # Delays of a GIF are multiples of 10 ms.
    duration = 10 * max(2, round(100.0 / fps))
    with path.open("w+b") as file:
        next(images).save(file, "GIF", save_all=True, append_images=images, duration=duration, loop=0, disposal=1)


def _mp4(frames: Frames, path: Path, fps: float) -> None:
    from imageio_ffmpeg import get_ffmpeg_exe

    shots = iter(frames)
    first = next(shots)
    size = f"{first.shape[1]}x{first.shape[0]}"
    command = [get_ffmpeg_exe(), "-y", "-loglevel", "error"]
    command += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", str(fps), "-i", "-"]
    command += ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", str(path)]
    with Popen(command, stdin=PIPE, stdout=DEVNULL, stderr=PIPE) as ffmpeg:
        assert ffmpeg.stdin is not None  # asked for
        assert ffmpeg.stderr is not None
        try:
            for shot in chain((first,), shots):
                ffmpeg.stdin.write(np.ascontiguousarray(shot).tobytes())
        except BrokenPipeError:
            pass  # the error message of ffmpeg is read below
        except BaseException:
            ffmpeg.kill()
            raise
        ffmpeg.stdin.close()
        message = ffmpeg.stderr.read().decode(errors="replace")
    if ffmpeg.returncode:
        raise OSError(f"ffmpeg could not write {path}: {message.strip()}")


def _html(frames: Frames, path: Path, fps: float) -> None:
    page = "<!DOCTYPE html><meta charset='utf-8'><title>{0}</title>{1}"
    path.write_text(page.format("eeca-pymunk", html_player(frames, fps, "")), encoding="utf-8")


def html_player(frames: Frames, fps: float, caption: str) -> str:
    """HTML of a player: play, pause and a slider over frames that are part of the text."""
    shots = []
    for image in _few_colors(frames):
        data = io.BytesIO()
        image.save(data, format="PNG", optimize=False)
        shots.append('"data:image/png;base64,' + base64.b64encode(data.getvalue()).decode() + '"')
    return _PLAYER.format(
        first=shots[0], shots=",".join(shots), last=len(shots) - 1, pause=round(1000.0 / fps), caption=caption
    )


def _few_colors(frames: Frames) -> Iterator[Image.Image]:
    """The frames with one palette, that of drawings, so that unchanged pixels are equal in all of them."""
    whiteness = np.linspace(0.0, 1.0, _SHADES)[:, None]
    pure = [np.array(to_rgb(c)) for c in (*COLORS, "black")]
    shades = np.concatenate([whiteness + (1.0 - whiteness) * c for c in pure])
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.rint(255.0 * shades).astype(np.uint8).tobytes())
    for shot in frames:
        yield Image.fromarray(shot).quantize(palette=palette, dither=Image.Dither.NONE)


_ENCODERS: dict[str, Callable[[Frames, Path, float], None]] = {".gif": _gif, ".mp4": _mp4, ".html": _html}

# Everything is looked up from the script's own element: a notebook may show several players.
_PLAYER = """<div style="display:inline-block;max-width:100%"><img src={first} style="max-width:100%" alt="simulation">
<div><button type="button">pause</button> <input type="range" min="0" max="{last}" value="0" style="width:60%">
<span>{caption}</span></div><script>(function (box) {{
const shots = [{shots}], image = box.querySelector("img"), slider = box.querySelector("input"),
  button = box.querySelector("button");
let plays = true;
const show = i => {{ slider.value = i; image.src = shots[i]; }};
slider.oninput = () => {{ plays = false; button.textContent = "play"; show(+slider.value); }};
button.onclick = () => {{ plays = !plays; button.textContent = plays ? "pause" : "play"; }};
setInterval(() => {{ if (plays) show((+slider.value + 1) % shots.length); }}, {pause});
}})(document.currentScript.parentElement);</script></div>"""
