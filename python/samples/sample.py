"""The tutorial's page on Python as a program: `mypy --strict` accepts it, and it runs."""

import numpy as np
from numpy.typing import NDArray

import vibc

cart = vibc.load("../../examples/cart.vib", k="12 N/m")
modes = cart.modes()
for omega, bound in zip(modes.omega, modes.bound, strict=True):
    print(f"{omega:.6f} rad/s, relative error at most {bound:.0e}")

frequencies = np.linspace(0.1, 2.0, 50)
H = cart.transfer(frequencies, "F", "x")
peak: float = frequencies[abs(H).argmax()]
print(f"largest of these at {peak:.2f} Hz, bound {H.bound.max():.0e}")

pendulum = vibc.load("../../examples/double_pendulum.vib")
t, y = pendulum.simulate(until=2.0, step=1e-3)
space = cart.state_space()
poles: NDArray[np.complex128] = cart.poles().values
print(t[-1], y.shape, poles, np.linalg.eigvals(space.A), space.states, cart.M @ cart.K)

swept = cart.sweep(k="5N/m..50N/m:200", m2=["0.1 kg", "0.5 kg"], modes=2)
stiffest = swept.table[swept.table["frequency_1"].argmax()]
print(f"{stiffest['k']} {swept.units['k']}: {stiffest['frequency_1']} Hz, within {stiffest['frequency_1_bound']:.0e} Hz")

try:
    vibc.parse("body block { mass = 2 m, moves x }")
except vibc.ModelError as error:
    first: vibc.Diagnostic = error.diagnostics[0]
    print(first.code, first.line, error)
