"""Findings about a model, as exceptions and warnings."""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass
from typing import TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Related:
    """A place that a finding also concerns. Lines and columns count from 1."""

    message: str
    file: str
    line: int
    column: int
    end_line: int
    end_column: int


@dataclass(frozen=True)
class Diagnostic:
    """A finding: what is wrong or worth a remark, where, and what to type instead. Lines and columns count from 1."""

    code: str
    severity: str
    message: str
    file: str
    line: int
    column: int
    end_line: int
    end_column: int
    label: str
    help: str | None
    related: tuple[Related, ...]


class ModelError(ValueError):
    """A model from which an answer cannot be computed. Its text shows each finding at its place in the model."""

    def __init__(self, text: str, diagnostics: tuple[Diagnostic, ...] = ()) -> None:
        super().__init__(text, diagnostics)
        self.diagnostics = diagnostics

    def __str__(self) -> str:
        return str(self.args[0])


class ModelWarning(UserWarning):
    """Findings about a model that do not prevent an answer, such as a requirement that does not hold."""


def findings(lines: str) -> tuple[Diagnostic, ...]:
    """The findings of a run, one JSON object a line."""
    return tuple(_diagnostic(line) for line in lines.splitlines())


def _diagnostic(line: str) -> Diagnostic:
    fields = json.loads(line)
    related = tuple(Related(**place) for place in fields.pop("related"))
    return Diagnostic(**fields, related=related)


def settled(told: tuple[T | None, str, str], *, calls: int = 1) -> T:
    """The answer, with a warning for findings; an exception if there is none. `calls`: from the user's own line to this one."""
    answer, lines, text = told
    if answer is None:
        raise ModelError("\n" + text.rstrip(), findings(lines))
    if any(found.severity != "note" for found in findings(lines)):
        warnings.warn("\n" + text.rstrip(), ModelWarning, stacklevel=2 + calls)
    return answer
