"""The declaration of entry points: complete, and true of the arrays that are passed."""

from __future__ import annotations

import ast
import importlib
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import eeca_pymunk
from eeca_pymunk.compiled.entries import ENTRIES, SOURCES, TABLES, is_array, table_fields
from eeca_pymunk.compiled.kernels import Kernel, kernels
from eeca_pymunk.compiled.layouts import Layout, Plan
from eeca_pymunk.compiled.tables import replaced, table_of
from eeca_pymunk.model.islands import Island, IslandContacts
from eeca_pymunk.model.joints import Joints
from eeca_pymunk.model.run import RunArrays
from eeca_pymunk.model.scene import Scene
from eeca_pymunk.model.values import Reading, reading_of
from tests.packed import scene_with

PACKAGE = Path(eeca_pymunk.__file__).parent
MODULES = [
    p for p in sorted(PACKAGE.rglob("*.py")) if not {"frontend", "build"} & set(p.parts) and p.name != "__main__.py"
]


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def named_outside_kernels(path: Path) -> Iterator[Kernel[..., object]]:
    """The kernels that functions of a module name which are no kernels themselves."""
    there = vars(importlib.import_module(module_name(path)))
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in list(ast.walk(tree)):
        if isinstance(node, ast.FunctionDef) and isinstance(there.get(node.name), Kernel):
            node.body = []
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "Choice":
            node.args = []  # of which kernels call one
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(found := there.get(node.id), Kernel):
            yield found
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module = there.get(node.value.id)
            if isinstance(module, ModuleType) and isinstance(found := getattr(module, node.attr, None), Kernel):
                yield found


def test_python_calls_no_kernel_without_an_entry() -> None:
    called = {one.name for path in MODULES for one in named_outside_kernels(path)}
    of_tests = {"contacts.interval:step_island"}
    assert called | of_tests == set(ENTRIES)


def in_sources(name: str) -> bool:
    path = name.removeprefix("eeca_pymunk.").replace(".", "/")
    return any(path == source.removesuffix(".py") or path.startswith(f"{source}/") for source in SOURCES)


def test_libraries_carry_the_hash_of_all_that_kernels_are_made_of() -> None:
    """The modules of kernels, and those that they import numbers and types from."""
    for path in MODULES:
        importlib.import_module(module_name(path))
    modules = {m for one in kernels().values() if (m := one.python.__module__).startswith("eeca_pymunk.")}
    assert len(modules) > 80
    assert [name for name in sorted(modules) if not in_sources(name)] == []
    for name in modules:
        here = importlib.import_module(name)
        for value in vars(here).values():
            owner = getattr(value, "__module__", "") or ""
            if owner.startswith("eeca_pymunk.") and not owner.startswith("eeca_pymunk.compiled"):
                assert in_sources(owner), f"{name} names {value}"


@pytest.mark.parametrize("kind", [Scene, Reading, Joints, Island, IslandContacts, RunArrays])
def test_tables_have_the_fields_of_their_named_tuples(kind: type) -> None:
    assert tuple(name for name, _, _ in table_fields(kind.__name__)) == kind._fields  # type: ignore[attr-defined]
    assert set(TABLES) == {"Scene", "Reading", "Joints", "Island", "IslandContacts", "RunArrays"}


@pytest.mark.parametrize("name", ENTRIES)
def test_entries_declare_every_argument(name: str) -> None:
    room, _, function = name.partition(":")
    kernel = getattr(importlib.import_module(f"eeca_pymunk.{room}"), function)
    assert kernel.name == name
    arguments = inspect.signature(kernel.python).parameters
    kinds = ENTRIES[name].split()
    assert len(kinds) == len(arguments)
    annotated = {"float": ("f8",), "int": ("i8",), "bool": ("bool",)}
    for kind, argument in zip(kinds, arguments.values(), strict=True):
        if argument.annotation in annotated:
            assert kind in annotated[argument.annotation]
        else:
            assert is_array(kind), argument


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"POOL": np.zeros(4)}, r"Scene.POOL is float64\[1\]; entries.TABLES declares int32\[1\]"),
        ({"BODY": np.zeros((4, 3))}, r"Scene.BODY is float64\[2\]; entries.TABLES declares Body\[1\]"),
        ({"PULL": np.zeros((4, 3)).T}, r"Scene.PULL of shape \(3, 4\) has strides \(8, 24\): it must be C-contiguous"),
        ({"KEYS": np.zeros((1, 1), np.int64)}, "Scene.KEYS"),
    ],
)
def test_tables_of_other_arrays_are_refused(wrong: dict[str, np.ndarray], told: str) -> None:
    if eeca_pymunk.compiled.plain():
        pytest.skip("a table is the tuple itself")
    arrays = Scene(*(np.zeros((1,) * ndim, dtype) for _, dtype, ndim in table_fields("Scene")))
    assert table_of(arrays).arrays is arrays
    with pytest.raises(TypeError, match=told):
        table_of(arrays._replace(**wrong))


def test_a_replaced_array_is_in_the_words_and_in_the_arrays() -> None:
    arrays, other = scene_with(), np.zeros((2, 3))
    table, wanted = table_of(arrays), arrays._replace(BEGAN=other)
    new = replaced(table, Scene, "BEGAN", other)
    if table is not arrays:
        assert new is table  # kernels stay bound to it
        assert new.words.tolist() == table_of(wanted).words.tolist() != table_of(arrays).words.tolist()
        with pytest.raises(TypeError, match=r"Scene\.BEGAN"):
            replaced(table, Scene, "BEGAN", np.zeros(3))
        new = new.arrays
    assert all(one is two for one, two in zip(new, wanted, strict=True))


def test_a_layout_lays_what_was_replaced_anew() -> None:
    """The next table of a layout has the arrays of its plan, not those that have replaced some in the last one."""
    plan = Plan(Reading, ("TOTALS",), 1, (), {n: np.zeros((1,) * d, t) for n, t, d in table_fields("Reading")[1:]}, {})
    layout = Layout(plan)
    first = layout.lay({"TOTALS": 3})
    words = None if isinstance(first, Reading) else first.words.tolist()
    other = np.zeros((5, 2))
    assert reading_of(replaced(first, Reading, "POINT_PLACED", other)).POINT_PLACED is other
    again = layout.lay({"TOTALS": 3})
    assert reading_of(again).POINT_PLACED is plan.constant["POINT_PLACED"]
    assert words is None or again.words.tolist() == words
