"""The examples, and the program whose numbers the package has to repeat."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: The package's models have laws in time, which loss factors are not: it refuses those that have some.
EXAMPLES = sorted(path for path in (ROOT / "examples").glob("*.vib") if "loss = " not in path.read_text())

#: Runs a command of the program on a model and reads its JSON.
Program = Callable[..., dict[str, Any]]


@pytest.fixture(params=EXAMPLES, ids=lambda path: path.stem)
def example(request: pytest.FixtureRequest) -> Path:
    path: Path = request.param
    return path


@pytest.fixture(scope="session")
def program() -> Program:
    vibc = os.environ.get("VIBC", str(ROOT / "target/debug/vibc"))

    def run(command: str, model: Path, *options: str) -> dict[str, Any]:
        ran = subprocess.run([vibc, command, str(model), "--format", "json", *options], capture_output=True, text=True)
        assert ran.stdout, ran.stderr
        answer: dict[str, Any] = json.loads(ran.stdout)
        return answer

    return run
