"""What is computed from a model: arrays with their bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]


class Energies(NamedTuple):
    """Shares of a mode's energy by what has it, largest first. Like shapes they have no bound."""

    kinetic: list[tuple[str, float]]
    strain: list[tuple[str, float]]


@dataclass(frozen=True)
class Modes:
    """The undamped modes, ascending. One entry a mode; NaN where a mode has no such number."""

    #: Counted from 1 for the lowest of all.
    number: list[int]
    #: "oscillation", "rigid", "divergence" or "undetermined".
    kind: list[str]
    #: rad/s
    omega: Reals
    #: Hz
    frequency: Reals
    #: 1/s, of a divergence.
    growth_rate: Reals
    #: Bounds of the relative errors of omega, frequency and growth rate.
    bound: Reals
    #: Coordinates by modes. Displacements in a shape have no bound.
    shapes: Reals
    energies: list[Energies]
    #: Modes that are certified only together share a number.
    cluster: list[int | None]
    #: Numbers of modes that were not asked for, and of motions without inertia.
    below: int
    above: int
    infinite: int

    def __len__(self) -> int:
        return len(self.omega)


@dataclass(frozen=True)
class Poles:
    """The poles of M s^2 + C s + K, ascending in |s|; both of a complex pair. NaN where a pole has no such number."""

    #: Real part in 1/s, imaginary part in rad/s.
    values: Complexes
    #: Bounds of |error| / |pole|.
    bound: Reals
    #: |s| in rad/s, and in Hz.
    omega: Reals
    frequency: Reals
    #: |im s| in Hz
    damped_frequency: Reals
    damping_ratio: Reals
    damping_ratio_bound: Reals
    #: "oscillation", "overdamped", "rigid", "divergence", "flutter" or "undetermined".
    kind: list[str]
    #: Poles that are certified only together share a number.
    cluster: list[int | None]
    defective: list[bool]
    #: Number of poles that were not asked for.
    left_out: int
    #: Whether it is proved that all poles are there.
    complete: bool

    def __len__(self) -> int:
        return len(self.values)


class Transfer(np.ndarray[Any, np.dtype[np.complex128]]):
    """Values of a transfer function: an array like any other, with bounds of |error| / |H|.

    Where H is infinite, so is its real part; where nothing is known it is NaN. The bound is infinite in both cases.
    """

    _bound: Reals | None

    def __new__(cls, values: Complexes, bound: Reals) -> Transfer:
        made = values.view(cls)
        made._bound = bound
        return made

    def __array_finalize__(self, made_from: object) -> None:
        self._bound = None

    @property
    def bound(self) -> Reals:
        """One for each value. A slice or a sum has none: nothing is known of what the values went through."""
        if self._bound is None:
            raise AttributeError("an array that was made from a transfer function has no bound")
        return self._bound


@dataclass(frozen=True)
class Motion:
    """A motion in time; `t, y = motion` takes it apart. NaN with an infinite bound where nothing is known."""

    #: s
    t: Reals
    #: Samples by outputs, in the units of the outputs.
    y: Reals
    #: Bounds of the absolute error of each sample.
    bound: Reals
    outputs: list[str]
    units: list[str]

    def __iter__(self) -> Iterator[Reals]:
        return iter((self.t, self.y))

    def __getitem__(self, output: str) -> Reals:
        if output not in self.outputs:
            raise KeyError(output)
        column: Reals = self.y[:, self.outputs.index(output)]
        return column


@dataclass(frozen=True)
class StateSpace:
    """x' = A x + B u, y = C x + D u; `scipy.signal.StateSpace(*space)`, `control.ss(*space, **space.names)`.

    Computed from the matrices in binary64: these numbers have no bound.
    """

    A: Reals
    B: Reals
    C: Reals
    D: Reals
    #: Displacements of the coordinates, then their velocities. A motion of a base is subtracted from both as far as it acts by
    #: its derivatives.
    states: list[str]
    inputs: list[str]
    outputs: list[str]

    def __iter__(self) -> Iterator[Reals]:
        return iter((self.A, self.B, self.C, self.D))

    @property
    def names(self) -> dict[str, list[str]]:
        """The names as python-control takes them: dots mean something else there."""
        plain = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        return {kind: [name.replace(".", "_") for name in names] for kind, names in plain.items()}


class Sweep(NamedTuple):
    """A model at many values of its parameters."""

    #: A structured array, a row a case: `table["k"]`, `table["frequency_1"]`, `table["frequency_1_bound"]`, and `table["code"]`,
    #: the code of the finding for which a case has no answers, or of a warning about them. Bounds are absolute, infinite where
    #: nothing is known. NaN stands where there is no number; a verdict on a requirement is 1, 0, or NaN where it is not decided.
    table: NDArray[Any]
    #: The unit of each column, as the model writes it: not SI.
    units: dict[str, str]

    def frame(self) -> Any:
        """The table as a `pandas.DataFrame`: the number of the case is its index, and `frame.attrs["units"]` has the units. Needs pandas."""
        of_columns = {name: self.table[name] for name in self.table.dtype.names or ()}
        frame = import_module("pandas").DataFrame(of_columns).set_index("case")
        frame.attrs["units"] = dict(self.units)
        return frame
