"""Mechanical vibrations from a drawn scene: every number comes with a bound of its error.

>>> import vibc
>>> block = vibc.parse("body block { mass = 2 kg, moves x }\\nspring s: ground -- block { k = 200 N/m }")
>>> block.modes().omega
array([10.])
"""

from .errors import Diagnostic, ModelError, ModelWarning
from .model import Model, load, parse
from .results import Energies, Modes, Motion, Poles, StateSpace, Sweep, Transfer

__all__ = [
    "Diagnostic",
    "Energies",
    "Model",
    "ModelError",
    "ModelWarning",
    "Modes",
    "Motion",
    "Poles",
    "StateSpace",
    "Sweep",
    "Transfer",
    "load",
    "parse",
]
