"""The parameters: what the tables say is what kernels have."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import eeca_pymunk
from eeca_pymunk.model import parameters
from eeca_pymunk.model.parameters.__main__ import markdown

PACKAGE = Path(eeca_pymunk.__file__).parent
KERNEL_ROOMS = (
    "geometry", "pairs", "rows", "prediction", "contacts", "islands", "impacts", "newton", "joints", "jointed",
)  # fmt: skip


def test_every_name_has_its_own_record() -> None:
    for section, found in zip(parameters.SECTIONS, parameters.table().values(), strict=True):
        for name, parameter in found.items():
            assert getattr(section, name) == parameter.value, name
            assert parameter.kind in ("round-off", "accuracy", "work", "heuristic")
            assert parameter.scale, name
            assert parameter.effect.endswith("."), name
    assert sum(map(len, parameters.table().values())) == len(parameters.DECLARED)


def test_every_parameter_is_used() -> None:
    names: set[str] = set()
    for path in PACKAGE.rglob("*.py"):
        if "parameters" not in path.parts:
            names |= {node.id for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Name)}
            names |= {node.attr for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Attribute)}
    unused = [n for found in parameters.table().values() for n in found if n not in names]
    assert not unused


@pytest.mark.parametrize("room", KERNEL_ROOMS)
def test_kernels_define_no_tolerances_of_their_own(room: str) -> None:
    """Numbers of type float are parameters, so that the record has all of them."""
    for path in (PACKAGE / room).glob("*.py"):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
                assert not isinstance(node.value.value, float), f"{path.name}:{node.lineno}"


def test_docs_print_the_record() -> None:
    page = PACKAGE.parent / "docs" / "parameters.md"
    if not page.exists():
        pytest.skip("the package is tested without its docs")
    assert markdown().strip() in page.read_text()
