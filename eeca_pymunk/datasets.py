"""Rollouts as data: named arrays, in a file with their parameters and a hash of the content."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import AnyArray, FloatArray, IntArray
from .energy.ledger import Ledger
from .events import Events
from .files import whole_file

_HASH = "sha256"
_HDF5 = (".h5", ".hdf5")


@dataclass
class Rollouts:
    """The results of K rollouts of b bodies, T frames each.

    Attributes:
        states: (K, b, 6) position, angle, velocity, spin at the start.
        frames: (K, T, b, 6) the same afterwards.
        ledger: (K, T, 6) energies since the start of each, in the order of the fields of `Ledger`.
        unmet: (K,) number of steps that did not meet all budgets and tolerances.
        events: the impacts of all rollouts, one after the other, each in the order of time; numbers of bodies are those
            in `frames`.
        first: (K + 1,) the impacts of rollout k are [first[k], first[k + 1]).
        error: (K,) length, an estimate of the largest position error in any frame (`certify`); NaN before.
        parameters: arguments of `rollout`, versions, and what the user adds (seeds, units, licence).
    """

    states: FloatArray
    frames: FloatArray
    ledger: FloatArray
    unmet: IntArray
    events: Events
    first: IntArray
    error: FloatArray = field(default_factory=lambda: np.zeros(0))
    parameters: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if len(self.error) != len(self.states):
            self.error = np.full(len(self.states), np.nan)

    def __len__(self) -> int:
        return len(self.states)

    def events_of(self, k: int) -> Events:
        """The impacts of rollout k."""
        return self.events.part(int(self.first[k]), int(self.first[k + 1]))

    def ledger_of(self, k: int, t: int = -1) -> Ledger:
        """The ledger of rollout k from its start to frame t."""
        return Ledger(*self.ledger[k, t].tolist())

    def save(self, path: str | Path) -> None:
        """Write to `path`, whole or not at all: NumPy's format for .npz; HDF5 for .h5 and .hdf5, which needs h5py.

        The file contains the arrays by the names of the attributes (`events.time`, ...), the parameters as JSON, and a
        SHA-256 hash of everything.
        """
        arrays, parameters = self._arrays(), json.dumps(self.parameters, sort_keys=True)
        digest = _digest(arrays, parameters)
        with whole_file(path) as partial:
            if Path(path).suffix in _HDF5:
                with _h5py().File(partial, "w") as file:
                    for name, array in arrays.items():
                        file.create_dataset(name.replace(".", "/"), data=array, compression="gzip", shuffle=True)
                    file.attrs["parameters"], file.attrs[_HASH] = parameters, digest
            else:
                with partial.open("wb") as stream:
                    named = {"parameters": np.array(parameters), _HASH: np.array(digest)}
                    np.savez_compressed(stream, **named, **arrays)  # type: ignore[arg-type]

    @staticmethod
    def load(path: str | Path) -> Rollouts:
        """Read a file of `save`; ValueError if it is another file, or its content has changed."""
        try:
            found, parameters, digest = _read(Path(path))
            if _digest(found, parameters) != digest:
                raise ValueError("its hash does not fit its content")
            events = {name.partition(".")[2]: found.pop(name) for name in list(found) if name.startswith("events.")}
            return Rollouts(**found, events=Events(**events), parameters=json.loads(parameters))
        except (KeyError, TypeError, AttributeError, ValueError) as error:
            raise ValueError(f"{path} does not hold the rollouts that Rollouts.save wrote ({error})") from error

    def _arrays(self) -> dict[str, AnyArray]:
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("events", "parameters")}
        return own | {f"events.{f.name}": getattr(self.events, f.name) for f in fields(Events)}


def _digest(arrays: Mapping[str, AnyArray], parameters: str) -> str:
    """Hash of names, dtypes, shapes and contents."""
    found = hashlib.sha256(parameters.encode())
    for name in sorted(arrays):
        array = arrays[name]
        found.update(f"{name} {array.dtype.str} {array.shape}".encode())
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def _read(path: Path) -> tuple[dict[str, Any], str, str]:
    """Arrays, parameters and hash."""
    if path.suffix in _HDF5:
        found: dict[str, Any] = {}

        def keep(name: str, item: Any) -> None:
            if hasattr(item, "shape"):
                found[name.replace("/", ".")] = item[()]

        with _h5py().File(path, "r") as file:
            file.visititems(keep)
            return found, str(file.attrs["parameters"]), str(file.attrs[_HASH])
    with np.load(path) as data:
        found = {name: data[name] for name in data.files}
    return found, str(found.pop("parameters")), str(found.pop(_HASH))


def _h5py() -> Any:
    try:
        import h5py
    except ImportError as error:
        raise ImportError("HDF5 files need h5py: pip install h5py; or give a name that ends in .npz") from error
    return h5py
