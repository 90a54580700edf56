"""All modes of dense parts by vibc beside LAPACK's eigenvectors of the same size, in one run on one machine, one thread each.

    python3 -m venv target/venv && target/venv/bin/pip install numpy==2.4.6 scipy==1.17.1
    cargo bench --bench sizes --no-run && target/venv/bin/python benches/dense.py

LAPACK is what SciPy brings (OpenBLAS): `eigh(K, M)` of an assembled network, and `eigh(S)` of a matrix, both with vectors and
without any bound. vibc: the eigenvectors of a matrix alone, by its own kernels; then the modes from terms to shapes, each with
its certificate. Seconds of processor time, the least of three runs that take turns.
"""

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"

import pathlib
import re
import subprocess
import time

import numpy
import scipy.linalg

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZES = [100, 200, 400, 1000, 2000]
ROUNDS = 3


def network(n):
    """K and M of a network in which each mass is on springs to all others."""
    random = numpy.random.default_rng(1)
    springs = numpy.triu(random.uniform(1, 2, (n, n)), 1)
    springs += springs.T
    return numpy.diag(springs.sum(1) + random.uniform(1, 2, n)) - springs, numpy.diag(random.uniform(1, 2, n))


def seconds(call, n):
    runs = max(1, 100_000_000 // n**3)
    start = time.process_time()
    for _ in range(runs):
        call()
    return (time.process_time() - start) / runs


def lapack(n):
    k, m = network(n)
    return seconds(lambda: scipy.linalg.eigh(k, m), n), seconds(lambda: scipy.linalg.eigh(k), n)


def vibc():
    """{n: (eigenvectors, modes, bound)} of one run of the bench."""
    command = ["cargo", "bench", "-q", "--bench", "sizes", "--", "spread", "eigenvectors"]
    text = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    found = {int(n): [float(s)] for n, s in re.findall(r"eigenvectors of a matrix of (\d+): (\S+) s", text)}
    for n, modes, bound in re.findall(r"spread (\d+), all +\d+ +\S+ +(\S+) +(\S+) +dense", text):
        found[int(n)] += [float(modes), bound]
    return found


def main():
    rounds = [({n: lapack(n) for n in SIZES}, vibc()) for _ in range(ROUNDS)]
    print(f"numpy {numpy.__version__}, scipy {scipy.__version__}")
    print("| n | `eigh(K, M)` | `eigh(S)` | vibc's eigenvectors | all modes, certified | largest bound |")
    print("| --- | --- | --- | --- | --- | --- |")
    for n in SIZES:
        pencil, alone = (min(theirs[n][i] for theirs, _ in rounds) for i in range(2))
        own, modes = (min(ours[n][i] for _, ours in rounds) for i in range(2))
        bound = rounds[0][1][n][2]
        print(f"| {n} | {pencil:.4f} | {alone:.4f} | {own:.4f} ({own / alone:.2f}) | {modes:.4f} ({modes / pencil:.2f}) | {bound} |")


if __name__ == "__main__":
    main()
