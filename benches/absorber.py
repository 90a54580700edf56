"""A tuned absorber, stiffness and damper, in one run: by `minimise`, which proves that no other values in the ranges are better, and by SciPy's
minimax (`differential_evolution` over the largest gain on a grid of frequencies), which proves nothing.

    python3 -m venv target/venv && target/venv/bin/pip install numpy==2.4.6 scipy==1.17.1 mpmath==1.3.0
    cargo build --release && target/venv/bin/python benches/absorber.py [PROGRAM]

Times are processor times. vibc's are those of whole processes, the least of several in turn: `analyze` of `examples/tuned_absorber.vib`, one
transfer table of the same scene without its questions, and `--version`, which is subtracted from both in the second ratio. Errors are those of
the peak, relative to the optimum of Nishihara and Asami.
"""

import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import mpmath
import numpy
from scipy.optimize import differential_evolution

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIBC = sys.argv[1] if len(sys.argv) > 1 else ROOT / "target" / "release" / "vibc"
EXAMPLE = ROOT / "examples" / "tuned_absorber.vib"
ROUNDS = 20
M, ADDED, HERTZ = 100.0, 5.0, 5.0
K = M * (2 * numpy.pi * HERTZ) ** 2


def run(*arguments):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([VIBC, *arguments], capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def gain(c, k, omega):
    s = 1j * omega
    link, own = c * s + k, ADDED * s * s
    return abs((own + link) / ((M * s * s + K) * (own + link) + own * link))


def published():
    """The least peak times K, with both parameters of the exact optimum, in 40 digits."""
    mpmath.mp.dps = 40
    mu = mpmath.mpf(1) / 20
    r = mpmath.sqrt(4 + 3 * mu)
    tuning = 2 / (1 + mu) * mpmath.sqrt(2 * (16 + 23 * mu + 9 * mu**2 + 2 * (2 + mu) * r) / (3 * (64 + 80 * mu + 27 * mu**2)))
    zeta = mpmath.sqrt((8 + 9 * mu - 4 * r) / (1 + mu)) / 4

    def square(x):
        link = mpmath.mpc(tuning**2, 2 * zeta * tuning * x)
        top = link - x * x
        return abs(top / ((1 - x * x) * top - mu * x * x * link)) ** 2

    place = mpmath.findroot(lambda x: mpmath.diff(square, x), (0.89, 0.91), solver="anderson", verify=False)
    return mpmath.sqrt(square(place))


def minimax(points, seed):
    """By SciPy: the largest gain of so many frequencies, evolved, then polished by Nelder and Mead through `polish`."""
    omega = 2 * numpy.pi * numpy.geomspace(3.0, 8.0, points)
    start = time.process_time()
    found = differential_evolution(lambda x: gain(x[0], x[1], omega).max() * K, [(20.0, 80.0), (4000.0, 5000.0)], seed=seed, tol=1e-10)
    spent = time.process_time() - start
    fine = 2 * numpy.pi * numpy.linspace(3.0, 8.0, 2_000_001)
    return spent, gain(*found.x, fine).max() * K, found.nfev


def main():
    text = EXAMPLE.read_text(encoding="utf-8")
    plain = "".join(line for line in text.splitlines(True) if not line.startswith(("minimise", "require")))
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "plain.vib"
        scene.write_text(plain, encoding="utf-8")
        times = {"minimise": [], "table": [], "nothing": []}
        for _ in range(ROUNDS):
            answer, spent = run("analyze", EXAMPLE, "--format", "json")
            times["minimise"].append(spent)
            times["table"].append(run("transfer", scene)[1])
            times["nothing"].append(run("--version")[1])
    best = {name: min(list_of) for name, list_of in times.items()}
    row = json.loads(answer)["optimised"][0]
    exact = published()
    error = abs(mpmath.mpf(row["value"]) * 100 * (2 * mpmath.pi * 5) ** 2 / exact - 1)
    print(f"vibc minimise        {1e3 * best['minimise']:8.2f} ms   error {float(error):.1e}   proved {row['proved']}")
    print(f"vibc transfer table  {1e3 * best['table']:8.2f} ms   ratio {best['minimise'] / best['table']:.1f}")
    inside = (best["minimise"] - best["nothing"]) / (best["table"] - best["nothing"])
    print(f"without start-up     {1e3 * best['nothing']:8.2f} ms   ratio {inside:.1f}")
    for points in (200, 1000, 5000):
        spent, peak, count = minimax(points, 1)
        print(f"SciPy, {points:4} points   {1e3 * spent:8.2f} ms   error {abs(peak / float(exact) - 1):.1e}   {count} evaluations")


if __name__ == "__main__":
    main()
