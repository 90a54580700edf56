"""A shock response spectrum of 200 frequencies over 10,000 points, in one run: by vibc, which proves the maxima between the samples, and by
SciPy's `lfilter` with the ramp-invariant filter of ISO 18431-4 (Smallwood 1981), which looks at samples only.

    python3 -m venv target/venv && target/venv/bin/pip install numpy==2.4.6 scipy==1.17.1 mpmath==1.3.0
    cargo build --release && target/venv/bin/python benches/shock.py [PROGRAM]

vibc's time is the processor time of `vibc shock` less that of `vibc check` on the same scene, the median over pairs of runs: reading the table
is in both. SciPy's is that of 200 calls of `lfilter` with their maxima; its coefficients are not counted. Errors are relative to the largest
value that mpmath finds at six of the frequencies between the samples, in 40 digits.
"""

import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import mpmath
import numpy
from scipy.signal import lfilter

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIBC = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT / "target" / "release" / "vibc"
POINTS, STEP, ZETA = 10_000, 0.01, 0.05
PAIRS = 40
CHECKED = (0, 40, 90, 130, 165, 199)


def record():
    """A modulated noise like that of an earthquake, in g, with six digits."""
    t = numpy.arange(POINTS) * STEP
    rng = numpy.random.default_rng(5)
    raw = rng.standard_normal(POINTS)
    smooth = lfilter([1.0], [1.0, -1.4, 0.6], raw)
    shape = (t / 8.0) ** 2 * numpy.exp(2 - t / 4.0)
    values = numpy.round(0.1 * smooth * shape, 6)
    values[0] = 0.0
    return t, values


def run(folder, arguments):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([VIBC, *arguments], cwd=folder, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ours(folder):
    asked = ["shock", "quake.vib", "--damping", "5%", "--range", "0.1Hz..50Hz", "--points", "200", "--format", "json"]
    times = []
    for _ in range(PAIRS):
        _, without = run(folder, ["check", "quake.vib"])
        answer, whole = run(folder, asked)
        times.append(whole - without)
    return json.loads(answer)["spectra"][0], statistics.median(times)


def filters(frequencies):
    """Ramp-invariant filters of the relative displacement times omega^2 (ISO 18431-4)."""
    w = 2 * numpy.pi * frequencies
    a, b = ZETA * w * STEP, numpy.sqrt(1 - ZETA**2) * w * STEP
    e, q = numpy.exp(-a), (2 * ZETA**2 - 1) / numpy.sqrt(1 - ZETA**2)
    s, c, n = numpy.sin(b), numpy.cos(b), w * STEP
    b0 = (2 * ZETA * (e * c - 1) + q * e * s + n) / n
    b1 = (-2 * n * e * c + 2 * ZETA * (1 - e**2) - 2 * q * e * s) / n
    b2 = (e**2 * (n + 2 * ZETA) - 2 * ZETA * e * c + q * e * s) / n
    return [([x, y, z], [1.0, -2 * g * h, g * g]) for x, y, z, g, h in zip(b0, b1, b2, e, c)]


def theirs(values, frequencies):
    made = filters(frequencies)
    times = []
    for _ in range(PAIRS):
        start = time.process_time()
        found = [numpy.abs(lfilter(b, a, values)).max() for b, a in made]
        times.append(time.process_time() - start)
    return numpy.array(found), statistics.median(times)


def truth(values, hertz):
    """The largest |omega^2 y| during the record: exact states at the samples, then extrema within the steps near the largest ones."""
    mpmath.mp.dps = 40
    w, z, h = 2 * mpmath.pi * mpmath.mpf(hertz), mpmath.mpf(ZETA * 100) / 100, mpmath.mpf(1) / 100
    wd = w * mpmath.sqrt(1 - z * z)

    def motion(y, v, a, slope, t):
        rest, rate = a / w**2 - 2 * z * slope / w**3, slope / w**2
        y0, v0 = y - rest, v - rate
        e, c, s = mpmath.exp(-z * w * t), mpmath.cos(wd * t), mpmath.sin(wd * t)
        x = e * (y0 * c + (v0 + z * w * y0) / wd * s)
        u = e * (v0 * c - (z * w * v0 + w * w * y0) / wd * s)
        return rest + rate * t + x, rate + u

    y, v, states = mpmath.mpf(0), mpmath.mpf(0), []
    exact = [mpmath.mpf(f"{x:.6f}") for x in values]
    for a, b in zip(exact, exact[1:]):
        states.append((y, v, a, (b - a) / h))
        y, v = motion(y, v, a, (b - a) / h, h)
    parts = max(4, int(40 * float(w * h)))
    best = mpmath.mpf(0)
    rough = [max(abs(float(state[0])), abs(float(state[1])) / float(w)) for state in states]
    highest = max(rough)
    for size, state in zip(rough, states):
        if size < 0.5 * highest:
            continue
        times = [h * i / parts for i in range(parts + 1)]
        ends = [motion(*state, t) for t in times]
        best = max([best] + [abs(end[0]) for end in ends])
        for (t, (_, u)), (t1, (_, u1)) in zip(zip(times, ends), zip(times[1:], ends[1:])):
            if u * u1 < 0:
                low, high = t, t1
                if max(abs(motion(*state, low)[0]), abs(motion(*state, high)[0])) < 0.98 * best:
                    continue
                for _ in range(70):
                    middle = (low + high) / 2
                    if motion(*state, middle)[1] * u > 0:
                        low = middle
                    else:
                        high = middle
                best = max(best, abs(motion(*state, low)[0]))
    return best * w**2


def main():
    t, values = record()
    with tempfile.TemporaryDirectory() as folder:
        rows = "\n".join(f"{x:.2f},{y:.6f}" for x, y in zip(t, values))
        pathlib.Path(folder, "quake.csv").write_text(rows + "\n")
        pathlib.Path(folder, "quake.vib").write_text(
            'base quake { moves x } = table("quake.csv", 1 m/s^2)\nbody b { mass = 1 kg, moves x }\nspring s: quake -- b { k = 1 N/m }\n'
        )
        spectrum, seconds = ours(folder)
    frequencies = numpy.array(spectrum["frequency_hz"])
    sampled, other = theirs(values, frequencies)
    # The same part of the motion: until the last row.
    mine = numpy.maximum(spectrum["primary_positive"], spectrum["primary_negative"])
    bound = max(max(spectrum[f"primary_{side}_error_bounds"][i] for side in ("positive", "negative")) / mine[i] for i in range(len(mine)))
    exact = {i: truth(values, frequencies[i]) for i in CHECKED}
    off = {name: max(float(abs(mpmath.mpf(float(found[i])) / exact[i] - 1)) for i in CHECKED) for name, found in (("vibc", mine), ("lfilter", sampled))}
    print("| 200 frequencies, 10,000 points | [ms] | largest error at six frequencies | largest bound |")
    print("| --- | --- | --- | --- |")
    print(f"| vibc shock | {1e3 * seconds:.2f} | {off['vibc']:.1e} | {bound:.1e} |")
    print(f"| scipy.signal.lfilter, ramp-invariant | {1e3 * other:.2f} | {off['lfilter']:.1e} | none |")


main()
