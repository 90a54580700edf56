"""The classes of numbers, each with its scenes, its check, and how many scenes make a big and a quick run."""

from dataclasses import dataclass
from typing import Callable

from . import coupled, damped_shapes, drift, effective, emitted, equations, equations_examples, extrema, extrema_large, extremes, large, loaded, loss, loss_poles, measures, modal, modes, motions, noise, noise_loss, noise_maxima, noise_peaks, optima, periodic, planar, poles, rates, rayleigh, reactions, samples, sensitivities, settle, shock, singular, solving, spectrum, sweeps, tolerated, transfer


@dataclass(frozen=True)
class Class:
    """How a class makes a scene from a random generator, and how it compares what is told about it."""

    scene: Callable
    check: Callable
    scenes: int
    quick: int


ALL = {
    "modes": Class(modes.scene, modes.check, 30000, 150),
    "digits": Class(modes.scene, modes.check_digits, 30000, 100),
    "poles": Class(poles.scene, poles.check, 20000, 300),
    "large": Class(large.scene, large.check, 2000, 6),
    "extremes": Class(extremes.scene, extremes.check, 5000, 50),
    "extrema": Class(extrema.scene, extrema.check, 10000, 100),
    "extrema_large": Class(extrema_large.scene, extrema.check, 300, 2),
    "motions": Class(motions.scene, motions.check, 10000, 100),
    "periodic": Class(periodic.scene, periodic.check, 5000, 40),
    "transfer": Class(transfer.scene, transfer.check, 10000, 150),
    "singular": Class(singular.scene, singular.check, 10000, 100),
    "loss": Class(loss.scene, loss.check, 10000, 60),
    "loss_poles": Class(loss_poles.scene, loss_poles.check, 10000, 60),
    "rates": Class(rates.scene, rates.check, 10000, 60),
    "rayleigh": Class(rayleigh.scene, rayleigh.check, 10000, 60),
    "modal": Class(modal.scene, modal.check, 10000, 100),
    "measures": Class(measures.scene, measures.check, 10000, 100),
    "settling": Class(settle.scene, settle.check, 5000, 40),
    "solve": Class(solving.scene, solving.check, 5000, 60),
    "sensitivities": Class(sensitivities.scene, sensitivities.check, 10000, 100),
    "coupled": Class(coupled.scene, coupled.check, 5000, 60),
    "damped_shapes": Class(damped_shapes.scene, damped_shapes.check, 5000, 40),
    "emitted": Class(emitted.scene, emitted.check, 2000, 15),
    "equations": Class(equations.scene, equations.check, 2000, 12),
    "examples": Class(equations_examples.scene, equations_examples.check, len(equations_examples.ALL), len(equations_examples.ALL)),
    "planar": Class(planar.scene, planar.check, 10000, 100),
    "reactions": Class(reactions.scene, reactions.check, 5000, 60),
    "noise_white": Class(noise.of_form("white"), noise.check, 2000, 20),
    "noise_band": Class(noise.of_form("flat"), noise.check, 1000, 12),
    "noise_powers": Class(noise.of_form("points", "points", "road"), noise.check, 1000, 12),
    "noise_several": Class(noise.of_form("white", "flat", "points", "road", form="two"), noise.check, 1000, 8),
    "noise_delayed": Class(noise.of_form("white", "white", "flat", "points", "road", form="delayed"), noise.check, 1000, 12),
    "noise_peaks": Class(noise_peaks.scene, noise_peaks.check, 2000, 15),
    "noise_maxima": Class(noise_maxima.scene, noise_maxima.check, 1000, 6),
    "noise_tables": Class(noise_maxima.tabulated, noise_maxima.check_all, 1000, 8),
    "noise_loss": Class(noise_loss.scene, noise_loss.check, 1000, 4),
    "noise_drift": Class(drift.scene, noise.check, 2000, 25),
    "effective": Class(effective.scene, effective.check, 10000, 30),
    "laws": Class(loaded.law_scene, loaded.law_check, 10000, 30),
    "belts": Class(loaded.belt_scene, loaded.belt_check, 10000, 30),
    "unbalance": Class(loaded.unbalance_scene, loaded.unbalance_check, 5000, 20),
    "tolerances": Class(tolerated.scene, tolerated.check, 3000, 40),
    "tolerances_damped": Class(tolerated.damped_scene, tolerated.damped_check, 1000, 6),
    "sweeps": Class(sweeps.scene, sweeps.check, 5000, 25),
    "sweeps_rest": Class(sweeps.scene_at_rest, sweeps.check, 5000, 25),
    "samples": Class(samples.scene, samples.check, 5000, 25),
    "optima": Class(optima.scene, optima.check, 1000, 5),
    "shock": Class(shock.scene, shock.check, 5000, 60),
    "spectrum": Class(spectrum.scene, spectrum.check, 5000, 60),
}
