"""The compiler of kernels: what machine code does differs from plain Python in nothing but speed, but for indices."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest

from eeca_pymunk.arrays import FloatArray, IntArray
from eeca_pymunk.compiled import fetch, inlined, kernel, nonallocating
from eeca_pymunk.model.parameters import impulses

if importlib.util.find_spec("numba") is None:
    pytest.skip("numba is not installed: there is no compiler", allow_module_level=True)

from eeca_pymunk.compiled.frontend import calls, store

from .in_process import call_of, compiled, reached


@inlined
def half(x: float) -> float:
    return 0.5 * x


@nonallocating
def spread(several: bool, i: int) -> float:
    return half(i) if several else 1.0 * i


@kernel
def callers(OUT: FloatArray, n: int) -> None:
    OUT[0] = spread(False, 0) + spread(True, 1) + spread(n > 2, n)


def test_constants_in_calls_do_not_make_other_parts() -> None:
    out = np.zeros(1)
    compiled(callers, "f8[1] i8")(out, 4)
    assert out[0] == 2.5
    found = reached(call_of(callers, "f8[1] i8"))
    assert sorted(call[0].python.__name__ for call in found) == ["callers", "half", "spread"]


@kernel
def every_other(TABLE: FloatArray, OUT: FloatArray, row: int) -> None:
    for k in range(0, TABLE.shape[0], 2):
        fetch(TABLE, k + row, 1)
        OUT[0] += TABLE[k, 1]


def test_rows_are_fetched_and_nothing_else_happens() -> None:
    table = np.arange(12.0).reshape(6, 2)
    for row in (0, -3, 10**9):  # what is in no row is not there to be fetched
        out = np.zeros(1)
        compiled(every_other, "f8[2] f8[1] i8")(table, out, row)
        assert out[0] == 15.0
    (part,) = reached(call_of(every_other, "f8[2] f8[1] i8")).values()
    assert b"prefetch" in part.bitcode


@kernel
def there_and_back(OUT: FloatArray) -> None:
    OUT[1] = (OUT[0] + 1.0) - OUT[0]


def test_sums_are_not_reordered() -> None:
    """As `fastmath` would, which would find 1 here: energies close by the order of their sums."""
    out = np.array([1e16, 7.0])
    compiled(there_and_back, "f8[1]")(out)
    assert out[1] == 0.0


@kernel
def item(A: IntArray, i: int) -> int:
    return int(A[i])


@kernel
def last(A: IntArray) -> int:
    return int(A[-1])


def test_indices_count_from_the_start_but_for_constants() -> None:
    line = np.arange(6)
    assert compiled(item, "i8[1] i8")(line[2:5], 1) == 3
    assert compiled(item, "i8[1] i8")(line[2:5], -1) == 1  # what stands before the view
    assert compiled(last, "i8[1]")(line[2:5]) == 4


@kernel
def makes(n: int) -> int:
    A = np.empty(n)
    for i in range(min(n, 3)):
        A[i] = i
    return int(A[n % 3])


def test_errors_of_kernels_are_statuses() -> None:
    assert compiled(makes, "i8")(5) == 2
    with pytest.raises(MemoryError, match="makes"):
        compiled(makes, "i8")(1 << 58)
    with pytest.raises(ValueError, match="makes: arrays do not fit"):
        compiled(makes, "i8")(-1)


@kernel
def reshapes(A: FloatArray) -> int:
    return len(A.reshape(2, 3))


def test_arrays_are_reshaped_to_lines_alone() -> None:
    with pytest.raises(ValueError, match="reshapes"):
        compiled(reshapes, "f8[1]")(np.zeros(6))


@kernel
def sorts(A: IntArray) -> None:
    A.sort()


def test_what_needs_a_runtime_of_lists_is_refused() -> None:
    with pytest.raises(RuntimeError, match=r"kernels need NRT_.*: lists, strings, sorting"):
        compiled(sorts, "i8[1]")


FACTOR = 2.0


@nonallocating
def scaled(x: float) -> float:
    return FACTOR * half(x)


def test_parts_are_kept_by_all_that_they_depend_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def key() -> str:
        store.source_key.cache_clear()
        return store.source_key(scaled)

    first = key()
    assert key() == first
    monkeypatch.setitem(globals(), "FACTOR", 3.0)
    other = key()
    monkeypatch.setitem(globals(), "FACTOR", 3)  # an integer, which makes other code
    third = key()
    monkeypatch.setattr(half, "inlined", False)  # half's own key, not that of its callers
    assert key() == third
    monkeypatch.setitem(globals(), "FACTOR", [1.0])
    with pytest.raises(TypeError, match="scaled names FACTOR, a list: kernels name numbers"):
        key()
    store.source_key.cache_clear()
    assert len({first, other, third}) == 3


@nonallocating
def of_module(x: float) -> float:
    return impulses.JAMMED * x


def test_parts_depend_on_what_they_name_of_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = []
    for value in (impulses.JAMMED, 2.0):
        monkeypatch.setattr(impulses, "JAMMED", value)
        store.source_key.cache_clear()
        keys.append(store.source_key(of_module))
    store.source_key.cache_clear()
    assert keys[0] != keys[1]


def test_parts_are_kept_by_the_code_in_memory_and_not_by_the_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that is edited after it was imported is not what is compiled."""
    store.source_key.cache_clear()
    first = store.source_key(half)
    store.source_key.cache_clear()
    code = half.python.__code__
    monkeypatch.setattr(half.python, "__code__", code.replace(co_consts=(*code.co_consts[:-1], 0.25)))
    assert store.source_key(half) != first
    store.source_key.cache_clear()


def test_files_that_were_cut_short_are_compiled_again(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EECA_PYMUNK_CACHE", str(tmp_path))
    monkeypatch.setattr(store, "part_key", lambda call: "abc")
    for content in (b"", b"\x80"):
        path = tmp_path / "parts" / "ab" / "abc"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        assert store.read_part(call_of(half, "f8")) is None


def test_the_store_keeps_whole_files_and_forgets_old_ones(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EECA_PYMUNK_CACHE", str(tmp_path))
    store.write("parts", "abc", b"code")
    assert store.read("parts", "abc") == b"code"
    assert store.read("parts", "abd") is None
    store.prune()
    assert store.read("parts", "abc") == b"code"
    monkeypatch.setattr(store, "DAYS", -1)
    store.prune()
    assert store.read("parts", "abc") is None


def test_the_declared_version_of_numba_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    from eeca_pymunk.compiled.frontend import parts

    monkeypatch.setattr(parts.numba, "__version__", "0.50.1")
    with pytest.raises(ImportError, match=r"numba 0.50.1 is installed; kernels are compiled by 0.68: pip install"):
        parts.adapt.__wrapped__()


def test_calls_are_typed_by_annotations() -> None:
    assert str(calls.annotated(spread)) == "float64"
    assert calls.annotated(half) is calls.annotated(spread)
