"""pymunk's own test suite with `Space.step` replaced by ours."""

from __future__ import annotations

import gc
import re
import sys
import unittest
import warnings
from collections.abc import Iterator
from pathlib import Path

import pymunk.tests
import pytest

from comparisons.replaced import replaced

from .differs import DIFFERS

ROOT = Path(__file__).parents[2]


def found(suite: unittest.TestSuite) -> Iterator[unittest.TestCase]:
    for one in suite:
        if isinstance(one, unittest.TestSuite):
            yield from found(one)
        else:
            yield one


CASES = {case.id(): case for case in found(unittest.TestLoader().discover(str(Path(pymunk.tests.__file__).parent)))}


def outcome(name: str) -> tuple[bool, str]:
    """Whether the test passes under ours, and what it says if not."""
    case = CASES[name]
    result = unittest.TestResult()
    told: list[str] = []
    gc.freeze()  # one of them collects garbage 720 times, which all that is loaded here would make slow
    # What a callback raises, pymunk's library written in C drops.
    hook, sys.unraisablehook = sys.unraisablehook, lambda dropped: told.append(repr(dropped.exc_value))
    try:
        with replaced(), warnings.catch_warnings():
            warnings.simplefilter("default")
            type(case)(case._testMethodName).run(result)
    finally:
        sys.unraisablehook = hook
        gc.unfreeze()
    told += [text for _, text in (*result.errors, *result.failures)]
    return not told, "\n".join(told)


@pytest.mark.parametrize("name", sorted(CASES.keys() - DIFFERS.keys()))
def test_of_pymunk_passes(name: str) -> None:
    passes, told = outcome(name)
    assert passes, told


@pytest.mark.parametrize("name", sorted(DIFFERS))
def test_of_pymunk_differs_and_is_listed(name: str) -> None:
    passes, told = outcome(name)
    assert not passes, f"{name} passes now: take it out of differs.py and docs/pymunk.md"
    assert "UnsupportedFeature" not in told


def test_lists_are_of_tests_that_there_are() -> None:
    assert len(CASES) > 150
    assert not DIFFERS.keys() - CASES.keys()


def test_docs_give_every_reason() -> None:
    page = re.sub(r"\s+", " ", (ROOT / "docs" / "pymunk.md").read_text())
    for name, reason in DIFFERS.items():
        assert f"`{name.split('.', 1)[1]}`" in page, name
        assert reason in page, name
