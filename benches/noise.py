"""Root mean squares of ten outputs of a chain of 20 masses under noise, in one run: by vibc with bounds, by SciPy without.

    python3 -m venv target/venv && target/venv/bin/pip install numpy==2.4.6 scipy==1.17.1
    cargo build --release && target/venv/bin/python benches/noise.py [PROGRAM]

vibc's time is the processor time of `vibc analyze` less that of the same scene without noise, the median over pairs of runs; SciPy's
is that of one call of `solve_continuous_lyapunov`, whose import and matrices are not counted. The last column is the largest
difference of a value from vibc's, relative.
"""

import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy
from scipy.linalg import solve_continuous_lyapunov

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIBC = sys.argv[1] if len(sys.argv) > 1 else ROOT / "target" / "release" / "vibc"
COUNT = 20
PAIRS = 40
WHITE = "noise(white 0.01 m^2/s^4/Hz)"
CORNERS = "noise((20 Hz, 0.01 m^2/s^4/Hz), (80 Hz, 0.04 m^2/s^4/Hz), (350 Hz, 0.04 m^2/s^4/Hz), (2 kHz, 0.007 m^2/s^4/Hz))"

MASSES = [1 + i / 8 for i in range(COUNT)]
SPRINGS = [1e6 + 1e4 * i for i in range(COUNT)]
DAMPERS = [20.0 + 7 * (i % 3) for i in range(COUNT)]


def model(noise):
    """The chain on a base that noise accelerates."""
    rows = ["model chain", "base g { moves x }" + (f" = {noise}" if noise else "")]
    rows += [f"body b{i} {{ mass = {m} kg, moves x }}" for i, m in enumerate(MASSES)]
    for i, (k, c) in enumerate(zip(SPRINGS, DAMPERS)):
        ends = f"{'g' if i == 0 else f'b{i - 1}'} -- b{i}"
        rows += [f"spring k{i}: {ends} {{ k = {k} N/m }}", f"damper c{i}: {ends} {{ c = {c} N*s/m }}"]
    rows += [f"output y{i} = b{2 * i}.x - g.x" for i in range(COUNT // 2)]
    return "\n".join(rows) + "\n"


def run(text):
    """The answer, and the processor seconds that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([VIBC, "analyze", "-", "--format", "json"], input=text.encode(), capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return json.loads(done.stdout), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ours(noise):
    """Values, the largest bound, and seconds."""
    times = []
    for _ in range(PAIRS):
        _, without = run(model(None))
        answer, whole = run(model(noise))
        times.append(whole - without)
    rows = answer["noise"]
    return [row["rms"] for row in rows], max(row["rms_error_bound"] for row in rows), statistics.median(times)


def chain(values):
    matrix = numpy.zeros((COUNT, COUNT))
    for i, value in enumerate(values):
        matrix[i, i] += value
        if i > 0:
            matrix[i - 1, i - 1] += value
            matrix[i - 1, i] -= value
            matrix[i, i - 1] -= value
    return matrix


def scipy_white():
    """Values and seconds: relative motion under a white acceleration of the base."""
    inverse = numpy.diag(1 / numpy.array(MASSES))
    a = numpy.block([[numpy.zeros((COUNT, COUNT)), numpy.eye(COUNT)], [-inverse @ chain(SPRINGS), -inverse @ chain(DAMPERS)]])
    b = numpy.concatenate([numpy.zeros(COUNT), -numpy.ones(COUNT)])
    times = []
    for _ in range(PAIRS):
        start = time.process_time()
        p = solve_continuous_lyapunov(a, -0.005 * numpy.outer(b, b))
        times.append(time.process_time() - start)
    return [float(numpy.sqrt(p[2 * i, 2 * i])) for i in range(COUNT // 2)], statistics.median(times)


def main():
    theirs, seconds = scipy_white()
    print("| rms of ten outputs, 20 coordinates | vibc [ms] | SciPy's Lyapunov [ms] | times | largest bound | largest difference |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, noise in (("white", WHITE), ("corner points", CORNERS)):
        values, bound, own = ours(noise)
        off = f"{max(abs(x / y - 1) for x, y in zip(theirs, values)):.1e}" if noise is WHITE else ""
        print(f"| {name} | {1e3 * own:.2f} | {1e3 * seconds:.2f} | {own / seconds:.1f} | {bound:.1e} | {off} |")


main()
