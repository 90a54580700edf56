"""Every number is the one that the command line prints, to the last bit."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

import vibc

from conftest import Program

# Findings about a model are printed by the program too; here its numbers count.
pytestmark = pytest.mark.filterwarnings("ignore::vibc.ModelWarning")


def same(ours: ArrayLike, printed: Any, missing: float = np.nan) -> None:
    """`null` is NaN, or for a bound infinite."""
    theirs = np.array(printed, dtype=object)
    theirs = np.where(theirs == None, missing, theirs).astype(np.float64)  # noqa: E711
    ours = np.asarray(ours, dtype=np.float64)
    assert ours.shape == theirs.shape
    assert ours.tobytes() == theirs.tobytes(), (ours, theirs)


def column(rows: list[dict[str, Any]], name: str) -> list[Any]:
    return [row[name] for row in rows]


def test_matrices_modes_and_poles(example: Path, program: Program) -> None:
    model, printed = vibc.load(example), program("analyze", example)
    assert model.coordinates == printed["coordinates"]
    for name, ours, bound in zip("mck", (model.M, model.C, model.K), model.matrix_bounds, strict=True):
        same(ours, printed["matrices"][name])
        same(bound, printed["matrices"]["error_bound"][name], np.inf)
    modes, theirs = model.modes(), printed["modes"]
    assert (modes.number, modes.kind, modes.cluster) == tuple(column(theirs, name) for name in ("mode", "kind", "cluster"))
    same(modes.omega, column(theirs, "omega"))
    same(modes.frequency, column(theirs, "frequency_hz"))
    same(modes.growth_rate, column(theirs, "growth_rate"))
    same(modes.bound, column(theirs, "omega_error_bound"), np.inf)
    same(modes.shapes.T, [list(mode["shape"].values()) for mode in theirs])
    for ours, mode in zip(modes.energies, theirs, strict=True):
        for shares, shown in ((ours.kinetic, mode["kinetic"]), (ours.strain, mode["strain"])):
            assert shares == [(share["of"], share["share"]) for share in shown]
    assert [modes.below, modes.above] == [printed["not_computed"][name] for name in ("modes_below", "modes_above")]
    poles, theirs = model.poles(), printed["poles"]
    assert (poles.kind, poles.defective) == (column(theirs, "kind"), column(theirs, "defective"))
    fields = {
        "re": poles.values.real,
        "im": poles.values.imag,
        "omega": poles.omega,
        "frequency_hz": poles.frequency,
        "damped_frequency_hz": poles.damped_frequency,
        "damping_ratio": poles.damping_ratio,
    }
    for name, ours in fields.items():
        same(ours, column(theirs, name))
    same(poles.bound, column(theirs, "error_bound"), np.inf)
    same(poles.damping_ratio_bound, column(theirs, "damping_ratio_error_bound"), np.inf)
    assert poles.left_out == printed["not_computed"]["poles"]
    assert model.stability == printed["rest"]["kind"]
    assert model.not_proved == printed["not_computed"].get("not_proved", [])


def test_transfer(example: Path, program: Program) -> None:
    model = vibc.load(example)
    if not (model.inputs and model.outputs):
        return
    highest = np.nanmax(model.modes().frequency, initial=1.0)
    frequencies = np.round(np.linspace(0, 2 * highest, 7), 3)
    options = [option for f in frequencies.tolist() for option in ("--at", f"{f!r}Hz")]
    for input, output in itertools.product(model.inputs, model.outputs):
        # A value depends in its last bits on which others are computed with it.
        (pair,) = program("transfer", example, "--from", input, "--to", output, *options)["pairs"]
        H = model.transfer(frequencies, input, output)
        same(frequencies, column(pair["values"], "frequency_hz"))
        for row, value in zip(pair["values"], H, strict=True):
            if row.get("infinite"):
                assert np.isinf(value.real) and np.isnan(value.imag)
            else:
                same([value.real, value.imag], [row["re"], row["im"]])
        same(H.bound, column(pair["values"], "error_bound"), np.inf)
        # In any order and shape.
        again = model.transfer(frequencies[::-1].reshape(1, -1), input, output)
        assert again.shape == (1, 7) and again[0, ::-1].tobytes() == H.tobytes()
        assert again.bound[0, ::-1].tobytes() == H.bound.tobytes()


def test_motion(example: Path, program: Program) -> None:
    model = vibc.load(example)
    if not model.outputs:
        return
    printed = program("simulate", example, "--until", "0.7s", "--step", "0.01s")
    motion = model.simulate(until=0.7, step=0.01)
    same(motion.t, printed["time_s"])
    assert motion.outputs == column(printed["outputs"], "name") and motion.units == column(printed["outputs"], "unit")
    for place, output in enumerate(printed["outputs"]):
        same(motion[output["name"]], output["values"])
        same(motion.bound[:, place], output["error_bounds"], np.inf)


def test_settings_are_those_of_the_command_line(program: Program) -> None:
    cart = Path(__file__).resolve().parents[2] / "examples/cart.vib"
    for options, model in (
        (["--set", "k=12 N/m"], vibc.load(cart, k="12 N/m")),
        (["--set", "k=12 N/m", "--literals", "binary64"], vibc.load(cart, settings={"k": "12 N/m"}, literals="binary64")),
    ):
        same(model.modes().omega, column(program("analyze", cart, *options)["modes"], "omega"))
        same(model.K, program("analyze", cart, *options)["matrices"]["k"])
