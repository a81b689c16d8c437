"""Ten thousand random programs of API calls: `python -m tests.programs.soak [COUNT]`."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .fuzz import Program


def soak(count: int) -> None:
    """Play so many; AssertionError, with the shortest program that fails, if a rule is broken."""

    @settings(max_examples=count, deadline=None, suppress_health_check=list(HealthCheck))
    @given(st.data())
    def programs(data: st.DataObject) -> None:
        draw: Callable[..., object] = data.draw
        Program(draw).play(40)

    start = time.perf_counter()
    programs()
    print(f"{count} programs in {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    soak(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
