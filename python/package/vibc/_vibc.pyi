from os import PathLike
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

_Reals = NDArray[np.float64]
_Complexes = NDArray[np.complex128]
_Shares = list[tuple[str, float]]

class _Modes(TypedDict):
    number: list[int]
    kind: list[str]
    omega: _Reals
    frequency: _Reals
    growth_rate: _Reals
    bound: _Reals
    shapes: _Reals
    energies: list[tuple[_Shares, _Shares]]
    cluster: list[int | None]
    below: int
    above: int
    infinite: int

class _Poles(TypedDict):
    values: _Complexes
    bound: _Reals
    omega: _Reals
    frequency: _Reals
    damped_frequency: _Reals
    damping_ratio: _Reals
    damping_ratio_bound: _Reals
    kind: list[str]
    cluster: list[int | None]
    defective: list[bool]
    left_out: int
    complete: bool

class Analysis:
    def modes(self, normalise: str) -> _Modes: ...
    def poles(self) -> _Poles: ...
    def verdict(self) -> tuple[str, list[str]]: ...
    def table(self) -> str: ...

class Model:
    @property
    def name(self) -> str: ...
    def coordinates(self) -> list[tuple[str, str]]: ...
    def units(self) -> list[tuple[str, str]]: ...
    def inputs(self) -> list[tuple[str, str]]: ...
    def outputs(self) -> list[tuple[str, str]]: ...
    def matrices(self) -> tuple[_Reals, _Reals, _Reals]: ...
    def matrix_bounds(self, analysis: Analysis) -> tuple[float, float, float]: ...
    def ports(
        self,
    ) -> tuple[tuple[_Reals, _Reals, _Reals], tuple[_Reals, _Reals, _Reals], tuple[_Reals, _Reals, _Reals]]: ...
    def analyze(self, count: int | None) -> tuple[Analysis | None, str, str]: ...
    def transfer(
        self, frequencies: _Reals, input: int, output: int
    ) -> tuple[tuple[_Complexes, _Reals] | None, str, str]: ...
    def simulate(self, until: float, step: float) -> tuple[tuple[_Reals, _Reals, _Reals] | None, str, str]: ...
    def sweep(
        self,
        over: list[str],
        samples: tuple[int, int] | None,
        sobol: bool,
        measures: list[str],
        modes: int | None,
        poles: bool,
        hold_solved: bool,
        tolerance: float | None,
    ) -> tuple[tuple[list[tuple[str, str, bool]], _Reals, _Reals, list[str]] | None, str, str]: ...
    def figure(self, mode: int | None, values: bool) -> tuple[tuple[str | None, str] | None, str, str]: ...

def read(
    path: str | PathLike[str],
    text: str | None,
    settings: list[tuple[str, str]],
    root: str | PathLike[str] | None,
    binary64: bool,
) -> tuple[Model | None, str, str]: ...
