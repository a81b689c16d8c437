"""Signorini problem: gap, weights, forces and energies against xi; body energy through the impact (Figs. 1, 4, 5)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import eeca_pymunk as ep
import scenes
import scenes.signorini
from comparisons import runs
from comparisons.output import Output
from eeca_pymunk import render
from eeca_pymunk.energy.invariants import Invariants
from scenes import Scene

RATIOS = np.arange(0.0, 161.0, 4.0)
START = 0.0005  # m above the floor for the time histories: the contact begins inside a step


def closed_form(damping_ratio: float, dt: float, stiffness: float) -> tuple[float, float, float]:
    """Delta g, psi1, psi2 of a unit mass at 1 m/s that starts the step touching the floor."""
    omega = dt * np.sqrt(stiffness)
    S = 4.0 * damping_ratio / omega
    delta = -8.0 / omega**2 / ((1.0 + S) + np.sqrt((1.0 + S) ** 2 + 16.0 / omega**2))
    return dt * delta, S - delta, delta


def run_ratio(damping_ratio: float) -> dict[str, float]:
    """One step of the scene: the quantities of Figs. 4 and 5 at one xi."""
    scene = scenes.build("signorini")
    K, dt = scene.stiffness, scene.dt
    report = ep.EECA(scene.space, ep.Dashpot(K, damping_ratio)).step(dt)
    lam, psi1, psi2 = (float(x[0]) for x in (report.impulse, report.psi1, report.psi2))
    gap, increment = float(report.contacts.gap[0]), float(report.gap_increment[0])
    f_c = -0.5 * K * (2.0 * min(gap, 0.0) + increment)
    f_extra = -0.5 * psi1 * K * increment
    p_c = 0.5 * psi2 * lam
    exact = closed_form(damping_ratio, dt, K)
    deviation = max(abs(increment - exact[0]), abs(psi1 / exact[1] - 1.0), abs(psi2 - exact[2]))
    return {
        "xi": damping_ratio,
        "gap (m)": increment,
        "psi1": psi1,
        "psi2": psi2,
        "p_c (kg m/s)": p_c,
        "f_c (N)": f_c,
        "f'_c (N)": f_extra,
        "f_c + f'_c (N)": f_c + f_extra,
        "dE p_c (J)": lam * p_c,
        "dE f'_c (J)": -f_extra * increment,
        "from closed form": deviation,
    }


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and PNG."""
    scene = scenes.build("signorini", height=START)
    output.parameters({"K": scene.stiffness, "dt": scene.dt, "mass": 1.0, "v": "(0, -1)"})
    ratios = [run_ratio(float(xi)) for xi in RATIOS]
    output.table("Figs. 4, 5: one step from touching, against xi", ratios, "xi")
    output.picture(_draw_ratios(ratios), "figs_4_5")

    makes = runs.steppers(scene.stiffness, (0.0, 200.0)) | {
        "energy-momentum": lambda space: ep.PenaltyEnergyMomentum(space, scene.stiffness)
    }
    histories: dict[str, list[tuple[float, float, float]]] = {}
    rows = []
    for name, make in makes.items():
        history: list[tuple[float, float, float]] = []

        def observe(
            k: int,
            t: float,
            s: Scene,
            report: ep.StepReport | None,
            now: Invariants,
            history: list[tuple[float, float, float]] = history,
        ) -> None:
            gap = min(s.bodies[0].position.y - scenes.signorini.RADIUS, 0.0)
            history.append((t, now.energy, 0.5 * s.stiffness * gap * gap))

        result = runs.run(scenes.build("signorini", height=START), make, observe=observe, label=name)
        histories[name] = history
        energies = [e for _, e, _ in history]
        rows.append({
            "stepper": name, "E before": energies[0], "least E during": min(energies), "E after": energies[-1],
            **result.columns(closed=False),
        })  # fmt: skip
    output.table("Fig. 1: body energy before, during and after the impact (J)", rows)
    output.picture(_draw_histories(histories), "fig_1")


def _draw_ratios(rows: list[dict[str, float]]) -> Figure:
    figure = render.figure(9.0, 6.5)
    panels = [
        ("gap (m)", "p_c (kg m/s)"),
        ("psi1", "psi2"),
        ("f_c (N)", "f'_c (N)", "f_c + f'_c (N)"),
        ("dE p_c (J)", "dE f'_c (J)"),
    ]
    xi = [row["xi"] for row in rows]
    for ax, names in zip(figure.subplots(2, 2).flat, panels, strict=True):
        twin = len(names) == 2 and names[0] != "dE p_c (J)"
        for i, name in enumerate(names):
            target = ax.twinx() if twin and i else ax
            target.plot(
                xi, [row[name] for row in rows], color=f"C{i}", linestyle="--" if twin and i else "-", label=name
            )
            target.set_ylabel(name if twin else names[0].split("(")[1].rstrip(")"), color=f"C{i}" if twin else "black")
        if not twin:
            ax.legend()
        ax.set_xlabel("damping ratio xi")
    figure.suptitle("Signorini: one step of EECA from touching (paper Figs. 4, 5)")
    return figure


def _draw_histories(histories: dict[str, list[tuple[float, float, float]]]) -> Figure:
    figure = render.figure(8.0, 4.5)
    ax = figure.add_subplot()
    for i, (name, history) in enumerate(histories.items()):
        t, energy, _ = np.array(history).T
        ax.plot(1e3 * t, energy, marker="os^vD<>P"[i % 8], markersize=4, label=name, alpha=0.8)
    ax.set(xlabel="time (ms)", ylabel="body energy (J)", title="Signorini: energy of the body (paper Fig. 1)")
    ax.legend(fontsize=8)
    return figure
