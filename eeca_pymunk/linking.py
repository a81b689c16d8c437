"""Code of many kernels put together once.

numba finishes every function that it compiles: it links in all that the function calls, optimises the whole, and makes
machine code of it. What lies deep is so made again at every level above it. Here a kernel that only others call stays
as numba's front end leaves it, a *part*; what Python calls takes in all parts below it, and is finished once.

This reaches into how numba stores code. Where that is not as known, numba's own way is taken: the same machine code,
after a longer wait.
"""

from __future__ import annotations

import functools
from typing import Any

_NEEDS = (
    "_final_module",
    "_linking_libraries",
    "finalize",
    "_raise_if_finalized",
    "_finalize_dynamic_globals",
    "get_pointer_to_function",
    "enable_object_caching",
)


@functools.cache
def pipelines() -> tuple[dict[str, Any], dict[str, Any]]:
    """Options of numba.njit for a kernel that Python calls, and for one that is part of others; both empty where numba
    is not as known."""
    try:
        from numba.core import codegen, compiler

        library: Any = codegen.JITCodeLibrary
        base: Any = compiler.Compiler
        probe = library.__init__.__code__.co_names + library.__mro__[1].__init__.__code__.co_names
        known = all(hasattr(library, name) or name in probe for name in _NEEDS)
    except (ImportError, AttributeError):
        return {}, {}
    if not known:
        return {}, {}

    class Quiet:
        """numba's code generator, without the address of a function that has none."""

        def __init__(self, real: Any) -> None:
            self._real = real

        def __getattr__(self, name: str) -> Any:
            return getattr(self._real, name)

        def set_env(self, name: str, environment: Any) -> None:
            """A part has no environment of its own."""

    class Part(library):  # type: ignore[misc]
        _linking_libraries: list[Any]

        @property
        def codegen(self) -> Any:
            return Quiet(self._codegen)

        def finalize(self) -> None:
            self._raise_if_finalized()
            self._finalize_dynamic_globals()
            self._finalized = True

        def get_pointer_to_function(self, name: str) -> int:
            self._ensure_finalized()
            return 0

    class Whole(library):  # type: ignore[misc]
        _linking_libraries: list[Any]

        def finalize(self) -> None:
            found: dict[int, Any] = {}
            waiting: list[Any] = list(self._linking_libraries)
            while waiting:
                one = waiting.pop()
                if id(one) not in found:
                    found[id(one)] = one
                    waiting += one._linking_libraries if isinstance(one, Part) else ()
            parts = [one for one in found.values() if isinstance(one, Part)]
            home = {f.name: one for one in parts for f in one._final_module.functions if not f.is_declaration}
            # LLVM takes in what is asked for when it links, and nothing else: callers come before what they call.
            asked = True
            while asked:
                names = [f.name for f in self._final_module.functions if f.is_declaration and f.name in home]
                for one in {id(home[name]): home[name] for name in names}.values():
                    self._final_module.link_in(one._get_module_for_linking(), preserve=True)
                asked = bool(names)
            self._linking_libraries = [one for one in found.values() if not isinstance(one, Part)]
            super().finalize()

    class PartCompiler(base):  # type: ignore[misc]
        def __init__(self, typing: Any, target: Any, _: Any, *rest: Any) -> None:
            super().__init__(typing, target, Part(target.codegen(), "part"), *rest)

    class WholeCompiler(base):  # type: ignore[misc]
        def __init__(self, typing: Any, target: Any, _: Any, *rest: Any) -> None:
            whole = Whole(target.codegen(), "whole")
            whole.enable_object_caching()
            super().__init__(typing, target, whole, *rest)

    return {"pipeline_class": WholeCompiler}, {"pipeline_class": PartCompiler, "cache": False}
