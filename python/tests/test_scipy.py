"""Answers beside SciPy's, on every example: what binary64 computes from the matrices."""

from __future__ import annotations

import decimal
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
import scipy.signal

import vibc

#: A motion without mass has no state with its velocity.
MASSLESS = {"test_hall"}
#: An output that follows a derivative of an input: the force of a base through a damper or an inerter, an unbalance, an
#: acceleration where damping by modes acts relative to the base.
IMPROPER = {"frame", "inerter_table", "rotor"}

pytestmark = pytest.mark.filterwarnings("ignore::vibc.ModelWarning")


def test_frequencies(example: Path) -> None:
    model = vibc.load(example)
    if example.stem in MASSLESS:
        with pytest.raises(ValueError, match="no mass"):
            model.state_space()
        return
    modes = model.modes()
    squares = scipy.linalg.eigh(model.K, model.M, eigvals_only=True)
    grows = np.array([kind == "divergence" for kind in modes.kind])
    ours = np.where(grows, -(modes.growth_rate**2), modes.omega**2)
    assert np.abs(ours - squares).max() <= 1e-12 * np.abs(squares).max()
    # Each shape solves its equation.
    residual = model.K @ modes.shapes - model.M @ modes.shapes * ours
    scale = np.abs(model.K) @ np.abs(modes.shapes) + np.abs(model.M) @ np.abs(modes.shapes) * np.abs(ours)
    assert (np.abs(residual) <= 1e-11 * scale.max(axis=0)).all()


def test_poles(example: Path) -> None:
    model = vibc.load(example)
    ours, n = model.poles().values, len(model.coordinates)
    zero, one = np.zeros((n, n)), np.eye(n)
    pencil = np.block([[zero, one], [-model.K, -model.C]]), np.block([[one, zero], [zero, model.M]])
    upper, lower = scipy.linalg.eigvals(*pencil, homogeneous_eigvals=True)
    # A motion without mass has poles at infinity.
    finite = np.abs(lower) > 1e-13 * np.abs(upper)
    theirs = upper[finite] / lower[finite]
    assert len(theirs) == len(ours)
    distance = np.abs(ours[:, None] - theirs[None, :])
    rows, columns = scipy.optimize.linear_sum_assignment(distance)
    # A double pole moves by the square root of a rounding.
    assert distance[rows, columns].max() <= 1e-6 * np.abs(ours).max()


def test_frequency_response(example: Path) -> None:
    if example.stem in MASSLESS:
        return
    model = vibc.load(example)
    if not (model.inputs and model.outputs):
        return
    try:
        space = model.state_space()
    except ValueError as improper:
        assert "follows a derivative" in str(improper) and example.stem in IMPROPER
        return
    frequencies = np.linspace(0.13, 1.9, 9) * np.nanmax(model.modes().frequency, initial=1.0)
    # `scipy.signal.freqresp` goes by way of polynomials, which lose digits.
    unit = np.eye(len(space.A))
    at = [space.C @ scipy.linalg.solve(2j * np.pi * f * unit - space.A, space.B) + space.D for f in frequencies]
    for i, input in enumerate(space.inputs):
        for o, output in enumerate(space.outputs):
            theirs = np.array([value[o, i] for value in at])
            ours = model.transfer(frequencies, input, output)
            assert np.abs(ours - theirs).max() <= 1e-9 * np.abs(theirs).max(), (input, output)


def test_motion(example: Path) -> None:
    """By how much a probe, a pulse of force on a coordinate, changes the motion: whatever else drives the model."""
    if example.stem in MASSLESS:
        return
    model = vibc.load(example)
    if not model.outputs:
        return
    step = decimal.Decimal(f"{0.2 / max(np.nanmax(model.modes().frequency), 1e-3):.2g}")
    pushed = vibc.parse(_probed(example, model, duration=30 * step), name=str(example))
    t, y = pushed.simulate(until=float(60 * step), step=float(step))
    _, without = model.simulate(until=float(60 * step), step=float(step))
    try:
        space = pushed.state_space()
    except ValueError as improper:
        assert "follows a derivative" in str(improper) and example.stem in IMPROPER
        return
    drive = space.inputs.index("probe")
    system = (space.A, space.B[:, [drive]], space.C, space.D[:, [drive]])
    # A sample shows what comes after the jump.
    pulse = np.where(np.arange(len(t)) < 30, 1.0, 0.0)
    _, theirs, _ = scipy.signal.lsim(system, pulse, t, interp=False)
    theirs = theirs.reshape(y.shape)
    scale = np.abs(theirs).max(axis=0) + np.abs(y).max(axis=0)
    assert np.abs(theirs).max() > 0
    assert (np.abs(y - without - theirs) <= 1e-9 * scale).all()


def _probed(example: Path, model: vibc.Model, duration: decimal.Decimal) -> str:
    """The text of the example with a probe on the first coordinate that takes one."""
    text = example.read_text()
    for name in model.coordinates:
        body, motion = name.rsplit(".", 1)
        if motion == "angle":
            probe = f"torque probe: {body} = pulse(1 N*m, 0 s, {duration:f} s)"
        elif motion in ("x", "y"):
            probe = f"force probe: {body} along {motion} = pulse(1 N, 0 s, {duration:f} s)"
        else:
            continue
        return f"{text}\n{probe}\n"
    raise AssertionError(f"{example}: no coordinate takes a force: {model.coordinates}")
