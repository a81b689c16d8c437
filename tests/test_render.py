"""Pictures and films: opened again and looked at."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pymunk
import pytest
from matplotlib.colors import to_rgb
from matplotlib.quiver import Quiver
from PIL import Image

import eeca_pymunk as ep
import scenes
from comparisons.__main__ import main
from eeca_pymunk import render
from eeca_pymunk.render import encode, film, traces
from eeca_pymunk.render.drawing import MOVING_COLOR
from eeca_pymunk.space.outlines import Outlines

from .test_recording import lossy

BLUE = tuple(int(MOVING_COLOR[i : i + 2], 16) for i in (1, 3, 5))


@pytest.fixture
def recording() -> ep.Recording:
    scene = scenes.build("carom")
    return ep.record(ep.EECA(scene.space), 0.2, 0.01)


def frames(path: Path) -> list[np.ndarray]:
    with Image.open(path) as image:
        found = []
        for k in range(image.n_frames):
            image.seek(k)
            found.append(np.asarray(image.convert("RGB")).astype(int))
        return found


def test_gif_has_a_frame_per_moment_and_disks_where_the_recording_says(recording: ep.Recording, tmp_path: Path) -> None:
    path = render.animate(recording, tmp_path / "film.gif", fps=20, view=(0.0, 1.0, 0.0, 1.0))
    shots = frames(path)
    assert len(shots) == len(recording) == 21
    assert {s.shape for s in shots} == {shots[0].shape}
    assert all((a != b).any() for a, b in pairwise(shots))
    # Where the axes put the disk, in pixels from the top.
    made = film.Film(recording, view=(0.0, 1.0, 0.0, 1.0))
    next(made.images())
    ax = made.panels[0].ax
    for shot, centre in zip(shots, recording.position[:, 0], strict=True):
        x, y = ax.transData.transform(centre)
        assert np.abs(shot[shot.shape[0] - 1 - round(y), round(x)] - BLUE).max() <= 3
    # The disk has left the place it started from, where only its thin path is left.
    x, y = ax.transData.transform(recording.position[0, 0] + (-0.004, -0.004))
    assert shots[-1][shots[-1].shape[0] - 1 - round(y), round(x)].sum() > 600


def test_panels_share_scale_and_clock(tmp_path: Path) -> None:
    runs = []
    for dt in (0.01, 0.02):
        scene = scenes.build("carom")
        runs.append(ep.record(ep.EECA(scene.space), 0.2, dt))
    made = film.Film(runs, exact=scenes.build("carom").exact)
    list(made.images())
    left, right = made.panels
    assert (left.ax.get_xlim(), left.ax.get_ylim()) == (right.ax.get_xlim(), right.ax.get_ylim())
    assert left.trace.ax.get_ylim() == right.trace.ax.get_ylim()
    # At the end both show the same time, and disk and ghost agree.
    for panel in made.panels:
        disk, ghost = panel.drawing.artists[0], panel.ghost.artists[0]
        np.testing.assert_allclose(disk.get_offsets(), ghost.get_offsets(), atol=1e-12)  # type: ignore[attr-defined]
        np.testing.assert_allclose(panel.trace.moving[0].get_xdata()[-1], 0.2)


def test_four_panels_are_in_two_rows_and_a_view_holds_all_motions() -> None:
    runs = []
    for velocity in ((1.0, 0.0), (-2.0, 0.0), (0.0, 3.0), (0.0, -1.0)):
        space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
        space.add(body, pymunk.Circle(body, 0.1))
        body.velocity = velocity
        runs.append(ep.record(ep.EECA(space), 1.0, 0.1))
    made = film.Film(runs, frames=2, dpi=50)
    height, width = next(made.images()).shape[:2]
    assert width == 400
    assert height > width
    corners = [panel.ax.get_window_extent() for panel in made.panels]
    assert corners[0].y0 == pytest.approx(corners[1].y0)
    assert corners[2].y0 == pytest.approx(corners[3].y0)
    assert corners[2].x0 == pytest.approx(corners[0].x0)
    assert corners[2].y1 < corners[0].y0
    for panel in made.panels:
        (left, right), (bottom, top) = panel.ax.get_xlim(), panel.ax.get_ylim()
        assert left < -2.1 < 1.1 < right < 1.5
        assert bottom < -1.1 < 3.1 < top < 3.5


def test_mp4_holds_the_frames(recording: ep.Recording, tmp_path: Path) -> None:
    from imageio_ffmpeg import get_ffmpeg_exe

    path = render.animate([recording, recording], tmp_path / "film.mp4", fps=25, dpi=51, frames=13)
    command = [get_ffmpeg_exe(), "-loglevel", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=True).stdout
    height, width = next(film.Film([recording, recording], dpi=51, frames=13).images()).shape[:2]
    assert height % 2 == width % 2 == 0
    shots = np.frombuffer(raw, np.uint8).reshape(13, height, width, 3)
    assert all((a != b).any() for a, b in pairwise(shots))


def test_html_needs_nothing_else_and_shows_every_frame(recording: ep.Recording, tmp_path: Path) -> None:
    path = render.animate(recording, tmp_path / "film.html", frames=5, dpi=40)
    text = path.read_text()
    assert "http" not in text
    assert len(set(re.findall(r'"(data:image/png;base64,[^"]+)"', text))) == 5
    assert recording._repr_html_().count("data:image/png") == len(recording) + 1


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"path": "film.avi"}, "choose one of .gif, .mp4, .html"),
        ({"fps": 0}, "fps = 0: give a finite number > 0"),
        ({"fps": math.inf}, "fps = inf: give"),
        ({"fps": 1e-3}, "fps = 0.001: give a number from 0.002 to 1000"),
        ({"frames": 0}, "frames = 0"),
        ({"frames": 2.0}, "frames = 2.0: give a whole number >= 1"),
        ({"dpi": 0}, "dpi = 0: give"),
        ({"dpi": math.nan}, "dpi = nan: give"),
        ({"dpi": 1e6}, "dpi = 1e+06: frames of 4000000 x"),
        ({"view": (0.0, 1.0, 2.0, 2.0)}, "view = (0.0, 1.0, 2.0, 2.0): give four finite numbers"),
        ({"view": (0.0, 1.0, 0.0)}, "view = (0.0, 1.0, 0.0): give four finite numbers"),
        ({"view": (0.0, math.inf, 0.0, 1.0)}, "give four finite numbers"),
        ({"exact": lambda t: np.zeros((7, 2))}, "exact(0) has shape (7, 2): return (1, 2) positions"),
        ({"path": "a" * 300 + ".gif"}, "too long"),
        ({"arrow": "spin"}, "arrow = 'spin': choose one of velocity, momentum"),
        ({"titles": ["a", "b"]}, "2 titles for 1 recordings"),
        ({"recordings": []}, "0 recordings: give one to 4"),
    ],
)
def test_bad_films_are_refused_before_anything_is_written(
    arguments: dict[str, object], told: str, recording: ep.Recording, tmp_path: Path
) -> None:
    path = tmp_path / str(arguments.pop("path", "film.gif"))
    with pytest.raises((ValueError, TypeError, OSError), match=re.escape(told)):
        render.animate(**{"recordings": recording, "path": path, **arguments})  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_bad_pictures_and_players_are_refused(recording: ep.Recording, tmp_path: Path) -> None:
    ax = render.figure(2.0, 2.0).add_subplot()
    for arguments, told in (
        ({"path": tmp_path / "snap"}, "snap': give a name that ends in one of"),
        ({"path": tmp_path / "snap.xyz"}, "snap.xyz': give a name that ends in one of"),
        ({"view": (0.0, 0.0, 0.0, 1.0)}, "view = (0.0, 0.0, 0.0, 1.0): give four"),
    ):
        with pytest.raises(ValueError, match=re.escape(told)):
            render.snapshot(recording, ax, **arguments)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match=re.escape(told)):
            render.strip(recording, [0.0], **arguments)  # type: ignore[arg-type]
    assert not ax.has_data()
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValueError, match="fps = 0: give"):
        render.player(recording, fps=0)


def test_points_and_what_was_removed_are_drawn(tmp_path: Path) -> None:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    body.position = (3.0, 1e6)
    space.add(body, pymunk.Circle(body, 0.0))
    ax = render.snapshot(space, velocity=True, momentum=True, path=tmp_path / "point.png")  # arrows without length
    assert ax.get_xlim() == pytest.approx((2.0, 4.0))
    stepper = ep.EECA(space)
    still = ep.record(stepper, 0.1, 0.05)
    render.animate(still, tmp_path / "point.gif", arrow="velocity")
    assert len(frames(tmp_path / "point.gif")) == 3
    space.add_post_step_callback(lambda space, key: space.remove(body, *body.shapes), "remove")
    gone = ep.record(stepper, 0.1, 0.05)
    assert np.isnan(gone.position[-1]).all()
    render.strip(gone, [0.0, 0.1], velocity=True)
    render.animate(gone, tmp_path / "gone.gif", arrow="momentum")
    with pytest.raises(ValueError, match="no shape is there at these moments"):
        render.snapshot(gone, time=0.1)
    render.snapshot(gone, time=0.1, view=(0.0, 1.0, 0.0, 1.0))


def test_recordings_without_shapes_are_shown_as_text() -> None:
    space = pymunk.Space()
    space.add(pymunk.Body(1.0, 1.0))
    assert ep.record(ep.EECA(space), 0.1, 0.05)._repr_html_() == "<p>3 moments of 1 bodies, without shapes</p>"


def test_kinematic_bodies_have_no_momentum_to_draw(tmp_path: Path) -> None:
    """One that stands too: 0 times infinity."""
    space = pymunk.Space()
    floor, ball = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(2.0, 1.0)
    ball.position, ball.velocity = (3.0, 0.0), (1.0, 0.0)
    space.add(floor, ball, pymunk.Circle(floor, 0.3), pymunk.Circle(ball, 0.3))
    ax = render.snapshot(space, momentum=True, path=tmp_path / "momenta.png")
    (drawn,) = [one for one in ax.collections if isinstance(one, Quiver)]
    assert drawn.U.tolist() == [0.0, 2.0]
    shown = film.Film(ep.record(ep.EECA(space), 0.1, 0.05), arrow="momentum")
    assert shown.panels[0].vectors[0].tolist() == [[0.0, 0.0], [2.0, 0.0]]
    assert len(list(shown.images())) == 3


def test_without_ffmpeg_mp4_says_what_to_install(
    recording: ep.Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(encode, "find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"pip install 'eeca-pymunk\[video\]'"):
        render.animate(recording, tmp_path / "film.mp4")
    assert main(["carom", "--animate", "mp4", "--out", str(tmp_path / "new")]) == 2
    assert "ffmpeg" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_interrupted_film_leaves_no_file(
    recording: ep.Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shown = film._Panel.show

    def interrupt(panel: film._Panel, t: float) -> None:
        if t > 0.1:
            raise KeyboardInterrupt
        shown(panel, t)

    monkeypatch.setattr(film._Panel, "show", interrupt)
    for suffix in (".gif", ".mp4", ".html"):
        with pytest.raises(KeyboardInterrupt):
            render.animate(recording, tmp_path / f"film{suffix}", dpi=40)
    assert not list(tmp_path.iterdir())
    assert main(["carom", "--animate", "gif", "--duration", "0.2", "--out", str(tmp_path)]) == 130
    assert "interrupted" in capsys.readouterr().err
    assert not list(tmp_path.glob("*.gif"))
    assert not list(tmp_path.glob(".*"))


def test_command_line_films_the_chosen_steppers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["carom", "--animate", "gif", "--steppers", "eeca,native,trapezoidal", "--dt", "0.002"]
    assert main([*arguments, "--duration", "0.1", "--frames", "6", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in ("EECA", "pymunk", "trapezoidal", "dt = 0.002"))
    assert len(frames(tmp_path / "carom.gif")) == 6
    assert (tmp_path / "carom_film.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["carom", "--steppers", "eeca,magic"], "unknown stepper 'magic': choose from eeca"),
        (["carom", "--dt", "-1"], "--dt -1.0: give a finite number > 0"),
        (["carom", "--duration", "nan"], "--duration nan"),
        (["scaling", "--animate", "gif"], "scaling has no single scene to show: choose one of"),
        (["nonsense", "--animate", "gif"], "unknown comparison 'nonsense'"),
    ],
)
def test_bad_command_lines(arguments: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*arguments, "--out", str(tmp_path / "new")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_rendering_needs_no_display() -> None:
    code = (
        "import matplotlib.pyplot as plt, sys, eeca_pymunk as ep, scenes, tempfile, pathlib\n"
        "s = scenes.build('signorini'); r = ep.record(ep.EECA(s.space), .01, .002)\n"
        "p = ep.render.animate(r, pathlib.Path(tempfile.mkdtemp()) / 'f.gif', dpi=40)\n"
        "assert p.stat().st_size and not plt.get_fignums()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env={"PATH": ""}, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr


def mixed_space() -> pymunk.Space:
    """A disk off the centre, a rounded box, a thick and a thin segment on moving bodies, a sensor, a static floor."""
    space = pymunk.Space()
    floor = pymunk.Segment(space.static_body, (-3, -1), (3, -1), 0.0)
    body = pymunk.Body(2.0, 1.0)
    body.position, body.angle, body.velocity = (1.0, 0.0), math.pi / 2, (0.0, 2.0)
    moving = [
        pymunk.Circle(body, 0.2, (1.0, 0.0)),
        pymunk.Poly(body, [(-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)], radius=0.1),
        pymunk.Segment(body, (-1.0, 0.0), (-0.5, 0.0), 0.1),
        pymunk.Segment(body, (-1.5, 0.0), (-1.2, 0.0), 0.0),
    ]
    sensor = pymunk.Circle(space.static_body, 0.1, (-1.0, 1.0))
    sensor.sensor = True
    space.add(body, *moving, floor, sensor)
    return space


def test_snapshot_draws_every_kind_of_shape_where_it_is(tmp_path: Path) -> None:
    path = tmp_path / "mixed.png"
    ax = render.snapshot(mixed_space(), path=path, view=(-2.0, 2.0, -2.0, 2.0))
    image = np.asarray(Image.open(path).convert("RGB")).astype(int)

    def color(x: float, y: float) -> np.ndarray:
        i, j = ax.transData.transform((x, y))
        return np.asarray(image[image.shape[0] - 1 - round(float(j)), round(float(i))])

    # The body is turned by a quarter: what is to the right of its centre is above it.
    for place in ((1.0, 1.0), (1.28, 0.0), (1.15, 0.15), (1.0, -0.75), (1.09, -0.75), (1.0, -1.35)):
        assert color(*place)[2] > color(*place)[0] + 40, place
    for place in ((1.29, 0.29), (1.12, -0.75), (1.05, -1.35), (1.0, -1.15), (0.0, 0.0)):
        assert color(*place).min() > 240, place
    assert color(0.0, -1.0).max() < 120
    assert color(-1.0, 1.0)[0] > color(-1.0, 1.0)[1] + 40


def test_outlines_and_recording_survive_a_file(tmp_path: Path) -> None:
    space = mixed_space()
    made = ep.record(ep.Native(space), 0.1, 0.05)
    made.save(tmp_path / "run.npz")
    again = ep.Recording.load(tmp_path / "run.npz")
    for name in ("row", "radius", "sensor", "count", "vertex"):
        np.testing.assert_array_equal(getattr(again.outlines, name), getattr(made.outlines, name))
    assert len(again.outlines) == 6
    np.testing.assert_allclose(
        Outlines.of(space, list(space.bodies)).place(made.position[-1], made.angle[-1])[0],
        next(iter(space.bodies)).local_to_world((1.0, 0.0)),
    )
    assert render.strip(again, [0.0, 0.1]).axes[1].get_title() == "0.1 s"
    with pytest.raises(ValueError, match="the recording goes from 0"):
        render.strip(again, [0.3])
    np.savez(tmp_path / "other.npz", time=np.zeros(3))
    with pytest.raises(ValueError, match=r"other.npz is not a file that Recording.save wrote"):
        ep.Recording.load(tmp_path / "other.npz")


def test_long_recordings_are_bounded_and_removed_bodies_are_nan() -> None:
    scene = scenes.build("gas")
    space = scene.space
    with pytest.raises(ValueError, match="give every >= 11"):
        ep.record(ep.EECA(space), 1.0, 0.01, memory=1e4)
    assert scene.bodies[0].position == scenes.build("gas").bodies[0].position

    class Losing(ep.Native):
        def step(self, dt: float) -> ep.StepReport:
            if self.time > 0.045:
                for body in list(self.space.bodies)[1:]:
                    self.space.remove(body, *body.shapes)
            return super().step(dt)

    made = ep.record(Losing(space), 0.1, 0.01)
    assert np.isnan(made.position[-1, 1:]).all()
    assert np.isfinite(made.position[:, 0]).all()
    assert np.isfinite(made.position[3]).all()


def test_snapshot_draws_impulses_as_pairs_of_arrows_at_their_points() -> None:
    scene = scenes.build("signorini")
    report = ep.EECA(scene.space).step(0.01)
    assert len(report.impulse) == 1
    plain = render.snapshot(scene.space)
    drawn = render.snapshot(scene.space, report=report)
    assert len(drawn.collections) - len(plain.collections) == 2
    up, down = drawn.collections[-2:]
    np.testing.assert_allclose(up.get_offsets(), report.contacts.point, atol=1e-12)
    assert up.V[0] == -down.V[0] != 0.0  # type: ignore[attr-defined]


def test_a_ledger_is_stacked_up_to_the_start_and_what_came_from_outside() -> None:
    space = lossy()
    recording = ep.record(ep.EECA(space), 1.5, 1 / 60)
    made = film.Film([recording, ep.record(ep.Native(lossy()), 1.5, 1 / 60)], frames=3)
    last = list(made.images())[-1]
    stack, lines = (panel.trace for panel in made.panels)
    assert isinstance(stack, traces.Stack)
    assert isinstance(lines, traces.Lines)
    assert [layer.get_label() for layer in stack.layers] == ["kinetic", "potential", "bounces", "friction"]
    start = recording.energy[0]
    np.testing.assert_allclose(stack.given, 1.0 + recording.ledger.external / start, atol=1e-14)
    np.testing.assert_allclose(stack.levels[-1][1], stack.given, atol=1e-12)
    np.testing.assert_allclose(stack.levels[1][1], recording.energy / start, atol=1e-14)
    # Its colours are in the picture, where its axes are.
    for k in (1, 2):
        low, high = (level[-2] for level in stack.levels[k])
        x, y = stack.ax.transData.transform((recording.time[-2], 0.5 * (low + high)))
        expected = np.array(to_rgb(stack.layers[k].get_facecolor())) * 255
        assert np.abs(last[last.shape[0] - 1 - round(y), round(x)] - expected).max() <= 3


def test_a_ledger_that_tells_of_nothing_is_not_stacked(recording: ep.Recording) -> None:
    assert recording.ledger.kept
    assert isinstance(film.Film(recording).panels[0].trace, traces.Lines)
