"""The command line, scenes by name, and pictures."""

from __future__ import annotations

import ast
import csv
import importlib.util
import os
import re
import runpy
import shutil
from dataclasses import replace
from datetime import date
from importlib import import_module
from inspect import signature
from pathlib import Path

import numpy as np
import pymunk
import pytest
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons import (
    ablation,
    crowds,
    datasets,
    detection,
    features,
    film,
    films,
    first_use,
    gallery,
    joints,
    maxwell,
    meeting,
    meeting_scenes,
    pile_precision,
    piles,
    programs,
    pymunk_examples,
    robots,
    rollouts,
    runs,
    scaling,
    sleeping,
    soak,
    tour,
    work_precision,
)
from comparisons.__main__ import NAMES, main
from comparisons.hard_cases import matrix
from comparisons.hopper import crossed, deepest_overlap
from comparisons.output import Output
from eeca_pymunk.model import parameters
from eeca_pymunk.recorder import versions
from scenes import layouts, linkages, pendulum
from scenes.bars import Bars


def test_no_name_lists_all(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in NAMES)


def test_unknown_comparison(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["nonsense", "--out", str(tmp_path / "new")]) == 2
    assert "unknown comparison 'nonsense': choose one of programs" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_unwritable_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").touch()
    assert main(["carom", "--out", str(tmp_path / "file" / "below")]) == 2
    assert "file" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["signorini", "cradle"])
def test_comparison_writes_table_and_pictures(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([name, "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    for stepper in ("EECA Midstep", "native default", "native tuned 50", "trapezoidal", "max dissipation"):
        assert stepper in printed
    assert f"pymunk {versions()['pymunk']}" in printed
    with (tmp_path / f"{name}.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    drift = {row["stepper"]: float(row["max |dE/E|"]) for row in rows}
    assert drift["EECA Midstep"] <= 1e-13
    assert drift["max dissipation"] > 0.1
    pictures = list(tmp_path.glob("*.png"))
    assert pictures
    assert all(p.read_bytes()[:4] == b"\x89PNG" for p in pictures)


def test_unknown_scene_and_parameters() -> None:
    with pytest.raises(ValueError, match="unknown scene 'nonsense': choose one of signorini, carom"):
        scenes.build("nonsense")
    with pytest.raises(ValueError, match="hypothesis = 'iv'"):
        scenes.build("cradle", hypothesis="iv")
    with pytest.raises(ValueError, match="case = 'iv'"):
        scenes.build("pool_break", case="iv")


@pytest.mark.parametrize("name", scenes.NAMES)
def test_scenes_start_without_overlap_and_on_their_exact_solution(name: str) -> None:
    scene = scenes.build(name)
    exact = scene.exact(0.0)
    position = np.array([b.position for b in scene.bodies])
    if exact is not None:
        np.testing.assert_allclose(position, exact, atol=1e-15)
    report = ep.EECA(scene.space).step(1e-9)
    assert len(report.contacts) == 0 or report.contacts.gap.min() > -1e-12
    assert scene.dt > 0
    assert scene.duration > scene.dt


def test_hopper_has_the_papers_665_disks() -> None:
    assert len(scenes.build("hopper").bodies) == 665


def test_leaks_and_overlaps_are_seen() -> None:
    inside, outside = np.array([[0.0, 0.5]]), np.array([[0.5, 0.5]])
    assert crossed(inside, outside).all()
    assert not crossed(inside, inside + 0.01).any()
    assert not crossed(np.array([[0.0, 1.0]]), np.array([[0.9, 1.0]])).any()  # over the rim
    assert deepest_overlap(np.array([[0.0, 0.0], [0.006, 0.0]])) == pytest.approx(0.5)
    assert deepest_overlap(np.array([[0.0, 0.0], [0.009, 0.0]])) == 0.0


def test_snapshot_draws_disks_to_scale_without_display(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from matplotlib.image import imread

    monkeypatch.delenv("DISPLAY", raising=False)
    space = scenes.build("signorini").space
    ax = ep.render.snapshot(space, path=tmp_path / "disk.png", momentum=True, view=(-0.5, 0.5, -0.1, 0.9))
    image = imread(tmp_path / "disk.png")
    x, y = ax.transData.transform((0.03, 0.1))
    inside = image[image.shape[0] - 1 - round(float(y)), round(float(x)), :3]
    x, y = ax.transData.transform((0.12, 0.1))
    outside = image[image.shape[0] - 1 - round(float(y)), round(float(x)), :3]
    np.testing.assert_allclose(inside, (0.0, 0x72 / 255, 0xB2 / 255), atol=0.02)
    np.testing.assert_allclose(outside, 1.0)


def test_readme_example_runs(tmp_path: Path) -> None:
    readme = (Path(__file__).parents[1] / "README.md").read_text()
    examples = re.findall(r"```python\n(.*?)```", readme, flags=re.DOTALL)
    assert examples
    folder = os.getcwd()
    try:
        os.chdir(tmp_path)
        for i, code in enumerate(examples):
            (tmp_path / f"example_{i}.py").write_text(code)
            runpy.run_path(str(tmp_path / f"example_{i}.py"), run_name="__main__")
    finally:
        os.chdir(folder)


def test_work_precision_finds_how_much_better_eeca_is() -> None:
    problem = next(p for p in work_precision.problems() if p.name == "gas 20, T=0.1")
    points = [
        work_precision.measure(problem, name, make, dt)
        for name, make in ((work_precision.EECA, runs.eeca(ep.TimeOfImpact())), ("native default", runs.native()))
        for dt in (2e-2, 1e-3)
    ]
    row = work_precision.summary(problem.name, points)
    assert row["native best (m)"] == min(p.error for p in points[2:])
    assert max(p.error for p in points[:2]) < 1e-12
    assert float(row["native best (m)"] or 0.0) > 1e-4


JOINTS = ("1", "7", "12")  # rows that joints still owe


@pytest.mark.parametrize("number", [n for n in meeting.CASES if n not in JOINTS])
def test_where_features_meet_laws_hold(number: str) -> None:
    _, value, most = meeting.CASES[number][1]()
    assert value <= most


def test_ropes_and_bridges_without_slack_say_when_they_do_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meeting_scenes, "STEPS", 20)
    assert all(row["holds"] for row in meeting_scenes.taut())
    monkeypatch.setattr(meeting_scenes, "apart", lambda space: 1e-6)
    assert not any(row["holds"] for row in meeting_scenes.taut())


def test_first_use_tells_seconds_of_imports_and_steps() -> None:
    rows = first_use.look(looks=1)
    assert [row["what"] for row in rows][-1] == "all of it"
    seconds = [float(str(row["s"])) for row in rows]
    assert min(seconds) > 0.0
    assert seconds[-1] == pytest.approx(sum(seconds[:-1]), abs=seconds[-1])
    for file in first_use.EDITS.values():
        assert (Path(ep.__file__).parent / file).is_file()


def test_scaling_tells_ratios_of_one_interleaved_run() -> None:
    rows = scaling.case(lambda: scenes.build("gas", count=60), 60, 1e-3, warm=2, rounds=3)
    assert [row["stepper"] for row in rows] == ["native", "EECA", "EECA, sync", "EECA, queried"]
    assert rows[0]["x native"] == 1.0
    assert all(float(row["us/step"] or 0.0) > 0.0 for row in rows)
    assert float(rows[1]["us/collision"] or 0.0) > 0.0
    assert rows[0]["us/collision"] is None
    hopper = scaling.hopper(dt=2.5e-3, duration=0.25, parts=2)
    assert [row["to (s)"] for row in hopper] == pytest.approx([0.125, 0.25, 0.25])
    slopes = scaling.slopes(
        [{"N": n, "dt (s)": dt, "stepper": "x", "us/step": n**1.5} for n in (100, 1000, 4000, 16_000) for dt in (1e-3,)]
    )
    assert [row["slope"] for row in slopes] == pytest.approx([1.5])
    cost = [(2e-4, 10.0, 2.0), (1e-3, 40.0, 12.0)]
    marginal = scaling.marginal(
        [{"N": 1000, "dt (s)": dt, "stepper": "EECA", "us/step": us, "collisions/step": n} for dt, us, n in cost]
    )
    assert [row["us/collision more"] for row in marginal] == pytest.approx([3.0])
    paid = scaling.features(count=30, rounds=3)
    assert paid[0]["x plain"] == 1.0
    assert all(float(row["x plain"] or 0.0) > 0.0 for row in paid)


def test_workers_are_refused_where_times_are_measured(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scaling", "--workers", "2", "--out", str(tmp_path)]) == 2
    assert "scaling measures times or runs few cases: leave --workers out" in capsys.readouterr().err
    assert main(["maxwell", "--workers", "0", "--out", str(tmp_path)]) == 2
    assert "--workers 0: give a number >= 1" in capsys.readouterr().err


def test_workers_find_what_one_process_finds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All comparisons that take --workers, in a short form, on one process and on two."""
    monkeypatch.setattr(maxwell, "STEPPERS", {"EECA": maxwell.STEPPERS["EECA"]})
    monkeypatch.setattr(maxwell, "SEEDS", 4)
    monkeypatch.setattr(work_precision, "SEEDS", 2)
    problem = next(p for p in work_precision.problems() if p.name == "gas 20, T=0.1")
    pair = {work_precision.EECA: runs.eeca(ep.TimeOfImpact()), "native default": runs.native()}
    monkeypatch.setattr(work_precision, "problems", lambda: [problem])
    monkeypatch.setattr(work_precision, "jobs", lambda full: [(problem, *one, 0.02) for one in pair.items()])
    names = ("swap of velocities", "touching line of three")
    monkeypatch.setattr(matrix, "CASES", [one for one in matrix.CASES if one.name in names])
    for name, short in (("STEPS", 200), ("TURNS", 20), ("SWINGS", 40), ("MINUTES", 0.002)):
        monkeypatch.setattr(soak, name, short)
    monkeypatch.setattr(films, "NAMES", ("cradle", "chain"))
    for name in films.NAMES:
        monkeypatch.setitem(film.FILMS, name, replace(film.FILMS[name], duration=0.1, frames=2, dpi=40))
    taking = [n for n in NAMES if "workers" in signature(import_module(f"comparisons.{n}").run).parameters]
    assert taking == ["work_precision", "soak", "hard_cases", "maxwell", "films"]
    # What depends on the clock: costs, memory, and how far the hopper comes in its minutes.
    timed = {f"work_precision_{kind}" for kind in ("all.csv", "summary.csv", "gas_20_T0.1.png")}
    timed |= {"hard_cases_costs.csv", "soak_hopper.csv"}
    for name in taking:
        for workers in ("1", "2"):
            assert main([name, "--workers", workers, "--out", str(tmp_path / workers)]) == 0
    assert main(["soak", "--only", "joints", "--workers", "1", "--out", str(tmp_path / "3")]) == 0
    assert [path.name for path in (tmp_path / "3").iterdir()] == ["soak_joints.csv"]
    written = {path.name for path in (tmp_path / "1").iterdir()}
    assert written == {path.name for path in (tmp_path / "2").iterdir()}
    assert len([name for name in written if name.endswith(".csv")]) > 8
    for name in written - timed:
        one, two = ((tmp_path / workers / name).read_bytes() for workers in ("1", "2"))
        if name.endswith(".csv"):
            one, two = (re.sub(rb",[\d.]+(?=\r?\n)", b"", text) if name == "soak.csv" else text for text in (one, two))
            assert one.replace(b"/1/", b"/") == two.replace(b"/2/", b"/"), name
        else:
            assert one == two, name


def test_speeds_of_gases_become_those_of_a_shared_energy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(maxwell, "STEPPERS", {"EECA": maxwell.STEPPERS["EECA"]})
    monkeypatch.setattr(maxwell, "SEEDS", 30)
    assert main(["maxwell", "--workers", "2", "--out", str(tmp_path)]) == 0
    with (tmp_path / "maxwell.csv").open() as stream:
        (row,) = csv.DictReader(stream)
    assert float(row["max |dE/E|"]) < 1e-13
    # 600 speeds: one in a thousand sets drawn by chance is farther away than .08; the start is by .63.
    assert float(row["distance to finite"]) < 0.08
    assert maxwell.distance(np.ones(600), maxwell.finite(np.ones(600))) > 0.6
    assert (tmp_path / "maxwell.png").exists()
    # Two disks share their energy evenly between no and all of it: v² is uniform.
    v = np.linspace(0.0, 2.0**0.5, 9)
    np.testing.assert_allclose(maxwell.finite(v, 2), v**2 / 2.0, atol=1e-15)
    np.testing.assert_allclose(maxwell.finite(v, 10**7), maxwell.maxwell(v), atol=1e-6)


def test_tour_finds_how_much_smaller_errors_are_in_equal_time() -> None:
    # Little time for each curve: not what it takes, but what comes out is tested.
    bar = tqdm(disable=True)
    for problem in tour.problems():
        points = [tour.measure(problem, name, problem.dt / 4) for name in tour.STEPPERS]
        ours, native, tuned = points
        assert ours.energy < 1e-11
        assert ours.error < (1e-6 if problem.name == "pendulum" else 1e-9)
        assert min(native.error, tuned.error) > 10 * ours.error
    made = {problem.name: tour.curve(problem, "pymunk", bar) for problem in tour.problems()[3:]}
    assert all(points[-1].error < 0.1 * points[0].error for points in made.values())


def test_tour_says_where_pymunk_is_better(tmp_path: Path) -> None:
    def point(stepper: str, error: float, wall: float) -> tour.Point:
        return tour.Point(stepper, 0.1, error, 0.0, wall)

    better = [point("EECA", 1e-3, 0.02), point("EECA", 1e-4, 0.04), point("pymunk", 1e-2, 0.005)]
    worse = [point("EECA", 1e-3, 0.02), point("pymunk", 1e-5, 0.01), point("pymunk tuned", 1e-6, 0.03)]
    found = {"stack": better, "slope": worse}
    cheap = tour.summary("gas", [point("EECA", 1e-3, 0.001), point("pymunk", 1e-1, 0.01)])
    assert cheap["x smaller error"] == pytest.approx(100.0)  # where pymunk has no run as short, its shortest counts
    shown = [tour.summary(name, points) for name, points in found.items()]
    assert [row["x smaller error"] for row in shown] == pytest.approx([10.0, 0.01])
    told = "\n".join(tour.closing(shown, 8.0))
    assert "as good or better: slope." in told
    assert "stack 4, slope 2" in told
    assert "Next: python -m comparisons" in told
    picture = tmp_path / "tour.png"
    ep.render.save_picture(tour.picture(found, shown), picture)
    assert picture.exists()


def test_pendulums_swing_as_the_digits_say() -> None:
    scene = pendulum.build()
    for t, place in linkages.PENDULUM_AT.items():
        np.testing.assert_allclose(scene.exact(t), [place], atol=1e-13)
    assert pendulum.period(np.pi / 2, 1.0) == pytest.approx(linkages.PENDULUM_PERIOD, rel=1e-13)
    # Small swings are harmonic.
    assert pendulum.swing(1e-4, 2.0, 0.7) == pytest.approx(1e-4 * np.cos(0.7 * (9.81 / 2.0) ** 0.5), rel=1e-8)
    # One ball swings while the other hangs; after a period all is as at the start.
    cradle, whole = pendulum.cradle(), pendulum.period(np.pi / 6, 1.0)
    at = [cradle.exact(t) for t in (0.0, 0.5 * whole, whole)]
    assert at[0] is not None
    assert at[1] is not None
    np.testing.assert_allclose(at[1], at[0][::-1] * (-1.0, 1.0), atol=1e-13)
    np.testing.assert_allclose(at[2], at[0], atol=1e-13)
    with pytest.raises(ValueError, match="degrees = 180"):
        pendulum.build(degrees=180)


def test_detection_finds_what_pymunk_finds() -> None:
    for name in ("100 disks", "20 boxes", "100 disks 1:30"):
        row = detection.case(name, detection.cases()[name], steps=6, dt=0.01, looks=3)
        assert int(row["lists: pairs"] or 0) >= int(row["twin: pairs"] or 0) > 20


def test_detection_notices_a_pair_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(detection.Lists, "pairs", lambda self: set())
    with pytest.raises(ValueError, match="lists lack"):
        detection.case("gas", detection.cases()["100 disks"], steps=1)


def test_short_soak_keeps_energy_and_disks() -> None:
    last = soak.soak(2000, 2)[-1]
    assert float(last["max |dE/E|"] or 0.0) < 1e-12
    assert last["outside"] == 0
    assert float(last["deepest overlap (r)"] or 0.0) < 1e-9
    assert int(last["impacts"] or 0) > 100
    for name in soak.JOINTED:
        row = soak.linkage(200, name)
        assert float(row["EECA: |dE|/mgl"] or 0.0) < 1e-12
        assert float(row["EECA: joints apart (m)"] or 0.0) < 1e-12
        assert float(row["native: |dE|/mgl"] or 0.0) > 1e-2


def test_gallery_page_shows_every_figure_and_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = Path(__file__).parents[1] / "comparisons"
    page = (folder / "GALLERY.md").read_text()
    headings = "Fig. 1:|Figs. 4 and 5|Figs. 6 and 7|Figs. 8 and 9, Table II|Table III|Fig. 11|Figs. 12 to 14|Fig. 15"
    for name in headings.split("|"):
        assert f"## {name}" in page
    pictures = re.findall(r"\]\((gallery/[^)]+)\)", page)
    assert len(pictures) == 11
    for picture in pictures:
        assert 0 < (folder / picture).stat().st_size < 300_000
    # A page written from one part's run holds that run's numbers.
    monkeypatch.setattr(gallery, "PARTS", ("signorini",))
    for name in ("_SHOWN", "_TOLD"):
        parts = {k: v for k, v in getattr(gallery, name).items() if v[0].startswith("signorini")}
        monkeypatch.setattr(gallery, name, parts)
    template = tmp_path / "page.md"
    template.write_text("$made $dir\n$fig_1\n$figs_4_5\nto $closed_form, $disks disks\n")
    monkeypatch.setattr(gallery, "_PAGE", template)
    assert main(["gallery", "--out", str(tmp_path)]) == 0
    written = (tmp_path / "GALLERY.md").read_text()
    assert "| energy-momentum | 0.5 | 0.08464 | 0.5 |" in written
    assert f"`python -m comparisons signorini --full`, {date.today().isoformat()}" in written
    assert re.search(r"^to \de-\d\d, 665 disks$", written, re.MULTILINE)
    assert (tmp_path / "gallery" / "signorini_fig_1.png").exists()


def test_short_hopper_soak() -> None:
    last = soak.hopper(0.5, 2)[-1]
    assert float(last["max |dE/E|"] or 0.0) < 1e-12
    assert last["leaked"] == 0
    assert int(last["steps"] or 0) >= 2  # how many there are in half a second is a matter of the machine


def test_short_piles_keep_their_books() -> None:
    rows = piles.quick()
    assert [row["stepper"] for row in rows] == ["native 10", "native 100", "EECA"] * 3
    ours = [row for row in rows if row["stepper"] == "EECA"]
    for row in ours:
        assert float(row["ledger residual"] or 0.0) <= 1e-12
        assert float(row["energy rise"] or 0.0) <= 1e-12
        assert float(row["deepest (r)"] or 0.0) <= 0.1
        assert float(row["us/step"] or 0.0) > 0.0
    assert all(row["x native 10"] == 1.0 for row in rows if row["stepper"] == "native 10")
    shown = piles.summary([{**row, "N": piles.COUNTS[0]} for row in rows])
    assert [row["kind"] for row in shown] == list(piles.KINDS)


def test_ablation_switches_each_heuristic_off_in_a_copy(tmp_path: Path) -> None:
    heuristics = {n: p for found in parameters.table().values() for n, p in found.items() if p.kind == "heuristic"}
    assert ablation.OFF.keys() == heuristics.keys()
    copy = tmp_path / "eeca_pymunk" / "model" / "parameters"
    shutil.copytree(Path(parameters.__file__).parent, copy)
    for name, value in ablation.OFF.items():
        ablation.switched(name, value, tmp_path)
    with pytest.raises(ValueError, match="no heuristic"):
        ablation.switched("GAP_ROUND_OFF", "0.0", tmp_path)
    for path in copy.glob("*.py"):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
                name = ast.unparse(node.targets[0])
                if name in heuristics:
                    value = eval(ast.unparse(node.value.args[0]))
                    assert value == eval(ablation.OFF[name]) != heuristics[name].value, name
                    assert isinstance(value, type(heuristics[name].value)), name


@pytest.mark.parametrize("layout", layouts.LAYOUTS)
@pytest.mark.parametrize("kind", layouts.KINDS)
def test_layouts_begin_apart_and_come_to_rest(layout: str, kind: str) -> None:
    assert piles.deepest(layouts.build(layout, kind, 30)) == 0.0
    row = ablation.pile(layout, kind, seed=1, count=12, steps=240)
    assert row["rise"] <= 1e-13
    assert row["depth"] < 0.05
    if kind == "boxes":  # disks roll on: nothing resists
        assert row["moving"] <= 0.25


def test_depths_of_piles_are_seen() -> None:
    space = pymunk.Space()
    for x in (0.0, 0.8, 3.0):
        body = pymunk.Body(1.0, 1.0)
        body.position = (x, 0.0)
        space.add(body, pymunk.Circle(body, piles.R))
    assert piles.deepest(space) == pytest.approx(0.2 / piles.R)


def test_lasting_contacts_are_exact_and_pymunks_fall_with_dt() -> None:
    points = []
    for problem in pile_precision.problems()[:3]:
        found, _ = pile_precision.measure(problem, steps=(1 / 30, 1 / 60, 1 / 120))
        assert max(p.error for p in found if p.stepper == "EECA") < 1e-9
        assert min(p.error for p in found if p.stepper == "native 10") > 1e-5
        points += found
    slopes = {r["problem"]: r["slope in dt"] for r in pile_precision.slopes(points) if r["stepper"] == "native 10"}
    assert 0.5 < float(slopes["column that lands"] or 0.0) < 1.5


def test_joints_tell_errors_and_costs(tmp_path: Path) -> None:
    problem = joints.problems()[3]  # the chain, against its angles
    rows = joints.curves(problem, 0.0)
    assert [row["stepper"] for row in rows] == ["native 10", "native 100", "EECA"]
    assert float(rows[2]["error (m)"] or 0.0) < 1e-5
    assert float(rows[2]["energy error"] or 0.0) < 1e-12
    assert float(rows[2]["joints apart (m)"] or 0.0) < 1e-12
    assert float(rows[0]["error (m)"] or 0.0) > 1e-2
    shown = joints.summary(problem, rows)
    assert float(shown["EECA (m)"] or 0.0) < 1e-3 * float(shown["pymunk in no more time (m)"] or 0.0)
    cost = joints.price(joints.prices()[0], rounds=2)
    assert float(cost["EECA / native 10"] or 0.0) > 0.0
    ep.render.save_picture(joints.picture([problem], rows), tmp_path / "joints.png")
    assert (tmp_path / "joints.png").exists()


def test_crowds_tell_how_much_of_their_time_they_take() -> None:
    """A net of springs takes all of it, which a fortieth had been where intervals were halved without end."""
    for make in crowds.CROWDS.values():
        row = crowds.play(make, 1 / 60, 2)
        assert row["taken"] == pytest.approx(1.0)
        assert float(row["ms/step"] or 0.0) > 0.0
    assert float(crowds.play(crowds.net, 1 / 60)["in the last third"] or 0.0) > 0.99


def test_robots_tell_costs_and_repeatability() -> None:
    for name in robots.NAMES:
        ours, native = robots.compare(name, 1.0)
        assert ours["differs after reset (m)"] == ours["surplus (J)"] == 0.0
        assert float(ours["pivots apart (m)"] or 0.0) < 1e-12 < 1e-5 < float(native["pivots apart (m)"] or 0.0)
        assert float(ours["ms/step"] or 0.0) > 0.0
    assert robots.distance(ep.EECA, 10, 1 / 50, 0.5) == robots.distance(ep.EECA, 200, 1 / 50, 0.5)


def test_bars_by_their_angles_keep_their_energy_and_swing_as_the_digits_say() -> None:
    bars = Bars(np.ones(2), np.ones(2), np.full(2, 0.5), np.ones(2), np.zeros(2), 10.0)
    bars.run(1.0, 500)
    np.testing.assert_allclose(bars.places()[1], linkages.RODS_AT[1.0], atol=1e-10)


def test_a_pile_that_sleeps_costs_little_and_wakes_stack_by_stack_in_the_step_that_touches_it() -> None:
    costs, hits = sleeping.case(1000, 10, rounds=2)
    assert [row["asleep"] for row in costs] == [1000] * 3
    assert all(float(row["asleep (us/step)"] or 0.0) < 0.1 * float(row["awake (us/step)"] or 0.0) for row in costs)
    assert {(row["ball is hit in step"], row["woken in it"]) for row in hits} == {(5, 10)}


def test_pymunks_examples_are_run_under_both(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk_examples, "EXAMPLES", ("basic_test",))
    monkeypatch.setattr(pymunk_examples, "FRAMES", 2)
    assert main(["pymunk_examples", "--out", str(tmp_path)]) == 0
    if importlib.util.find_spec("pygame") is None:
        return
    with (tmp_path / "pymunk_examples.csv").open() as stream:
        (row,) = csv.DictReader(stream)
    assert (row["native"], row["ours"]) == ("runs", "runs")


def test_programs_are_run_under_both_in_processes_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(programs, "FRAMES", 3)
    monkeypatch.setattr(programs, "REPEATS", 1)
    assert main(["programs", "--only", "Push-T", "--out", str(tmp_path)]) == 0
    with (tmp_path / "programs.csv").open() as stream:
        (row,) = csv.DictReader(stream)
    assert (row["says"], row["steps"], row["re-reads"], row["calls"]) == ("runs", "2", "0", "0")
    assert len(row["path"]) == 8
    assert main(["programs", "--only", "nonsense", "--out", str(tmp_path)]) == 2
    assert main(["carom", "--only", "arrows", "--out", str(tmp_path)]) == 2


def test_each_feature_takes_steps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, short in (("BLOCKS", 2), ("STEPS", 11)):
        monkeypatch.setattr(features, name, short)
    assert main(["features", "--out", str(tmp_path)]) == 0
    with (tmp_path / "features.csv").open() as stream:
        assert [row["feature"] for row in csv.DictReader(stream)] == list(features.FEATURES)


def test_rollouts_tell_costs_and_wrong_films(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EECA_ENGINES", str(tmp_path / "none"))
    for name, short in (("ROUNDS", 1), ("ENOUGH", 1e-4), ("FILMS", 4), ("FRAMES", 240)):
        monkeypatch.setattr(rollouts, name, short)
    monkeypatch.setattr(rollouts, "SCENES", {name: rollouts.SCENES[name] for name in ("1 ball", "pendulum")})
    rollouts.run(Output("rollouts", tmp_path), False)
    assert {p.name for p in tmp_path.iterdir()} >= {"rollouts.csv", "rollouts_films.csv", "rollouts_films.png"}
    rows = rollouts.errors(False)
    ours = next(row for row in rows if row["engine"] == "EECA")
    assert ours["wrong after 1 s"] == ours["wrong after 4 s"] == 0.0
    assert max(row["wrong after 4 s"] for row in rows if row["engine"] == "pymunk") == 1.0


def test_data_sets_are_judged_by_the_closed_form(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EECA_ENGINES", str(tmp_path / "none"))
    films = datasets.pymunk_settings(40)
    ours = datasets.judged(films, datasets.by_eeca(films))
    assert ours["frames off > 1 px"] == ours["wrong velocities at the end"] == ours["passed through"] == 0.0
    assert ours["farthest (px)"] < 1e-10
    theirs = datasets.judged(films, datasets.by_pymunk(films))
    assert theirs["overlap > 1 px"] > 0.9
    slow = datasets.box2d_settings(True, 20)
    assert (slow.exact()[:, :, 1] - slow.exact()[:, :, 0] > slow.radius.sum(axis=1)[:, None] - 1e-12).all()
    assert datasets.judged(slow, datasets.by_eeca(slow))["farthest (px)"] < 1e-10
    assert "no " in str(datasets.by_box2d(slow))
    energy = (slow.mass * slow.v**2).sum(axis=1)
    np.testing.assert_allclose((slow.mass * slow.after() ** 2).sum(axis=1), energy, rtol=1e-12)
