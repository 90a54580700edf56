"""What a Python user expects of the package: exceptions, arrays, notebooks, threads."""

from __future__ import annotations

import pickle
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest

import vibc

CART = Path(__file__).resolve().parents[2] / "examples/cart.vib"
BLOCK = "body block { mass = 2 kg, moves x }\nspring s: ground -- block { k = 200 N/m }\n"


def test_a_wrong_model_is_an_exception_with_the_drawn_diagnostic() -> None:
    with pytest.raises(vibc.ModelError) as caught:
        vibc.parse("body block { mass = 2 m, moves x }", name="block.vib")
    text = str(caught.value)
    assert "a mass is expected here, this is a length" in text and "╭─[block.vib:1:21]" in text and "\x1b" not in text
    (found,) = caught.value.diagnostics
    assert (found.code, found.severity, found.file, found.line) == ("vib::unit::mismatch", "error", "block.vib", 1)
    assert found.help is not None and "mass = 1 kg" in found.help
    assert isinstance(caught.value, ValueError)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == text and again.diagnostics == caught.value.diagnostics


def test_wrong_settings_are_exceptions() -> None:
    with pytest.raises(vibc.ModelError, match="no parameter `q`"):
        vibc.load(CART, q="1 m")
    with pytest.raises(vibc.ModelError, match="a stiffness is expected here"):
        vibc.load(CART, k=12)
    with pytest.raises(ValueError, match="one line"):
        vibc.load(CART, k="12 N/m\nb=1 N*s/m")
    with pytest.raises(TypeError, match="the value of k"):
        vibc.load(CART, k=[12])  # type: ignore[arg-type]


def test_a_file_that_is_not_there_is_what_python_says_of_it() -> None:
    with pytest.raises(FileNotFoundError) as caught:
        vibc.load("nowhere.vib")
    assert "No such file or directory" in str(caught.value) and "nowhere.vib" in str(caught.value)
    with pytest.raises(IsADirectoryError):
        vibc.load(CART.parent)


def test_files_are_read_below_the_folder_of_the_model_alone(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    (tmp_path / "part.vib").write_text(BLOCK)
    model = tmp_path / "model/model.vib"
    model.write_text('use "../part.vib"\n')
    with pytest.raises(vibc.ModelError, match="outside the model's folder; `root=`"):
        vibc.load(model)


def test_a_requirement_that_fails_is_a_warning() -> None:
    model = vibc.parse(BLOCK + "require frequency(1) > 100 Hz\n")
    with pytest.warns(vibc.ModelWarning, match="frequency") as seen:
        assert model.modes().omega[0] == 10.0
    # It points to the line that asked.
    assert seen[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vibc.parse(BLOCK).modes()


def test_wrong_requests_are_exceptions() -> None:
    cart = vibc.load(CART)
    for wrong, message in (
        (lambda: cart.transfer([1.0], "G", "x"), "`G` is not an input of the model; it has `F`"),
        (lambda: cart.transfer([1.0], "F"), "name an output of the model; it has `x`, `theta`"),
        (lambda: cart.transfer([-1.0], "F", "x"), "finite and not negative"),
        (lambda: cart.transfer([np.nan], "F", "x"), "finite and not negative"),
        (lambda: cart.simulate(until=0, step=1), "until is a time greater than zero"),
        (lambda: cart.simulate(until=1, step=-1), "step is a time greater than zero"),
        (lambda: cart.simulate(until=np.inf, step=1), "not a number to compute with"),
        (lambda: cart.simulate(until=1e9, step=1e-3), "the limit is 4000000"),
        (lambda: cart.modes(0), "at least 1"),
        (lambda: cart.modes(normalise="length"), "normalise is"),  # type: ignore[arg-type]
        (lambda: cart.figure(mode=9), "no mode 9"),
        (lambda: vibc.load(CART, literals="float"), "literals is"),  # type: ignore[arg-type]
        (lambda: vibc.parse(BLOCK).simulate(until=1, step=0.1), "declares no output"),
    ):
        with pytest.raises(ValueError, match=message):
            wrong()


def test_arrays_are_moved_not_copied() -> None:
    cart = vibc.parse(CART.read_text().replace("along x\n", "along x = step(1 N, 0 s)\n"))
    t, y = cart.simulate(until=1.0, step=0.25)
    assert t.tolist() == [0, 0.25, 0.5, 0.75, 1] and y.shape == (5, 2)
    for array in (t, y, cart.M, cart.modes().shapes, cart.transfer([0.5, 1.0], "F", "x")):
        owner = array
        while isinstance(owner.base, np.ndarray):
            owner = owner.base
        # The memory is the library's own.
        assert owner.base is not None and not owner.flags.owndata
    assert cart.M is cart.M and not cart.M.flags.writeable


def test_a_part_of_a_transfer_function_has_no_bound() -> None:
    H = vibc.load(CART).transfer([0.1, 0.2], "F", "x")
    assert H.bound.shape == (2,)
    for derived in (H + 1, H[:1], abs(H), H.copy()):
        with pytest.raises(AttributeError):
            derived.bound  # type: ignore[attr-defined]


def test_a_number_is_the_decimal_that_python_prints() -> None:
    text = BLOCK + "force F: block along x = step(1 N, 0 s)\noutput x = block.x\n"
    decimal, binary = (vibc.parse(text, literals=literals) for literals in ("decimal", "binary64"))  # type: ignore[arg-type]
    # A hundred steps of a hundredth make one second; in binary64 a hundredth is a little more.
    assert len(decimal.simulate(until=1.0, step=0.01).t) == 101
    assert decimal.transfer(0.1).shape == () and binary.transfer(0.1).bound < 1e-15


def test_a_notebook_shows_the_figure_and_the_modes() -> None:
    shown = vibc.load(CART)._repr_html_()
    assert shown.startswith("<svg") and "2.158179" in shown and "Undamped modes" in shown
    assert "<script" not in shown and "href" not in shown


def test_other_threads_run_meanwhile() -> None:
    chain = "body m[1] { mass = 1 kg, moves x }\nspring k[1]: ground -- m[1] { k = 1 kN/m }\nrepeat i in 2..60 {\n"
    chain += "body m[i] { mass = 1 kg, moves x }\nspring k[i]: m[i-1] -- m[i] { k = 1 kN/m }\n}\n"
    model = vibc.parse(chain)
    done = threading.Event()
    worker = threading.Thread(target=lambda: (model.modes(), done.set()))
    ticks = 0
    worker.start()
    while not done.is_set():
        ticks += 1
    worker.join()
    # With the lock held this thread would have had no turn between the start and the end of the analysis.
    assert ticks > 100


def test_a_state_space_is_ready_for_control() -> None:
    control = pytest.importorskip("control")
    cart = vibc.load(CART)
    space = cart.state_space()
    system = control.ss(*space, **space.names)
    theirs = system(2j * np.pi * 0.4)
    assert abs(theirs[0, 0] - cart.transfer(0.4, "F", "x")) <= 1e-12 * abs(theirs[0, 0])
    assert system.input_labels == ["F"] and system.output_labels == ["x", "theta"]
