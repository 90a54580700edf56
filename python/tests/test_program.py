"""Every number is the one that the command line prints, to the last bit."""

from __future__ import annotations

import csv
import itertools
import os
import subprocess
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


SWEPT = """
model swept
param k = 100 N/m spread 3 %
param m = 1 kg within 5 %
body b { mass = m, moves x }
body e { mass = 2 kg, moves x }
spring s: ground -- b { k = k }
spring r: b -- e { k = 40 N/mm }
damper d: ground -- b { c = 3 N*s/m }
force F: b along x
output x = b.x
require frequency(1) > 1 Hz
"""


@pytest.mark.parametrize(
    ("options", "asked"),
    [
        (
            ["--over", "m=1kg,2kg,0.5kg", "--over", "k=5N/m..50N/m:41", "--modes", "2", "--poles", "--measure", "gain(F -> x, 3 Hz)"],
            {"m": ["1 kg", "2kg", "0.5 kg"], "k": "5N/m..50N/m:41", "modes": 2, "poles": True, "measures": ["gain(F -> x, 3 Hz)"]},
        ),
        (["--over", "k=-1N/m,5N/m", "--modes", "1"], {"k": ["-1 N/m", "5 N/m"], "modes": 1}),
        (["--samples", "30", "--seed", "7", "--modes", "1"], {"samples": 30, "seed": 7, "modes": 1}),
        (["--samples", "32", "--sobol", "--poles"], {"samples": 32, "sobol": True, "poles": True}),
    ],
)
def test_sweeps(options: list[str], asked: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "swept.vib"
    file.write_text(SWEPT)
    program = os.environ.get("VIBC", str(Path(__file__).resolve().parents[2] / "target/debug/vibc"))
    ran = subprocess.run([program, "sweep", str(file), *options, "--format", "csv"], capture_output=True, text=True, check=True)
    heading, *rows = csv.reader(ran.stdout.splitlines())
    swept = vibc.load(file).sweep(**asked)
    assert [f"{name} [{swept.units[name]}]" if swept.units.get(name) else name for name in swept.table.dtype.names or ()] == heading
    assert len(swept.table) == len(rows)
    words = {"": np.nan, "true": 1.0, "false": 0.0}
    for place, name in enumerate(swept.table.dtype.names or ()):
        texts = [row[place] for row in rows]
        if name == "code":
            assert list(swept.table[name]) == texts
            continue
        missing = np.inf if name.endswith("_bound") else np.nan
        same(swept.table[name], [missing if text == "" else words[text] if text in words else float(text) for text in texts])


def test_arrays_of_a_sweep_are_what_numpy_loads(tmp_path: Path) -> None:
    file, archive = tmp_path / "swept.vib", tmp_path / "swept.npz"
    file.write_text(SWEPT)
    program = os.environ.get("VIBC", str(Path(__file__).resolve().parents[2] / "target/debug/vibc"))
    options = ["--over", "k=-1N/m,5N/m", "--over", "m=1kg,0kg,-1kg", "--poles", "--format", "npz", "-o", str(archive)]
    subprocess.run([program, "sweep", str(file), *options], check=True)
    arrays = np.load(archive)
    swept = vibc.load(file).sweep(k=["-1 N/m", "5 N/m"], m=["1 kg", "0 kg", "-1 kg"], poles=True).table
    *names, last = arrays["columns"].tolist()
    assert (tuple(names), last) == (swept.dtype.names[1:-1], "code")
    for place, name in enumerate(names):
        same(swept[name], arrays["table"][:, place])
    assert [arrays["codes"][int(code)] for code in arrays["table"][:, -1]] == swept["code"].tolist()


def test_a_sweep_is_a_frame_of_pandas() -> None:
    swept = vibc.parse(SWEPT).sweep(k=["-1 N/m", "5 N/m"], m=["1 kg", "0 kg", "-1 kg"], modes=1)
    frame = swept.frame()
    assert list(frame.columns) == list((swept.table.dtype.names or ())[1:])
    assert frame.index.name == "case" and frame.index.tolist() == swept.table["case"].tolist()
    assert frame.attrs["units"] == swept.units
    for name in frame.columns:
        column = swept.table[name]
        if column.dtype.kind == "f":
            same(frame[name], column)
        else:
            assert frame[name].tolist() == column.tolist()
    # What a frame is for: a row a value of one parameter, a column a value of the other.
    assert frame.pivot(index="k", columns="m", values="frequency_1").shape == (2, 3)


def test_numbers_of_a_sweep_are_in_si_units() -> None:
    model = vibc.parse(
        "param k = 10 kN/m\nparam m = 1 kg\nparam f = 3 Hz\nparam w = 60 rpm\nparam z = 2\nbody b { mass = m, moves x }\n"
        "spring s: ground -- b { k = k * z }\nforce F: b along x = harmonic(1 N * (w / (1 rad/s)), f)\noutput x = b.x\n"
    )
    asked: dict[str, Any] = {"modes": 1, "measures": ["amplitude(x)"]}
    plain = model.sweep(k=np.linspace(5000, 5e4, 4), f=[1, 2.5], w=[3.0], z=[0.5, 2], **asked)
    written = model.sweep(k=["5 kN/m", "20 kN/m", "35 kN/m", "50 kN/m"], f="1Hz,2.5Hz", w="3 rad/s", z="0.5,2", **asked)
    assert plain.units == written.units
    for name in plain.table.dtype.names or ():
        assert (plain.table[name] == written.table[name]).all(), name
    assert plain.table["k"].tolist()[-1] == 50.0  # kN/m, as the model writes it


def test_what_is_no_sweep_is_said() -> None:
    model = vibc.parse(SWEPT)
    with pytest.raises(vibc.ModelError, match="a stiffness is expected here"):
        model.sweep(k=["5", "6"])
    with pytest.raises(vibc.ModelError, match="no parameter `q`"):
        model.sweep(q="1m,2m")
    with pytest.raises(vibc.ModelError, match="a measure is expected here"):
        model.sweep(k="5N/m,6N/m", measures=["gain"])
    with pytest.raises(ValueError, match="`gain..x` is no measure"):
        model.sweep(k="5N/m,6N/m", measures=["gain((x"])
    with pytest.raises(ValueError, match="write them to a file"):
        model.sweep(k="5N/m..6N/m:100000000")
    for wrong in ({}, {"samples": 3, "k": "1N/m,2N/m"}, {"samples": 0}, {"samples": 30, "sobol": True}, {"k": ["1 N/m,2 N/m"]}, {"k": "1N/m\n"}):
        with pytest.raises(ValueError):
            model.sweep(**wrong)  # type: ignore[arg-type]
