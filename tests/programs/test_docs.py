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


def test_every_class_and_property_has_its_row() -> None:
    classes = [c for _, c in inspect.getmembers(pymunk, inspect.isclass) if c.__module__.startswith("pymunk")]
    assert len(classes) > 25
    missing = [c.__name__ for c in classes if not re.search(rf"\b{c.__name__}\b", PAGE)]
    for c in classes:
        if c.__name__ not in UNTOUCHED:
            missing += [f"{c.__name__}.{n}" for n in vars(c) if not n.startswith("_") and f"`{n}`" not in PAGE]
    assert missing == []


def test_every_test_that_is_named_exists() -> None:
    named = re.findall(r"`(?!eeca_pymunk)(?:tests/)?([\w/]+\.py)(?:::(\w+))?`", PAGE)
    assert len(named) > 30
    for file, function in named:
        text = (TESTS / file).read_text()
        assert f"def {function}(" in text if function else text, (file, function)
