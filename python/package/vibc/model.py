"""Models: reading them, and what can be asked of them."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from os import PathLike
from typing import Literal, NamedTuple, SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _vibc
from .errors import Diagnostic, ModelError, findings, settled
from .results import Energies, Modes, Motion, Poles, Reals, StateSpace, Sweep, Transfer

#: A value as a model writes it, "12 N/m", or a number without a unit.
Value = str | SupportsFloat
#: Several values, numbers in SI units, or a range as on the command line, "5N/m..50N/m:200".
Values = str | Iterable[Value]
Literals = Literal["decimal", "binary64"]


class MatrixBounds(NamedTuple):
    """Bounds of the absolute error of each entry; infinite at a rest that is not proven."""

    M: float
    C: float
    K: float


def load(
    path: str | PathLike[str],
    /,
    *,
    settings: Mapping[str, Value] | None = None,
    root: str | PathLike[str] | None = None,
    literals: Literals = "decimal",
    **parameters: Value,
) -> Model:
    """Reads a model from a file.

    Parameters of the model get other values by their names, `load("cart.vib", k="12 N/m")`; `settings` takes names that
    are no Python names, such as `"front.k"`. The files that the model names are read below its own folder and below
    `root`.

    Raises ModelError if the model is wrong, OSError if the file cannot be read.
    """
    return _read(path, None, settings, root, literals, parameters)


def parse(
    text: str,
    /,
    *,
    name: str = "model.vib",
    settings: Mapping[str, Value] | None = None,
    root: str | PathLike[str] | None = None,
    literals: Literals = "decimal",
    **parameters: Value,
) -> Model:
    """Reads a model from its text; `name` is what findings call it. See `load`."""
    return _read(name, text, settings, root, literals, parameters)


def _read(
    path: str | PathLike[str],
    text: str | None,
    settings: Mapping[str, Value] | None,
    root: str | PathLike[str] | None,
    literals: Literals,
    parameters: Mapping[str, Value],
) -> Model:
    if literals not in ("decimal", "binary64"):
        raise ValueError('literals is "decimal" or "binary64"')
    given = [(name, _written(name, value)) for name, value in [*(settings or {}).items(), *parameters.items()]]
    answer, lines, drawn = _vibc.read(path, text, given, root, literals == "binary64")
    return Model(settled((answer, lines, drawn), calls=2), findings(lines))


def _written(name: str, value: Value) -> str:
    """A value as the language writes it: one line."""
    if isinstance(value, bool) or not isinstance(value, (str, SupportsFloat)):
        raise TypeError(f"the value of {name} is a text such as '12 N/m', or a number")
    written = value if isinstance(value, str) else repr(float(value))
    if any(end in part for part in (name, written) for end in "\r\n") or "=" in name:
        raise ValueError(f"{name!r} and its value are one line each, the name without an equals sign")
    return written


def _all_written(name: str, values: Values, unit: str) -> str:
    """Values as the command line has them: one line. Numbers are in SI units, of which the parameter has this one."""
    if isinstance(values, str):
        return _written(name, values)
    written = [
        _written(name, value) if isinstance(value, str) or not unit else f"{_written(name, value)} {unit}" for value in values
    ]
    if any("," in value or ".." in value for value in written):
        raise ValueError(f"{name}: an entry of a list is one value")
    return ",".join(written)


class Model:
    """A model. All numbers are in SI units, angles in radians, frequencies in Hz unless their name is `omega`.

    A number that goes in is read as the decimal that Python prints for it, 0.1 as a tenth, like the numbers of a model;
    with `literals="binary64"` as the binary number that it is.
    """

    #: What was found when the model was read: warnings and notes.
    diagnostics: tuple[Diagnostic, ...]

    def __init__(self, native: _vibc.Model, diagnostics: tuple[Diagnostic, ...]) -> None:
        self._native = native
        self._analyses: dict[int | None, _vibc.Analysis] = {}
        self.diagnostics = diagnostics

    @property
    def name(self) -> str:
        return self._native.name

    @cached_property
    def coordinates(self) -> list[str]:
        """The names of the coordinates, in the order of rows and columns."""
        return [name for name, _ in self._native.coordinates()]

    @cached_property
    def inputs(self) -> dict[str, str]:
        """The inputs with their units."""
        return dict(self._native.inputs())

    @cached_property
    def outputs(self) -> dict[str, str]:
        """The outputs with their units."""
        return dict(self._native.outputs())

    @cached_property
    def _matrices(self) -> tuple[Reals, Reals, Reals]:
        matrices = self._native.matrices()
        for matrix in matrices:
            # Handed out again and again.
            matrix.flags.writeable = False
        return matrices

    @property
    def M(self) -> Reals:
        """The mass matrix, read-only."""
        return self._matrices[0]

    @property
    def C(self) -> Reals:
        """The damping matrix, read-only."""
        return self._matrices[1]

    @property
    def K(self) -> Reals:
        """The stiffness matrix, read-only."""
        return self._matrices[2]

    @cached_property
    def matrix_bounds(self) -> MatrixBounds:
        return MatrixBounds(*self._native.matrix_bounds(self._analysis(None)))

    @property
    def stability(self) -> str:
        """The verdict on the rest: "stable", "neutral", "unstable" or "undetermined"."""
        return self._analysis(None).verdict()[0]

    @property
    def not_proved(self) -> list[str]:
        """What the answers say that is not proved; empty if everything is."""
        return self._analysis(None).verdict()[1]

    def _analysis(self, count: int | None) -> _vibc.Analysis:
        known = self._analyses.get(count)
        if known is None:
            known = self._analyses[count] = settled(self._native.analyze(count), calls=2)
        return known

    def modes(
        self,
        count: int | None = None,
        *,
        normalise: Literal["translation", "max", "first", "mass"] = "translation",
    ) -> Modes:
        """The lowest `count` undamped modes; without it, the usual number for the size of the model."""
        if count is not None and count < 1:
            raise ValueError("count is at least 1")
        found = self._analysis(count).modes(normalise)
        energies = [Energies(kinetic, strain) for kinetic, strain in found["energies"]]
        return Modes(**{**found, "shapes": found["shapes"].T, "energies": energies})  # type: ignore[arg-type]

    def poles(self) -> Poles:
        """The poles of the damped motion."""
        return Poles(**self._analysis(None).poles())

    def transfer(self, frequencies: ArrayLike, input: str | None = None, output: str | None = None) -> Transfer:
        """H from an input to an output at frequencies in Hz, of any shape; names may be left out where there is one."""
        hertz: NDArray[np.float64] = np.asarray(frequencies, dtype=np.float64)
        if not (np.isfinite(hertz) & (hertz >= 0)).all():
            raise ValueError("a frequency is finite and not negative")
        pair = _place("input", input, self.inputs), _place("output", output, self.outputs)
        flat = hertz.ravel()
        ascending = bool((flat[1:] > flat[:-1]).all())
        at, back = (flat, None) if ascending else np.unique(flat, return_inverse=True)
        values, bound = settled(self._native.transfer(at, *pair))
        if back is not None:
            values, bound = values[back], bound[back]
        return Transfer(values.reshape(hertz.shape), bound.reshape(hertz.shape))

    def simulate(self, *, until: float, step: float) -> Motion:
        """The outputs from rest or the initial state, under the signals of the model, at 0, step, 2 step, ... s."""
        if not self.outputs:
            raise ValueError("the model declares no output")
        t, y, bound = settled(self._native.simulate(until, step))
        return Motion(t, y, bound, list(self.outputs), list(self.outputs.values()))

    def sweep(
        self,
        *,
        over: Mapping[str, Values] | None = None,
        samples: int | None = None,
        seed: int = 0,
        sobol: bool = False,
        modes: int | None = None,
        poles: bool = False,
        measures: Sequence[str] = (),
        hold_solved: bool = False,
        tolerance: float | None = None,
        **parameters: Values,
    ) -> Sweep:
        """The model at many values of its parameters: what `vibc sweep` computes, to the last bit, on all cores.

        `sweep(k="5N/m..50N/m:200", m1=["1 kg", "2 kg"])` computes every combination, the last one changing fastest; `over`
        takes names that are no Python names. Numbers are in SI units, `sweep(k=np.linspace(5, 50, 200))`. `samples` draws the parameters that have a tolerance or a spread instead, with
        `sobol` so that they fill their ranges evenly.
        Without `modes`, `poles`, `measures` and requirements of the model, six frequencies.
        """
        if isinstance(measures, str):
            raise TypeError("measures is a list of texts")
        if samples is not None and (samples < 1 or seed < 0):
            raise ValueError("samples is at least 1, and the seed is not negative")
        if sobol and (samples is None or samples % 16 != 0):
            raise ValueError("sobol draws from 16 sequences in turn: samples is a multiple of 16, best a power of two")
        varied = [*(over or {}).items(), *parameters.items()]
        if bool(varied) == (samples is not None):
            raise ValueError("give values of parameters, or a number of samples")
        if tolerance is not None and not 0 < tolerance < 1:
            raise ValueError("tolerance is a relative error bound such as 1e-14")
        if modes is not None and modes < 1:
            raise ValueError("modes is at least 1")
        if any("\n" in measure or "\r" in measure for measure in measures):
            raise ValueError("a measure is one line")
        drawn = None if samples is None else (samples, seed)
        units = dict(self._native.units())
        lines = [f"{name}={_all_written(name, values, units.get(name, ''))}" for name, values in varied]
        told = self._native.sweep(lines, drawn, sobol, list(measures), modes, poles, hold_solved, tolerance)
        columns, values, bounds, codes = settled(told)
        fields: list[tuple[str, str]] = [("case", "i8")]
        for name, _, has_bound in columns:
            fields += [(name, "f8"), (f"{name}_bound", "f8")] if has_bound else [(name, "f8")]
        table = np.zeros(len(codes), dtype=[*fields, ("code", f"U{max(map(len, codes), default=1) or 1}")])
        table["case"], table["code"] = np.arange(len(codes)), codes
        for place, (name, _, has_bound) in enumerate(columns):
            table[name] = values[:, place]
            if has_bound:
                table[f"{name}_bound"] = bounds[:, place]
        return Sweep(table, {name: unit for name, unit, _ in columns})

    def state_space(self) -> StateSpace:
        """The model in first order. Raises ValueError where there is none."""
        n = len(self.coordinates)
        inverse = _inverse_of_mass(self.M)
        (b0, b1, b2), (p0, p1, p2), (d0, d1, d2) = self._native.ports()
        # q = z + g u and z' = v + h u leave no derivative of u in the equations of z and v.
        g = inverse @ b2.T
        h = inverse @ (b1.T - self.C @ g)
        drive = inverse @ (b0.T - self.K @ g - self.C @ h)
        left = [
            (p1 @ g + p2 @ h + d1, abs(p1) @ abs(g) + abs(p2) @ abs(h) + abs(d1)),
            (p2 @ g + d2, abs(p2) @ abs(g) + abs(d2)),
        ]
        for kept, size in left:
            follows = np.argwhere(abs(kept) > 1e-9 * size)
            if len(follows):
                output, input = list(self.outputs)[follows[0][0]], list(self.inputs)[follows[0][1]]
                raise ValueError(f"`{output}` follows a derivative of `{input}`, which a state space cannot express")
        stiffness, damping = inverse @ self.K, inverse @ self.C
        return StateSpace(
            A=np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]),
            B=np.vstack([h, drive]),
            C=np.hstack([p0 - p2 @ stiffness, p1 - p2 @ damping]),
            D=d0 + p0 @ g + p1 @ h + p2 @ drive,
            states=self.coordinates + [f"{name}'" for name in self.coordinates],
            inputs=list(self.inputs),
            outputs=list(self.outputs),
        )

    def figure(self, mode: int | None = None, *, values: bool = False) -> str:
        """The scene as SVG: as drawn, or with a mode, counted from 1, over the rest."""
        figure, reason = settled(self._native.figure(mode, values))
        if figure is None:
            raise ValueError(reason)
        return figure

    def __repr__(self) -> str:
        n = len(self.coordinates)
        return f"<vibc.Model {self.name}: {n} degree{'' if n == 1 else 's'} of freedom>"

    def _repr_html_(self) -> str:
        figure, _ = settled(self._native.figure(None, False))
        try:
            table = self._analysis(None).table()
        except ModelError as error:
            table = f"<pre>{html.escape(str(error))}</pre>"
        return f"{figure or ''}\n{table}"


def _place(what: str, name: str | None, known: Mapping[str, str]) -> int:
    """The number of an input or output."""
    names = list(known)
    if name is None and len(names) == 1:
        return 0
    if name in names:
        return names.index(name)
    has = ", ".join(f"`{name}`" for name in names) or "none"
    if name is None:
        raise ValueError(f"name an {what} of the model; it has {has}")
    raise ValueError(f"`{name}` is not an {what} of the model; it has {has}")


def _inverse_of_mass(mass: Reals) -> Reals:
    """By the matrix with a diagonal of ones, so that units do not matter."""
    size = np.sqrt(np.diag(mass))
    if not (size > 0).all():
        raise ValueError("a coordinate has no mass, so there is no state with its velocity")
    scaled = mass / np.outer(size, size)
    least = np.linalg.eigvalsh(scaled)[0] if len(mass) else 1.0
    if least <= len(mass) * 1e-14:
        raise ValueError("a motion has no mass, so there is no state with its velocity")
    inverse: Reals = np.linalg.inv(scaled) / np.outer(size, size)
    return inverse
