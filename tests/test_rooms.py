"""The cut of the package: imports go down only, pymunk stays at the edge, its private names in one room."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import eeca_pymunk
from eeca_pymunk.space.private import joints as private_joints
from eeca_pymunk.space.private import spaces as private

PACKAGE = Path(eeca_pymunk.__file__).parent
FILES = sorted(PACKAGE.rglob("*.py"))
# From the bottom to the top; a room may import what stands on an earlier line, and itself.
FLOORS = (
    "arguments arrays layout errors files reentry",
    "compiled",
    "model",
    "energy",
    "transfer unmet",
    "report",
    "rehearsing world_rows",
    "geometry",
    "rows",
    "pairs",
    "prediction",
    "newton",
    "contacts joints",
    "sleepers",
    "islands",
    "jointed",
    "impacts",
    "closures",
    "space",
    "saved",
    "stepper",
    "packed_space",
    "hooked_stepper",
    "packed_stepper",
    "states",
    "runs",
    "eeca baselines",
    "events warming",
    "recording rolling datasets",
    "build recorder sweep",
    "rollouts",
    "render",
    "__init__ __main__",
)
FLOOR = {room: number for number, line in enumerate(FLOORS) for room in line.split()}
PYMUNK = {"space", "baselines/native"}


def name(path: Path) -> str:
    return path.relative_to(PACKAGE).with_suffix("").as_posix()


def room(path: Path) -> str:
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def imports(path: Path) -> Iterator[tuple[str, ...]]:
    """The modules that a file imports when it runs, those of this package without its name."""
    tree = ast.parse(path.read_text())
    for node in list(ast.walk(tree)):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            node.body = []
    here = path.relative_to(PACKAGE).with_suffix("").parts
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (tuple(alias.name.split(".")) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level] if node.level else ()
            parts = (*base, *(node.module or "").split("."))
            parts = tuple(p for p in parts if p)
            if parts[:1] == ("eeca_pymunk",):
                parts = parts[1:]
            yield from ((*parts, alias.name) for alias in node.names)


@pytest.mark.parametrize("path", FILES, ids=name)
def test_imports_go_down(path: Path) -> None:
    own = room(path)
    assert own in FLOOR, f"say in FLOORS where {own} stands"
    for parts in imports(path):
        other = parts[0]
        if other in FLOOR and other != own:
            assert FLOOR[other] < FLOOR[own], f"{name(path)} imports {'.'.join(parts)}"


@pytest.mark.parametrize("path", FILES, ids=name)
def test_pymunk_stays_at_the_edge(path: Path) -> None:
    if any(parts[0] == "pymunk" for parts in imports(path)):
        assert PYMUNK & {room(path), name(path)}


# What pymunk keeps to itself; all that `private` looks up at import is here.
NAMES = {*private._OF_SPACE, *private._OF_BODY, *private.PHASES, *private_joints.OF_CONSTRAINT}
NAMES |= {"_body", "_shape", "_arbiter", "_force_func", "_torque_func", "_float_arr", "_int_arr", "_remove", "_bb"}
NAMES |= {"_shapes", "_constraints"}
PRIVATE = re.compile(rf"_chipmunk|\bcp[A-Z]\w+|\.({'|'.join(sorted(NAMES))})\b")


@pytest.mark.parametrize("path", [p for p in FILES if not name(p).startswith("space/private/")], ids=name)
def test_private_names_of_pymunk_stand_in_one_place(path: Path) -> None:
    text = re.sub(r"self\._\w+", "", path.read_text())
    assert PRIVATE.findall(text) == []


@pytest.mark.parametrize("path", sorted(p for p in PACKAGE.iterdir() if (p / "__init__.py").exists()), ids=name)
def test_rooms_introduce_themselves(path: Path) -> None:
    text = ast.get_docstring(ast.parse((path / "__init__.py").read_text()))
    assert text is not None
    if room(path) not in ("render",):
        assert "In:" in text
        assert re.search(r"Open (first|`\w+\.py` first)", text)
    for file in re.findall(r"`(\w+\.py)`", text):
        assert (path / file).exists() or (PACKAGE / file).exists()


MOST_FILES = 30


@pytest.mark.parametrize("path", sorted({p.parent for p in FILES}), ids=lambda p: p.name)
def test_rooms_have_few_files(path: Path) -> None:
    assert len(list(path.glob("*.py"))) <= MOST_FILES


MOST_LINES = 250


@pytest.mark.parametrize("path", FILES, ids=name)
def test_files_are_short(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= MOST_LINES


MOST_ARGUMENTS = 12


@pytest.mark.parametrize("path", FILES, ids=name)
def test_functions_take_few_arguments(path: Path) -> None:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            of = node.args
            if len(of.posonlyargs) + len(of.args) + len(of.kwonlyargs) - (of.args[:1] == ["self"]) > MOST_ARGUMENTS:
                found.add(node.name)
    assert found == set(), "take records"


# Files whose arrays have columns by number, which are still to become records; nothing may be added.
NUMBERED = {
    "impacts/begin", "impacts/run", "jointed/ledger", "jointed/welds", "rehearsing", "transfer",
}  # fmt: skip
KERNELS = (
    "contacts", "energy", "geometry", "impacts", "islands", "jointed", "joints", "newton", "pairs", "prediction",
    "rehearsing", "rows", "transfer",
)  # fmt: skip


def numbered(tree: ast.Module) -> set[str]:
    """Names of integer constants, the module's own, imported or of imported modules, by which its kernels index
    arrays."""
    constants, modules = set(), set()
    for node in tree.body:
        if isinstance(node, ast.Assign) and all(
            isinstance(value, ast.Constant) and isinstance(value.value, int)
            for value in (node.value.elts if isinstance(node.value, ast.Tuple) else [node.value])
        ):
            constants |= {one.id for target in node.targets for one in ast.walk(target) if isinstance(one, ast.Name)}
        if isinstance(node, ast.ImportFrom):
            constants |= {alias.asname or alias.name for alias in node.names}
            modules |= {alias.asname or alias.name for alias in node.names if alias.name.islower()}
    constants = {one for one in constants if one.isupper() and len(one) > 1}
    found = set()
    for kernel in ast.walk(tree):
        if not isinstance(kernel, ast.FunctionDef) or not kernel.decorator_list:
            continue
        if not {"kernel", "nonallocating", "inlined"} & {ast.unparse(one) for one in kernel.decorator_list}:
            continue
        for node in ast.walk(kernel):
            if isinstance(node, ast.Subscript):
                parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
                bare = [
                    one for part in parts for one in (part, getattr(part, "left", None), getattr(part, "right", None))
                ]
                found |= {one.id for one in bare if isinstance(one, ast.Name) and one.id in constants}
                of_modules = [one for one in bare if isinstance(one, ast.Attribute) and one.attr.isupper()]
                found |= {one.attr for one in of_modules if ast.unparse(one.value) in modules}
    return found


@pytest.mark.parametrize("path", [path for path in FILES if room(path) in KERNELS], ids=name)
def test_kernels_name_fields_of_records(path: Path) -> None:
    found = numbered(ast.parse(path.read_text()))
    assert bool(found) == (name(path) in NUMBERED), f"make records of what {found} number, or shorten the list"
