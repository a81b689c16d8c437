"""What README and docs print exists: commands run, in a short form, and pictures are there and small."""

from __future__ import annotations

import json
import re
import shlex
from dataclasses import replace
from pathlib import Path

import matplotlib
import pytest

import eeca_pymunk as ep
import scenes
from comparisons import engines, film, films, tour
from comparisons.__main__ import NAMES, chosen, command_line, main
from eeca_pymunk.model import bodies, joint_steps, joints, parameters

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
TOLD = [*PAGES, ROOT / "CHANGELOG.md", ROOT / "comparisons" / "GALLERY.md"]
LARGEST = 300_000  # bytes of a picture
# What else is printed, and the file that it runs, or that runs it.
OTHERS = {
    "bash .ci/run": ".ci/run",
    "bash .ci/wheel": ".ci/wheel",
    ".ci/clients": ".ci/clients",
    ".ci/oldest": ".ci/oldest",
    "python tests/mutations.py": "tests/mutations.py",
    "python -m tests.programs.soak": "tests/programs/soak.py",
    "python -m tests.programs.soak --gain 1e-8": "tests/programs/soak.py",
    "python -m tests.programs.soak --compositions": "tests/programs/soak.py",
    "python -m tests.bitwise": "tests/bitwise.py",
    "python -m eeca_pymunk": "tests/test_release.py",
    "python -m eeca_pymunk.model.parameters": "tests/model/test_parameters.py",
    "python -m eeca_pymunk.build": "tests/build/test_builder.py",
    "python -m eeca_pymunk.build --target PLATFORM": "tests/build/test_builder.py",
    "python docs/examples/balance.py": "tests/test_environment.py",
    "python -m build": "tests/test_release.py",
    'pip install -e ".[dev]"': ".ci/run",
    "pip install -e .": "README.md",
    "pip install eeca-pymunk": "pyproject.toml",
    'pip install -e ".[docs]"': ".ci/run",
    ".ci/site": ".ci/site",
    'pip install "eeca-pymunk[video]"': "pyproject.toml",
}
# Where the short form of each comparison is run.
SHORT = {
    "programs": "test_comparisons.py::test_programs_are_run_under_both_in_processes_of_their_own",
    "features": "test_comparisons.py::test_each_feature_takes_steps",
    "tour": "test_docs.py::test_tour_runs",
    "signorini": "test_comparisons.py::test_comparison_writes_table_and_pictures",
    "carom": "test_docs.py::test_films_run",
    "cradle": "test_comparisons.py::test_comparison_writes_table_and_pictures",
    "pool_break": "test_docs.py::test_films_run",
    "hopper": "test_docs.py::test_films_run",
    "work_precision": "test_comparisons.py::test_work_precision_finds_how_much_better_eeca_is",
    "scaling": "test_comparisons.py::test_scaling_tells_ratios_of_one_interleaved_run",
    "first_use": "test_comparisons.py::test_first_use_tells_seconds_of_imports_and_steps",
    "detection": "test_comparisons.py::test_detection_finds_what_pymunk_finds",
    "piles": "test_comparisons.py::test_short_piles_keep_their_books",
    "crowds": "test_comparisons.py::test_crowds_tell_how_much_of_their_time_they_take",
    "ablation": "test_comparisons.py::test_ablation_switches_each_heuristic_off_in_a_copy",
    "robots": "test_comparisons.py::test_robots_tell_costs_and_repeatability",
    "joints": "test_comparisons.py::test_joints_tell_errors_and_costs",
    "pymunk_examples": "test_comparisons.py::test_pymunks_examples_are_run_under_both",
    "rollouts": "test_comparisons.py::test_rollouts_tell_costs_and_wrong_films",
    "datasets": "test_comparisons.py::test_data_sets_are_judged_by_the_closed_form",
    "sleeping": (
        "test_comparisons.py::test_a_pile_that_sleeps_costs_little_and_wakes_stack_by_stack_in_the_step_that_touches_it"
    ),
    "meeting": "test_comparisons.py::test_where_features_meet_laws_hold",
    "soak": "test_comparisons.py::test_short_soak_keeps_energy_and_disks",
    "hard_cases": "test_hard_cases.py::test_matrix_tells_passes_failures_and_refusals",
    "maxwell": "test_comparisons.py::test_speeds_of_gases_become_those_of_a_shared_energy",
    "engines": "test_docs.py::test_engines_that_are_missing_are_skipped_with_a_word",
    "films": "test_docs.py::test_films_run",
    "gallery": "test_comparisons.py::test_gallery_page_shows_every_figure_and_table",
}


def text(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def commands() -> list[str]:
    """What follows `python -m comparisons`, wherever it is printed."""
    printed = (re.findall(r"python -m comparisons((?: [^\s`.;,)|]+(?:\.\w+)?)*)", text(page)) for page in TOLD)
    return sorted({one.strip() for found in printed for one in found})


def filmed() -> list[str]:
    return [one.split()[0] for one in commands() if "--animate" in one and one.split()[0] in scenes.NAMES]


@pytest.mark.parametrize("command", commands())
def test_printed_commands_exist(command: str) -> None:
    options = command_line().parse_args(shlex.split(command))
    if options.name is None or options.name == "NAME":
        return
    if any(one is not None for one in (options.animate, options.steppers, options.dt, options.duration)):
        assert film.options(options.steppers, options.animate, options.name)
        return
    run, _ = chosen(options)
    assert callable(run)


def test_other_commands_are_there() -> None:
    """Everything between backticks that looks like a command, and is no comparison."""
    quoted = {one for page in TOLD for one in re.findall(r"`([^`\n]+)`", text(page))}
    found = {one for one in quoted if re.match(r"(EECA_\w+=\S+ )?(python|pip|bash|\.ci/)", one) and one[-1] != "/"}
    assert {one for one in found if "python -m comparisons" not in one} == OTHERS.keys()
    for file in OTHERS.values():
        assert (ROOT / file).exists()
    assert "video = [" in text(ROOT / "pyproject.toml")


@pytest.mark.parametrize("name", NAMES)
def test_every_comparison_is_run_in_a_short_form(name: str) -> None:
    file, test = SHORT[name].split("::")
    assert f"def {test}(" in text(Path(__file__).parent / file)


def test_tour_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    for name, short in (("BUDGET", 0.0), ("REPEATS", 1), ("PILE_STEPS", 4), ("MOMENTS", 4), ("FRAMES", 2)):
        monkeypatch.setattr(tour, name, short)
    assert main(["tour", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    for scene in ("gas", "pendulum", "stack", "slope", "cradle"):
        assert re.search(rf"^{scene} .* \d", printed, flags=re.MULTILINE)
    assert "Where pymunk is better:" in printed
    assert printed.strip().splitlines()[-1].startswith("and your own space")
    assert {p.name for p in tmp_path.iterdir()} >= {"tour.png", "tour.gif", "tour.csv"}


@pytest.mark.parametrize("name", sorted(set(filmed())))
def test_films_run(name: str, tmp_path: Path) -> None:
    settings = film.FILMS[name]
    dt = settings.dt or scenes.build(name).dt
    path, size = films.one(tmp_path, (name, replace(settings, duration=3 * dt, frames=2, dpi=40)))
    assert name in films.NAMES
    assert 0 < size == Path(path).stat().st_size


def test_engines_that_are_missing_are_skipped_with_a_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("EECA_ENGINES", str(tmp_path / "none"))
    problems = [one for one in engines.problems.problems() if one.name in ("slope", "pendulum")]
    monkeypatch.setattr(engines, "listed", lambda: [replace(one, duration=0.1) for one in problems])
    scenes = [replace(one, steps=6) for one in engines.large.listed(0.02)]
    monkeypatch.setattr(engines.large, "listed", lambda: scenes)
    assert main(["engines", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    for name in engines.OTHERS:
        assert f"skipped {name}: " in printed
    row = re.search(r"^slope +EECA +0.01667 +(\S+) +(\S+)", printed, flags=re.MULTILINE)
    assert row is not None
    assert max(float(row[1]), float(row[2])) < 1e-12
    # us/step, x pymunk, overlap, pivots apart, rise of the energy
    row = re.search(r"^grid of joints +EECA +\S+ +\S+ +(\S+) +(\S+) +(\S+)", printed, flags=re.MULTILINE)
    assert row is not None
    assert max(float(x) for x in row.groups()) < 1e-12


def test_lines_wrap_at_120_but_for_tables_code_and_pictures() -> None:
    long = []
    for page in [*PAGES, ROOT / "CHANGELOG.md"]:
        code = False
        for number, line in enumerate(text(page).splitlines(), 1):
            code ^= line.startswith("```")
            if len(line) > 120 and not (code or line.startswith(("|", "![", "    "))):
                long.append(f"{page.name}:{number}")
    assert long == []


def test_links_between_files_lead_somewhere() -> None:
    """Files, and headings as GitHub and the site name them."""
    for page in TOLD:
        for link in re.findall(r"\]\(([^)\s]+)\)", text(page)):
            if "://" in link:
                continue
            file, _, anchor = link.partition("#")
            target = (page.parent / file).resolve() if file else page
            assert target.exists(), f"{page.name}: {link}"
            if anchor:
                heads = re.findall(r"^#+ (.*)$", text(target), flags=re.MULTILINE)
                assert anchor in {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}, link


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/method.md"])
def test_files_and_functions_that_pages_name_exist(page: str) -> None:
    """`room/file.py` and `room/file.py:function`, of the package or of the repository."""
    named = re.findall(r"`([\w/]+\.py)(?::(\w+))?`", text(ROOT / page))
    assert len(named) > 40
    for file, function in named:
        found = [folder / file for folder in (ROOT / "eeca_pymunk", ROOT) if (folder / file).exists()]
        assert found, file
        assert not function or f"\ndef {function}(" in text(found[0]), (file, function)


def test_parameters_and_states_that_the_method_names_exist() -> None:
    known = {name for found in parameters.table().values() for name in found}
    known |= {name for module in (bodies, joints, joint_steps) for name in vars(module) if name.isupper()}
    named = set(re.findall(r"\b[A-Z][A-Z_]{3,}\b", text(ROOT / "docs" / "method.md")))
    assert named - known == {"EECA"}


def test_every_page_is_in_the_site() -> None:
    told = text(ROOT / "mkdocs.yml") if (ROOT / "mkdocs.yml").exists() else pytest.skip("no sources")
    for page in PAGES:
        assert page.relative_to(ROOT).as_posix() in told, page


def test_every_public_name_has_its_place_in_the_api() -> None:
    told = set(re.findall(r"^::: eeca_pymunk\.(\w+)$", text(ROOT / "docs" / "api.md"), flags=re.MULTILINE))
    assert told == {name for name in ep.__all__ if name != "Closure"}


def test_the_notebook_runs_from_top_to_bottom(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("matplotlib.pyplot.show", lambda: None)
    monkeypatch.setattr("matplotlib.rcParams", {**matplotlib.rcParams, "backend": "agg"})
    names: dict[str, object] = {}
    for cell in json.loads(text(ROOT / "docs" / "first.ipynb"))["cells"]:
        assert not cell.get("outputs")  # it is kept without
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), "first.ipynb", "exec"), names)
    drift = names["drift"]
    assert isinstance(drift, dict)
    assert drift["EECA"] < 1e-12 < 1e-3 < drift["pymunk"]


def test_pictures_exist_and_are_small() -> None:
    shown = [
        (page.parent / link).resolve() for page in PAGES for link in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text(page))
    ]
    assert len(shown) > 10
    for picture in shown:
        assert 0 < picture.stat().st_size < LARGEST, picture
    # Tables that comparisons write beside them are not kept.
    kept = {p for folder in ("comparisons/figures", "docs/films") for p in (ROOT / folder).iterdir()}
    assert {p.resolve() for p in kept if p.suffix != ".csv"} <= set(shown)


def test_readme_is_short_and_has_one_command_of_tests() -> None:
    lines = text(ROOT / "README.md").splitlines()
    assert len(lines) <= 150
    assert [line for line in lines if "python -m pytest" in line] == [
        'python3 -m venv .venv && .venv/bin/pip install -e ".[test]" && .venv/bin/python -m pytest'
    ]
    first = next(line for line in lines if "python -m comparisons" in line and line.startswith("python3"))
    assert first.endswith("-m comparisons tour")
