"""docs/pymunk.md names every public class and property of pymunk, and tests that exist."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pymunk

TESTS = Path(__file__).parents[1]
PAGE = (TESTS.parent / "docs" / "pymunk.md").read_text()
UNTOUCHED = {
    "BB", "Vec2d", "Transform", "PointQueryInfo", "SegmentQueryInfo", "ShapeQueryInfo", "SpaceDebugDrawOptions",
}  # fmt: skip
# By the heading, whose names stand below it; all others are joints.
SHAPES, ARBITERS = "Shape, Circle, Segment, Poly", "Arbiter, ContactPointSet, ContactPoint"
HEADINGS = {
    "Space": "Space", "Body": "Body", "Shape": SHAPES, "Circle": SHAPES, "Segment": SHAPES, "Poly": SHAPES,
    "ShapeFilter": SHAPES, "Arbiter": ARBITERS, "ContactPointSet": ARBITERS, "ContactPoint": ARBITERS,
}  # fmt: skip
SECTIONS = {part.split("\n", 1)[0]: part for part in PAGE.split("\n## ")}
FEATURES = list(dict.fromkeys([*HEADINGS.values(), "Joints"]))
NAMED_TUPLE = {"count", "index"}


def test_every_class_and_property_has_its_row() -> None:
    classes = [c for _, c in inspect.getmembers(pymunk, inspect.isclass) if c.__module__.startswith("pymunk")]
    assert len(classes) > 25
    missing = [c.__name__ for c in classes if not re.search(rf"\b{c.__name__}\b", PAGE)]
    for c in classes:
        if c.__name__ not in UNTOUCHED:
            section = SECTIONS[HEADINGS.get(c.__name__, "Joints")]
            # Also what is inherited, and fields that have no value on the class.
            names = {n for n in (*dir(c), *inspect.get_annotations(c)) if not n.startswith("_")}
            missing += [f"{c.__name__}.{n}" for n in names - NAMED_TUPLE if f"`{n}`" not in section]
    assert missing == []


def test_every_function_and_module_is_told() -> None:
    told = SECTIONS["Independent of steps"]
    functions = [n for n, f in inspect.getmembers(pymunk, inspect.isfunction) if f.__module__.startswith("pymunk")]
    assert "moment_for_circle" in functions
    modules = ["autogeometry", "batch", "pygame_util", "pyglet_util", "matplotlib_util"]
    for name in functions:
        assert f"`{name}`" in told or f"`{re.sub('_for_.*', '_for_*', name)}`" in told, name
    for name in modules:
        assert f"`pymunk.{name}`" in told, name


def test_every_row_names_a_test() -> None:
    for heading in FEATURES:
        rows = [line for line in SECTIONS[heading].splitlines() if line.startswith("|")][2:]
        assert len(rows) > 5
        for row in rows:
            assert re.search(r"`[\w/]+\.py(::\w+)?` \|$", row), row


def test_every_test_that_is_named_exists() -> None:
    named = re.findall(r"`(?!eeca_pymunk)(?:tests/)?([\w/]+\.py)(?:::(\w+))?`", PAGE)
    assert len(named) > 30
    for file, function in named:
        text = (TESTS / file).read_text()
        assert f"def {function}(" in text if function else text, (file, function)
