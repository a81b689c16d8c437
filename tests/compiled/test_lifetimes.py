"""A record that a kernel reads lives as long as its array, which machine code frees after the last use of its name."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import eeca_pymunk

PACKAGE = Path(eeca_pymunk.__file__).parent
KERNELS = {"kernel", "nonallocating", "inlined"}


def dangling(source: str) -> list[str]:
    """Kernels and their arrays of records whose last use reads a field of a record: the array is freed between the
    look-up of the record and that of the field. Arrays are those that a call has made, alone or in a named tuple, but
    for tables, which `scene_of` and the like open."""
    found = []
    for kernel in ast.walk(ast.parse(source)):
        if not isinstance(kernel, ast.FunctionDef) or not KERNELS & {ast.unparse(d) for d in kernel.decorator_list}:
            continue
        made: dict[str, ast.Assign] = {}
        whole: dict[str, str] = {}  # the named tuple that an array is a part of, which keeps it too
        for node in sorted((n for n in ast.walk(kernel) if isinstance(n, ast.Assign)), key=lambda n: n.lineno):
            targets = node.targets[0].elts if isinstance(node.targets[0], ast.Tuple) else node.targets
            values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
            for target, value in zip(targets, values, strict=False):
                call = isinstance(value, ast.Call) and not ast.unparse(value.func).endswith("_of")
                part = isinstance(value, ast.Attribute) and ast.unparse(value.value) in made
                if isinstance(target, ast.Name) and (call or part):
                    made[target.id] = node
                    if part:
                        whole[target.id] = ast.unparse(value.value)
        fields = {
            id(root)
            for node in ast.walk(kernel)
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load)
            if isinstance(node.value, ast.Subscript) and not isinstance(node.value.slice, ast.Slice)
            for root in [node.value.value.value if isinstance(node.value.value, ast.Attribute) else node.value.value]
        }
        last: dict[str, ast.Name] = {}
        for node in ast.walk(kernel):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in made:
                before = last.get(node.id)
                if before is None or (before.lineno, before.col_offset) < (node.lineno, node.col_offset):
                    last[node.id] = node
        found += [
            f"{kernel.name}: {name}"
            for name, node in last.items()
            if id(node) in fields and not repeated(kernel, made[name], node)
            if whole.get(name) not in last or last[whole[name]].lineno < node.lineno
        ]
    return found


def repeated(kernel: ast.FunctionDef, made: ast.Assign, use: ast.Name) -> bool:
    """Whether a use is in a loop that does not make the array: it then lives until the loop ends."""
    for loop in ast.walk(kernel):
        if isinstance(loop, ast.For | ast.While):
            inside = {id(node) for node in ast.walk(loop)}
            if id(use) in inside and id(made) not in inside:
                return True
    return False


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: p.relative_to(PACKAGE).as_posix())
def test_no_field_is_read_at_the_last_use_of_its_array(path: Path) -> None:
    assert dangling(path.read_text()) == []


def test_such_a_read_is_found() -> None:
    source = "@kernel\ndef f() -> float:\n    OUT = zeros(1, SOLVED)\n    g(OUT)\n    return OUT[0].friction\n"
    assert dangling(source) == ["f: OUT"]
    source = "@kernel\ndef f() -> float:\n    c = make()\n    g(c)\n    return c.OUT[0].friction\n"
    assert dangling(source) == ["f: c"]
