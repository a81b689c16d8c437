"""Compiled parts and object code, in files named by a hash of everything that they depend on.

A part depends on the code of its kernel, on the constants and types that it uses, on the return types of the kernels
that it calls, on the types of its arguments, and on the versions of the compiler. After an edit of one kernel one part
is compiled again. Files that no build has read for `DAYS` are removed.
"""

from __future__ import annotations

import contextlib
import dis
import functools
import hashlib
import itertools
import os
import pickle
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from types import BuiltinFunctionType, CodeType, ModuleType
from typing import Any

import llvmlite
import numba
import numpy as np

from ..entries import ENTRIES, TABLES, table_fields
from ..kernels import Choice, Fetch, Kernel, kernels
from ..sources import cache_folder
from ..tables import Opener
from .calls import Call, annotated
from .module import Group
from .parts import Part

DAYS = 30
_HERE = Path(__file__).parent


def digest(*parts: object) -> str:
    """Hash of the representations of some objects, 64 hexadecimal digits."""
    return hashlib.sha256("\0".join(map(repr, parts)).encode()).hexdigest()


@functools.cache
def _compiler(*files: str) -> str:
    """The hash of the compiler, as far as it is in these files of this folder."""
    texts = [_HERE.joinpath(file).read_bytes() for file in files]
    return digest(numba.__version__, llvmlite.__version__, sys.version_info[:2], *texts)


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield from _names(one)


def _globals_of(code: CodeType, known: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """The globals that a kernel uses, those of modules of this package as `module.name`."""
    for name in set(_names(code)) & known.keys():
        value, module = known[name], getattr(known[name], "__name__", "")
        yield name, value
        if isinstance(value, ModuleType) and module.startswith("eeca_pymunk."):
            yield from ((f"{name}.{one}", getattr(value, one)) for one in _attributes(code, name))


def _attributes(code: CodeType, module: str) -> set[str]:
    """The names of a module that a function uses."""
    steps = [one for one in dis.get_instructions(code) if one.opname not in ("CACHE", "PUSH_NULL", "PRECALL")]
    return {
        after.argval
        for one, after in itertools.pairwise(steps)
        if one.opname == "LOAD_GLOBAL" and one.argval == module and after.opname in ("LOAD_ATTR", "LOAD_METHOD")
    }


def _content_of(code: CodeType, doc: str | None = None) -> tuple[object, ...]:
    """The compiled content of a function, from memory, since its file may have been edited after the import."""
    constants = [_content_of(one) if isinstance(one, CodeType) else repr(one) for one in code.co_consts if one != doc]
    return code.co_code, constants, code.co_names, code.co_varnames, code.co_freevars


@functools.cache
def source_key(kernel: Kernel[Any, Any]) -> str:
    """The hash of a kernel's code and of all globals that it uses."""
    python = kernel.python
    named = [
        (name, _dependence(value, f"{kernel.name} names {name}"))
        for name, value in sorted(_globals_of(python.__code__, python.__globals__), key=lambda one: one[0])
    ]
    code = _content_of(python.__code__, python.__doc__)
    return digest(kernel.name, kernel.counted, kernel.inlined, code, python.__annotations__, named)


def _dependence(value: Any, where: str) -> object:
    """The part of a global on which the code that uses it depends."""
    if isinstance(value, Kernel):
        returned = annotated(value)
        return value.name, source_key(value) if returned is None else repr(returned)
    if isinstance(value, Choice):
        return [_dependence(one, where) for one in value.kernels]
    if isinstance(value, Opener):
        name = value.kind.__name__
        return name, table_fields(name) if name in TABLES else ()
    if isinstance(value, np.dtype):
        return repr(value)
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, (int, float, str, tuple, type(None))):
        return type(value).__name__, value
    if isinstance(value, type):
        return value.__name__, getattr(value, "_fields", ()), str(getattr(value, "__annotations__", ""))
    if isinstance(value, (ModuleType, BuiltinFunctionType, Fetch)):
        return getattr(value, "__name__", "fetch")
    raise TypeError(f"{where}, a {type(value).__name__}: kernels name numbers, arrays, types, modules and kernels")


def part_key(call: Call) -> str:
    """The name under which a part is stored."""
    kernel, args = call
    compiler = _compiler("calls.py", "parts.py", "types.py", "../tables.py", "../records.py")
    return digest(compiler, TABLES, source_key(kernel), args)


def group_key(group: Group, triple: str, cpu: str) -> str:
    """The name under which an object file is stored."""
    code = [hashlib.sha256(one).hexdigest() for one in group.parts]
    compiler = _compiler("module.py", "runtime.ll", "../library.py")
    declared = [(name, repr(returned), ENTRIES.get(name)) for name, returned in group.entries]
    return digest(compiler, declared, code, sorted(group.public), sorted(group.foreign), triple, cpu)


def _path(kind: str, key: str) -> Path:
    return cache_folder() / kind / key[:2] / key


def read(kind: str, key: str) -> bytes | None:
    """The content stored under this key, or None."""
    path = _path(kind, key)
    try:
        found = path.read_bytes()
    except OSError:
        return None
    with contextlib.suppress(OSError):
        os.utime(path)
    return found or None


def write(kind: str, key: str, content: bytes) -> None:
    """Store the content, if there is a writable folder; a reader sees all of it or nothing."""
    path = _path(kind, key)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(content)
        os.replace(file.name, path)
    except OSError:
        pass


def read_part(call: Call) -> Part | None:
    """The part of this call, if it was compiled before."""
    content = read("parts", part_key(call))
    if content is None:
        return None
    all_kernels = kernels()
    try:
        bitcode, called, returned, seconds = pickle.loads(content)
        return Part(bitcode, [(all_kernels[name], args) for name, args in called], returned, seconds)
    except Exception:  # a truncated file, whatever pickle raises
        return None


def write_part(call: Call, part: Part) -> None:
    """Store a part, unless it was compiled with random hashes, on which the order of its instructions depends."""
    if sys.flags.hash_randomization:
        return
    called = [(kernel.name, args) for kernel, args in part.calls]
    write("parts", part_key(call), pickle.dumps((part.bitcode, called, part.returned, part.seconds)))


def prune() -> None:
    """Remove files that no build has read for `DAYS`."""
    oldest = time.time() - DAYS * 86400
    for kind in ("parts", "objects"):
        for path in (cache_folder() / kind).glob("*/*"):
            try:
                if path.stat().st_mtime < oldest:
                    path.unlink()
            except OSError:
                pass
