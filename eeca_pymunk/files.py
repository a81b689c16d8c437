"""Files that are written completely or not at all; named arrays in files."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar, TypeAlias, TypeVar
from uuid import uuid4

import numpy as np
import numpy.typing as npt

_Array: TypeAlias = npt.NDArray[Any]
Own = TypeVar("Own", bound="ArrayFile")
_HASH = "sha256"
_HDF5 = (".h5", ".hdf5")
_STEM = 40  # characters of a name that its temporary name has


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """A temporary name beside `path` to write to; it is renamed to `path` if the block succeeds, else removed. Each of
    several writers of one path has its own; the file is that of the last one to succeed."""
    path = Path(path)
    partial = _beside(path)
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def _beside(path: Path) -> Path:
    """A name in the same folder and with the same suffix, which no other writer has."""
    return path.with_name(f".{path.stem[:_STEM]}.{uuid4().hex[:12]}.partial{path.suffix}")


def check_writable(path: str | Path) -> Path:
    """`path`, whose folder exists afterwards; OSError if a file cannot be written there."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        raise IsADirectoryError(f"{path} is a folder: give the name of a file")
    with suppress(FileNotFoundError):
        path.lstat()  # a name that is too long
    probe = _beside(path)
    probe.touch()
    probe.unlink()
    return path


class ArrayFile:
    """A dataclass of arrays, and of dataclasses of arrays (`_PARTS`), with `parameters`, that is saved in a file."""

    _PARTS: ClassVar[dict[str, type[Any]]]
    parameters: dict[str, Any]

    def save(self, path: str | Path) -> None:
        """Write to `path`, whole or not at all: NumPy's format for .npz; HDF5 for .h5 and .hdf5, which needs h5py.

        The file contains the arrays by the names of the attributes (`events.time`, ...), the parameters as JSON, and a
        SHA-256 hash of everything. TypeError, before anything is written, for a parameter that JSON does not have.
        """
        arrays: dict[str, _Array] = {}
        parts: list[tuple[str, Any]] = [("", self), *((f"{name}.", getattr(self, name)) for name in self._PARTS)]
        for prefix, part in parts:
            values = {f"{prefix}{f.name}": getattr(part, f.name) for f in fields(part)}
            arrays |= {name: value for name, value in values.items() if isinstance(value, np.ndarray)}
        save_arrays(path, arrays, self.parameters)

    @classmethod
    def load(cls: type[Own], path: str | Path) -> Own:
        """Read a file of `save`; ValueError if it is another file, or its content has changed."""
        try:
            found, parameters = load_arrays(path)
            parts: dict[str, dict[str, Any]] = {name: {} for name in cls._PARTS}
            for name in [name for name in found if "." in name]:
                part, field = name.split(".")
                parts[part][field] = found.pop(name)
            found |= {name: kind(**parts[name]) for name, kind in cls._PARTS.items()} | {"parameters": parameters}
            return cls(**found)
        except (FileNotFoundError, PermissionError, IsADirectoryError, ImportError):
            raise
        except Exception as error:  # whatever NumPy, zipfile, zlib and h5py raise for a damaged file
            raise ValueError(f"{path} is not a file that {cls.__name__}.save wrote ({error})") from error


def save_arrays(path: str | Path, arrays: Mapping[str, _Array], parameters: Mapping[str, Any]) -> None:
    """Write named arrays, parameters as JSON, and a SHA-256 hash of both, completely or not at all.

    The format is HDF5 for .h5 and .hdf5, which needs h5py: a dot in a name separates group and data set. For others it
    is NumPy's, compressed.
    """
    text = _as_json(parameters)
    digest = _digest(arrays, text)
    with whole_file(path) as partial:
        if Path(path).suffix in _HDF5:
            with _h5py().File(partial, "w") as file:
                for name, array in arrays.items():
                    file.create_dataset(name.replace(".", "/"), data=array, compression="gzip", shuffle=True)
                file.attrs["parameters"], file.attrs[_HASH] = text, digest
        else:
            with partial.open("wb") as stream:
                named = {"parameters": np.array(text), _HASH: np.array(digest)}
                np.savez_compressed(stream, **named, **arrays)  # type: ignore[arg-type]


def load_arrays(path: str | Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Arrays and parameters of a file of `save_arrays`; ValueError if its content has changed. Files of older versions
    have no hash."""
    path = Path(path)
    found: dict[str, Any] = {}
    if path.suffix in _HDF5:

        def collect(name: str, item: Any) -> None:
            if hasattr(item, "shape"):
                found[name.replace("/", ".")] = item[()]

        with _h5py().File(path, "r") as file:
            file.visititems(collect)
            text, digest = str(file.attrs["parameters"]), str(file.attrs.get(_HASH, ""))
    else:
        with path.open("rb") as stream, np.load(stream) as data:  # by a name, NumPy leaves damaged files open
            found = {name: data[name] for name in data.files}
        text = str(found.pop("parameters"))
        digest = str(found.pop(_HASH, ""))
    if digest and _digest(found, text) != digest:
        raise ValueError("its hash does not fit its content")
    return found, json.loads(text)


def _as_json(parameters: Mapping[str, Any]) -> str:
    """Parameters as JSON, NumPy's scalars as numbers; TypeError, which names the key, for what JSON does not have."""

    def number(value: object) -> Any:
        if isinstance(value, np.generic) and isinstance(plain := value.item(), (bool, int, float)):
            return plain
        raise TypeError(f"a {type(value).__name__} is none of these")

    for key, value in parameters.items():
        try:
            json.dumps({key: value}, default=number)
        except (TypeError, ValueError) as error:
            raise TypeError(
                f"parameters[{key!r}] is {value!r}: give numbers, text, True, False, None, or lists and dicts of these "
                f"({error})"
            ) from error
    return json.dumps(parameters, sort_keys=True, default=number)


def _digest(arrays: Mapping[str, _Array], text: str) -> str:
    """Hash of a text, and of names, dtypes, shapes and contents."""
    found = hashlib.sha256(text.encode())
    for name in sorted(arrays):
        array = arrays[name]
        found.update(f"{name} {array.dtype.str} {array.shape}".encode())
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def _h5py() -> Any:
    try:
        import h5py
    except ImportError as error:
        raise ImportError("HDF5 files need h5py: pip install h5py; or give a name that ends in .npz") from error
    return h5py
