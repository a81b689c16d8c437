"""The platforms for which libraries are built, and their linkers."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import sys
import sysconfig
from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """A platform.

    Attributes:
        triple: of LLVM.  cpu: the oldest processor that the code runs on.
        zig: the platform's name for the linker of the ziglang wheel, with the oldest version of its C library.
        ending: of the library's file name.  tag: of wheels.
    """

    triple: str
    cpu: str
    zig: str
    ending: str
    tag: str


TARGETS = {
    "linux-x86_64": Target(
        "x86_64-unknown-linux-gnu", "x86-64-v2", "x86_64-linux-gnu.2.17", ".so", "manylinux_2_17_x86_64"
    ),
    "linux-aarch64": Target(
        "aarch64-unknown-linux-gnu", "generic", "aarch64-linux-gnu.2.17", ".so", "manylinux_2_17_aarch64"
    ),
    "win32-x86_64": Target("x86_64-pc-windows-gnu", "x86-64-v2", "x86_64-windows-gnu", ".dll", "win_amd64"),
    "darwin-aarch64": Target(
        "arm64-apple-macosx11.0.0", "apple-m1", "aarch64-macos.11.0", ".dylib", "macosx_11_0_arm64"
    ),
    "darwin-x86_64": Target(
        "x86_64-apple-macosx11.0.0", "x86-64-v2", "x86_64-macos.11.0", ".dylib", "macosx_11_0_x86_64"
    ),
}


def this_platform() -> str:
    """The platform of this process, as `linux-x86_64`; it need not be one of `TARGETS`."""
    # That of the interpreter, which may differ from that of the operating system.
    name = sysconfig.get_platform().rpartition("-")[2] if sys.platform == "win32" else platform.machine()
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(name.lower(), name.lower())
    machine += "" if sys.maxsize > 1 << 32 else "-32"
    if not sys.platform.startswith("linux"):
        return f"{sys.platform}-{machine}"
    return f"{'linux' if _glibc() > (0, 0) else 'musl'}-{machine}"


def _glibc() -> tuple[int, ...]:
    """The version of GNU's C library, (0, 0) for others."""
    try:
        name, _, version = (os.confstr("CS_GNU_LIBC_VERSION") or "").partition(" ")
    except (AttributeError, OSError, ValueError):
        return 0, 0
    return tuple(int(part) for part in version.split(".")[:2]) if name == "glibc" else (0, 0)


def has_compiler() -> bool:
    """Whether there are wheels for this platform of the numba versions that compile kernels."""
    name = this_platform()
    if name.startswith("linux"):
        return name in TARGETS and _glibc() >= (2, 28)
    return name in ("win32-x86_64", "darwin-aarch64")


def processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def linker(name: str, portable: bool = False) -> list[str]:
    """The command that links a library for this platform, [] if there is none.

    Args:
        portable: for other machines too, with an old version of the C library; else a C compiler of this machine does.
    """
    if name not in TARGETS:
        return []
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", TARGETS[name].zig]
    if name == this_platform() and not portable:
        found = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
        return [found] if found else []
    return []
