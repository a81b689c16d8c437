"""Kernels as code of this process, if no library can be linked.

The builder compiles them in a process of its own to one object file for this processor, and LLVM loads that here: numba
is not imported, and nothing in this process is changed.
"""

from __future__ import annotations

import functools
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm

from ..entries import ENTRIES
from ..library import Entry, c_name
from ..sources import builder_environment

_engines: list[Any] = []  # they own the code


@functools.cache
def compiled_entries() -> Mapping[str, Entry]:
    """All entry points, compiled.

    Raises:
        ImportError: they could not be compiled.
    """
    call = [sys.executable, "-m", "eeca_pymunk.build", "--object"]
    done = subprocess.run(call, env=builder_environment(), stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise ImportError(f"{' '.join(call)} failed with exit status {done.returncode}")
    engine = loaded(Path(done.stdout.splitlines()[-1]).read_bytes())
    return {name: Entry(name, engine.get_function_address(c_name(name))) for name in ENTRIES}


def loaded(code: bytes) -> Any:
    """An engine of LLVM with the code of an object file for this processor."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(codemodel="jitdefault")
    module = llvm.parse_assembly("")
    module.triple = llvm.get_process_triple()
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    return engine
