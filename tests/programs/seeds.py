"""Play the scenes of many seeds; what breaks a law names its seed."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from .compositions import Composition


def play(make: Callable[[int], Composition], seeds: Iterable[int], steps: int = 60) -> int:
    """Play the gentle scenes of these seeds, which raise where a law breaks; how many they are."""
    played = 0
    for seed in seeds:
        scene = make(seed)
        if scene.gentle:
            try:
                scene.play(steps)
            except AssertionError as error:
                error.add_note(f"seed {seed}, {sorted(getattr(scene, 'has', ()))}")
                raise
            played += 1
    return played
