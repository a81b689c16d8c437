"""Some random compositions; `python -m tests.programs.soak --compositions` plays thousands, thin shapes included."""

from __future__ import annotations

import threading

import pytest

from .compositions import Composition, Found


@pytest.mark.parametrize("first", range(0, 200, 20))
def test_random_compositions_keep_the_laws(first: int) -> None:
    """Of thick shapes that do not fall far in a step: nobody leaves, energies are right, saved runs go on bitwise."""
    played = 0
    for seed in range(first, first + 20):
        scene = Composition(seed, thin=False)
        if not scene.gentle:
            continue
        try:
            scene.play(60)
        except AssertionError as error:
            error.add_note(f"seed {seed}")
            raise
        played += 1
    assert played >= 5


def test_hits_that_cut_solves_of_contacts_short_gain_no_energy() -> None:
    """Friction of an island that is hit has given energy up to the hit: step 98 gained 1.9e-6 of all, converged."""
    Composition(135, thin=False).play(100)


def test_compositions_in_threads_go_the_same_ways() -> None:
    """Each space has its own stepper: threads change no bit."""

    def run(seed: int, out: dict[int, list[tuple[float, ...]]]) -> None:
        scene = Composition(seed, thin=False)
        for k in range(30):
            scene.drive(k)
            scene.stepper.step(scene.dt)
        out[seed] = scene.state()

    seeds = (0, 1, 2, 3)
    together: dict[int, list[tuple[float, ...]]] = {}
    workers = [threading.Thread(target=run, args=(seed, together)) for seed in seeds]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    alone: dict[int, list[tuple[float, ...]]] = {}
    for seed in seeds:
        run(seed, alone)
    assert together == alone


def test_a_composition_that_breaks_a_law_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Energy that is not in the ledger, as of a push between steps, is none of ours; a container too small is."""
    scene = Composition(0, thin=False)
    monkeypatch.setattr(scene, "half", 0.1 * scene.half)
    with pytest.raises(AssertionError, match="outside"):
        scene.play(10)
    assert isinstance(Composition(1, thin=False).play(5), Found)
