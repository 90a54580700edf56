"""Cases a second and core of `vibc sweep`, each number with its bound, beside NumPy's batched LAPACK on matrices that stand ready and a SymPy
model made into a NumPy function, in one run; then growth with coordinates and with cases, followed modes, and one core beside two.

    python3 -m venv target/venv && target/venv/bin/pip install numpy==2.4.6 sympy==1.14.0 python-flint==0.9.0
    cargo build --release && target/venv/bin/python benches/sweep.py [--quick] [--large] [PROGRAM]

Times are processor time on one core, without the start: that of a run less that of one with 16 cases, the median of three. NumPy's matrices
are built before its clock starts; SymPy's function builds its own from the values. Errors are relative, of three cases, beside eigenvalues
that FLINT encloses in 50 digits; an error above its bound ends the program with status 1. `--large` adds 1e7 cases, `--quick` takes a
twentieth of the cases, to see that all of it runs; `--only=growth` (beside, growth, cases, followed, drawn, cores) makes one table.
"""

import copy
import csv
import filecmp
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import flint
import numpy
import sympy

ROOT = pathlib.Path(__file__).resolve().parent.parent
GIVEN = [word for word in sys.argv[1:] if not word.startswith("--")]
VIBC = pathlib.Path(GIVEN[0]).resolve() if GIVEN else ROOT / "target" / "release" / "vibc"
ONLY = [word.removeprefix("--only=") for word in sys.argv[1:] if word.startswith("--only=")]
QUICK, LARGE = "--quick" in sys.argv, "--large" in sys.argv
CORES = sorted(os.sched_getaffinity(0))
FEW = 16
# What is varied, if not a stiffness.
LENGTHS = {"Cart": ", length of a cart's rod", "Pendulum": ", length of a pendulum", "Pendulums": ", length of pendulums"}
REPEATS = 1 if QUICK else 3
flint.ctx.dps = 50


class Chain:
    """Masses in a row with unlike springs and dampers. The stiffness of the last spring, `k`, is varied: it only weighs a term of K. With a
    `count` of two or three it is also that of the first spring, and of one more from the last mass to the ground."""

    parameter, low, high, unit = "k", 50, 150, "N/m"

    def __init__(self, n, count=1):
        self.n, self.count = n, count
        self.varied = (n - 1, 0)[:count]
        self.masses = [flint.fmpq(8 + i, 8) for i in range(n)]
        self.springs = [flint.fmpq(90 + 7 * (i % 11)) for i in range(n - 1)]
        self.dampers = [flint.fmpq(1 + i % 3, 10) for i in range(n)]
        rows = ["model chain", "param k = 100 N/m"]
        for i in range(n):
            before = f"b{i - 1}" if i else "ground"
            stiffness = "k" if i in self.varied else f"{int(self.springs[i].p)} N/m"
            rows.append(f"body b{i} {{ mass = {(8 + i) / 8} kg, moves x }}")
            rows.append(f"spring s{i}: {before} -- b{i} {{ k = {stiffness} }}")
            rows.append(f"damper d{i}: {before} -- b{i} {{ c = {(1 + i % 3) / 10} N*s/m }}")
        if count > 2:
            rows.append(f"spring last: ground -- b{n - 1} {{ k = k }}")
        self.text = "\n".join(rows) + "\n"

    def matrices(self, k):
        """M, C and K, in the numbers that k is one of."""
        n, zero = self.n, 0 * k
        m, c, s = ([[zero] * n for _ in range(n)] for _ in range(3))
        for i in range(n):
            m[i][i] = self.masses[i]
            for matrix, value in ((c, self.dampers[i]), (s, k if i in self.varied else self.springs[i])):
                matrix[i][i] = matrix[i][i] + value
                if i:
                    matrix[i - 1][i - 1] = matrix[i - 1][i - 1] + value
                    matrix[i - 1][i] = matrix[i][i - 1] = -value
        if self.count > 2:
            s[n - 1][n - 1] = s[n - 1][n - 1] + k
        return m, c, s


class Pendulum:
    """The double pendulum of the examples. Its length is varied, which moves places and rest, so far that cases are computed one by one."""

    parameter, low, high, unit, n = "l", 1, 3, "m", 2
    text = (ROOT / "examples" / "double_pendulum.vib").read_text()

    def matrices(self, l):
        g, zero = (981 * l) / 100, 0 * l
        return [[2 * l * l, l * l], [l * l, l * l]], [[zero, zero], [zero, zero]], [[2 * g, zero], [zero, g]]


class Pendulums:
    """Point masses that hang one from another on strings of equal length, drawn askew. The length moves places and rest."""

    parameter, low, high, unit = "l", 1, 3, "m"

    def __init__(self, n):
        self.n = n
        self.masses = [flint.fmpq(8 + i, 8) for i in range(n)]
        rows = ["model pendulums", "param l = 1 m", "gravity 9.81 m/s^2", "point P0 = (0, 0)"]
        for i in range(n):
            rows.append(f"point P{i + 1} = P{i} + l * (sin({5 + 2 * i} deg), -cos({5 + 2 * i} deg))")
        for i in range(n):
            rows.append(f"body b{i} {{ mass = {(8 + i) / 8} kg, inertia = 0 kg*m^2, at = P{i + 1} }}")
        for i in range(n):
            rows.append(f"pivot p{i}: {f'b{i - 1}' if i else 'ground'}@P{i} -- b{i}")
        self.text = "\n".join(rows) + "\n"

    def matrices(self, l):
        below = [sum(self.masses[i:], 0 * self.masses[0]) for i in range(self.n)]
        places, zero = range(self.n), 0 * l
        m = [[l * l * below[max(i, j)] for j in places] for i in places]
        k = [[(981 * l) / 100 * below[i] if i == j else zero for j in places] for i in places]
        return m, [[zero] * self.n for _ in places], k


class Cart:
    """The cart of the examples. The length of its rod is varied, which moves places."""

    parameter, low, high, unit, n = "L", 1, 3, "m", 2
    text = (ROOT / "examples" / "cart.vib").read_text()

    def matrices(self, l):
        zero = 0 * l
        return [[zero + 3 / (zero + 2), l / 4], [l / 4, l * l / 6]], [[zero + 5, zero], [zero, zero]], [[zero + 10, zero], [zero, (981 * l) / 400]]


def started(folder, arguments, cores=CORES[:1]):
    return subprocess.Popen([VIBC, *arguments], cwd=folder, stdout=subprocess.DEVNULL, preexec_fn=lambda: os.sched_setaffinity(0, cores))


def run(folder, arguments, cores=1):
    """Processor seconds, and seconds on the wall, of a run of vibc on so many cores."""
    begun = time.perf_counter()
    child = started(folder, arguments, CORES[:cores])
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        raise SystemExit(f"vibc {' '.join(map(str, arguments))}: status {child.returncode}")
    return used.ru_utime + used.ru_stime, time.perf_counter() - begun


def peak_of(folder, arguments):
    """The peak of memory of a run in MB, as it was last seen: a short run may pass unseen. (What the kernel tells at the end counts Python before it became vibc.)"""
    child, peak = started(folder, arguments), 0
    while child.poll() is None:
        try:
            lines = pathlib.Path(f"/proc/{child.pid}/status").read_text().splitlines()
        except OSError:
            continue
        # No such line as long as it is not vibc, and when it ends.
        running = "Name:\tpython" not in lines[0]
        peak = max([peak] + [int(line.split()[1]) for line in lines if running and line.startswith("VmHWM:")])
        time.sleep(0.002)
    return f"{peak / 1024:.0f}" if peak else "not seen"


def asked(model, cases, what, *more):
    return ["sweep", "model.vib", "--over", f"{model.parameter}={model.low}{model.unit}..{model.high}{model.unit}:{cases}", *what, *more]


def a_case(folder, model, cases, what, *more):
    """Microseconds a case."""
    times = []
    for _ in range(REPEATS):
        start, _ = run(folder, asked(model, FEW, what, *more))
        whole, _ = run(folder, asked(model, cases, what, *more))
        times.append(1e6 * (whole - start) / (cases - FEW))
    return statistics.median(times)


def table(folder, model, cases, what):
    """The heading and the rows at the first, a middle and the last of the cases, with their numbers; and bytes a case."""
    run(folder, [*asked(model, cases, what), "--format", "csv", "-o", "rows.csv"])
    path = pathlib.Path(folder, "rows.csv")
    wanted, rows = (0, cases // 3, cases - 1), []
    with path.open() as file:
        heading = next(csv.reader([file.readline()]))
        for number, line in enumerate(file):
            if number in wanted:
                rows.append((number, next(csv.reader([line]))))
    size = path.stat().st_size / cases
    path.unlink()
    return heading, rows, size


def exact(model, value, poles):
    """Frequencies in Hz in ascending order, or poles, enclosed."""
    m, c, k = (flint.fmpq_mat(matrix) for matrix in model.matrices(value))
    n, inverse = model.n, m.inv()
    if not poles:
        values = sorted((root.real for root in flint.acb_mat(inverse * k).eig()), key=lambda root: float(root.mid()))
        return [root.sqrt() / (2 * flint.arb.pi()) for root in values]
    a, b = inverse * k, inverse * c
    rows = [[int(j == n + i) for j in range(2 * n)] for i in range(n)]
    rows += [[-a[i, j] for j in range(n)] + [-b[i, j] for j in range(n)] for i in range(n)]
    return flint.acb_mat(flint.fmpq_mat(rows)).eig()


def judged(heading, rows, cases, model, poles, tried=None):
    """The largest relative bound and error of vibc in some cases; with `tried`, also the largest error of those numbers, by case."""
    place = {name.split(" ")[0]: i for i, name in enumerate(heading)}
    largest_bound = largest_error = other = 0.0
    for number, row in rows:
        value = model.low + flint.fmpq(model.high - model.low) * number / (cases - 1)
        truth = exact(model, value, poles)
        parts = ("re", "im") if poles else (None,)
        for i in range(len(truth)):
            names = [f"pole_{i + 1}_{part}" if poles else f"frequency_{i + 1}" for part in parts]
            shown = [flint.arb(float(row[place[name]])) for name in names]
            bounds = [float(row[place[f"{name}_bound"]]) for name in names]
            if poles:
                point = flint.acb(*shown)
                true = min(truth, key=lambda root: float(abs(root - point).mid()))
                errors, size = [abs(shown[0] - true.real), abs(shown[1] - true.imag)], float(abs(true).mid())
            else:
                true = truth[i]
                errors, size = [abs(shown[0] - true)], float(true.mid())
            for name, error, bound in zip(names, errors, bounds):
                if error.lower() > bound:
                    raise SystemExit(f"case {number}: the error of {name} is {error}, above its bound {bound}")
            largest_bound = max(largest_bound, max(bounds) / size)
            largest_error = max(largest_error, max(float(error.mid()) for error in errors) / size)
            if tried is not None:
                near = min(float(abs(true - (flint.acb(x.real, x.imag) if poles else flint.arb(float(x)))).mid()) for x in tried[number])
                other = max(other, near / size)
    return largest_bound, largest_error, other


def arrays(model, values):
    """M, C and K of many cases, built before any clock starts."""
    ends = [[numpy.array([[float(x.p) / float(x.q) for x in map(flint.fmpq, row)] for row in matrix]) for matrix in model.matrices(flint.fmpq(at))] for at in (0, 1, 2)]
    # Each entry is at most quadratic in the parameter.
    made = []
    for low, middle, high in zip(*ends):
        second = (high - 2 * middle + low) / 2
        made.append(low + values[:, None, None] * (middle - low - second) + values[:, None, None] ** 2 * second)
    return made


def symmetric(m, k):
    inverse = numpy.linalg.inv(numpy.linalg.cholesky(m))
    return inverse @ k @ inverse.transpose(0, 2, 1)


def companion(m, c, k):
    n, inverse = m.shape[1], numpy.linalg.inv(m)
    upper = numpy.broadcast_to(numpy.hstack([numpy.zeros((n, n)), numpy.eye(n)]), (len(m), n, 2 * n))
    return numpy.concatenate([upper, numpy.concatenate([-inverse @ k, -inverse @ c], axis=2)], axis=1)


def timed(work, count):
    """Microseconds a case, and what was found."""
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        found = work()
        times.append(1e6 * (time.process_time() - start) / count)
    return statistics.median(times), found


def lambdified(model, poles):
    """The model in symbols as a function of many values: from these to frequencies or poles."""
    symbol = sympy.Symbol("p", positive=True)
    # Rational numbers of one library in symbols of the other.
    rational = lambda x: sympy.Rational(int(x.p), int(x.q)) if isinstance(x, flint.fmpq) else x
    numbers = copy.copy(model)
    for name in ("masses", "springs", "dampers"):
        if hasattr(model, name):
            setattr(numbers, name, [rational(x) for x in getattr(model, name)])
    entries = [[sympy.sympify(x) for row in matrix for x in row] for matrix in numbers.matrices(symbol)]
    functions = [sympy.lambdify(symbol, list_of, "numpy") for list_of in entries]
    n = model.n

    def built(function, values):
        matrix = numpy.empty((n * n, len(values)))
        for place, entry in enumerate(function(values)):
            matrix[place] = entry
        return numpy.ascontiguousarray(matrix.T).reshape(-1, n, n)

    def work(values):
        m, c, k = (built(function, values) for function in functions)
        if poles:
            return numpy.linalg.eigvals(companion(m, c, k))
        return numpy.sqrt(numpy.linalg.eigvalsh(symmetric(m, k))) / (2 * math.pi)

    return work


def beside(folder):
    print("| study | cases | vibc, ranges [us] | vibc, CSV [us] | bytes a case | largest bound | error | NumPy [us] | error | SymPy and NumPy [us] | error |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    studies = [
        (Chain(2), False, 1_000_000, 200_000),
        (Chain(10), False, 400_000, 50_000),
        (Chain(50), False, 50_000, 1_000),
        (Chain(2), True, 1_000_000, 100_000),
        (Chain(10), True, 400_000, 10_000),
        (Chain(50), True, 20_000, 300),
        (Chain(2, 2), True, 400_000, 100_000),
        (Chain(10, 2), True, 100_000, 10_000),
        (Chain(50, 2), True, 10_000, 300),
        (Chain(2, 3), True, 400_000, 100_000),
        (Chain(10, 3), True, 100_000, 10_000),
        (Chain(50, 3), True, 10_000, 300),
        (Cart(), False, 400_000, 200_000),
        (Pendulum(), False, 4_000, 200_000),
        (Pendulums(10), False, 100_000, 50_000),
        (Pendulum(), True, 4_000, 100_000),
    ]
    for model, poles, cases, theirs in studies:
        if QUICK:
            cases, theirs = max(cases // 20, 40), max(theirs // 20, 40)
        pathlib.Path(folder, "model.vib").write_text(model.text)
        what = ["--poles"] if poles else ["--modes", str(model.n)]
        plain = a_case(folder, model, cases, what)
        as_csv = a_case(folder, model, cases, what, "--format", "csv")
        heading, rows, size = table(folder, model, cases, what)
        # The same values for the others, and the cases that are checked among them.
        values = numpy.linspace(model.low, model.high, theirs)
        at = [number for number, _ in rows]
        checked = model.low + (model.high - model.low) * numpy.array(at) / (cases - 1)
        m, c, k = arrays(model, values)
        matrices = companion(m, c, k) if poles else symmetric(m, k)
        solve = numpy.linalg.eigvals if poles else numpy.linalg.eigvalsh
        numpys, _ = timed(lambda: solve(matrices), theirs)
        m, c, k = arrays(model, checked)
        found = solve(companion(m, c, k) if poles else symmetric(m, k))
        found = found if poles else numpy.sqrt(found) / (2 * math.pi)
        function = lambdified(model, poles)
        sympys, _ = timed(lambda: function(values), theirs)
        bound, error, of_numpy = judged(heading, rows, cases, model, poles, dict(zip(at, found)))
        _, _, of_sympy = judged(heading, rows, cases, model, poles, dict(zip(at, function(checked))))
        name = f"{'all poles' if poles else 'frequencies'}, {model.n}" + LENGTHS.get(type(model).__name__, "")
        name += f", k in {model.count} springs" if getattr(model, "count", 1) > 1 else ""
        print(
            f"| {name} | {cases} | {plain:.3g} | {as_csv:.3g} | {size:.0f} | {bound:.1e} | {error:.1e} "
            f"| {numpys:.3g} | {of_numpy:.1e} | {sympys:.3g} | {of_sympy:.1e} |",
            flush=True,
        )


def growth(folder):
    print("\n| coordinates | cases | frequencies [us] | all poles [us] | NumPy eigvalsh [us] | eigvals [us] |")
    print("| --- | --- | --- | --- | --- | --- |")
    for n in (2, 5, 10, 16, 17, 20, 50, 100, 200):
        model = Chain(n)
        pathlib.Path(folder, "model.vib").write_text(model.text)
        cases = max(400_000 // n, 4_000)
        damped = max(400_000 // n, 4_000)
        cases, damped = (max(x // 20, FEW + 4) for x in (cases, damped)) if QUICK else (cases, damped)
        plain = a_case(folder, model, cases, ["--modes", str(n)])
        poles = a_case(folder, model, damped, ["--poles"])
        theirs = max(1_000_000 // n**3, 8) if QUICK else max(20_000_000 // n**3, 8)
        m, c, k = arrays(model, numpy.linspace(model.low, model.high, min(theirs, 200_000)))
        pencils, companions = symmetric(m, k), companion(m, c, k)
        frequencies, _ = timed(lambda: numpy.linalg.eigvalsh(pencils), len(m))
        others, _ = timed(lambda: numpy.linalg.eigvals(companions), len(m))
        print(f"| {n} | {cases}, {damped} | {plain:.3g} | {poles:.3g} | {frequencies:.3g} | {others:.3g} |", flush=True)


def cases_and_memory(folder):
    model = Chain(10)
    pathlib.Path(folder, "model.vib").write_text(model.text)
    print("\n| cases, 10 frequencies | ranges [us a case] | peak [MB] | CSV [us a case] | peak [MB] | file [MB] |")
    print("| --- | --- | --- | --- | --- | --- |")
    sizes = [10**3, 10**4, 10**5, 10**6, 10**7]
    for cases in sizes[: 3 if QUICK else 5 if LARGE else 4]:
        ranges = asked(model, cases, ["--modes", "10"])
        as_csv = [*ranges, "--format", "csv", "-o", "rows.csv"]
        seconds, rows = run(folder, ranges)[0], run(folder, as_csv)[0]
        peak, peak_of_rows = peak_of(folder, ranges), peak_of(folder, as_csv)
        path = pathlib.Path(folder, "rows.csv")
        size = path.stat().st_size / 1e6
        path.unlink()
        print(f"| {cases:.0e} | {1e6 * seconds / cases:.3g} | {peak} | {1e6 * rows / cases:.3g} | {peak_of_rows} | {size:.3g} |", flush=True)


def followed(folder):
    """The cost of following modes beside that of the plain frequencies, and how many links are proved."""
    print("\n| followed modes | cases | links proved | veerings | plain [us] | followed [us] | times |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for model, plainly, cases in ((Chain(2), 1_000_000, 10_000), (Chain(10), 400_000, 10_000), (Chain(50), 50_000, 10_000), (Cart(), 400_000, 10_000), (Pendulum(), 1_000, 1_000), (Pendulums(10), 100, 100), (Pendulums(10), 1_000, 1_000), (Pendulums(10), 10_000, 10_000)):
        plainly, cases = (max(x // 20, 3 * FEW) for x in (plainly, cases)) if QUICK else (plainly, cases)
        pathlib.Path(folder, "model.vib").write_text(model.text)
        what = ["--modes", str(model.n)]
        run(folder, [*asked(model, cases, what), "--follow", "--format", "json", "-o", "told.json"])
        told = json.loads(pathlib.Path(folder, "told.json").read_text())["following"]
        links = [len(curve["open_links"]) for curve in told["curves"]]
        proved = f"{100 * (1 - sum(links) / (len(links) * (cases - 1))):.4g} %"
        plain = a_case(folder, model, plainly, what)
        # All of it: the veerings and onsets of the study, too, but not the start of the program.
        whole = statistics.median(run(folder, asked(model, cases, [*what, "--follow"]))[0] for _ in range(REPEATS))
        start = statistics.median(run(folder, asked(model, FEW, what))[0] for _ in range(REPEATS))
        more = 1e6 * (whole - start) / cases
        name = f"{model.n}" + LENGTHS.get(type(model).__name__, "")
        print(f"| {name} | {cases} | {proved} | {len(told['meetings'])} | {plain:.3g} | {more:.3g} | {more / plain:.3g} |", flush=True)


def drawn(folder):
    """Random cases: the last stiffness and the first mass of a chain, with the means and quantiles of the report, beside NumPy's batched
    eigenvalues of matrices that stand ready."""
    print("\n| random cases, coordinates | cases | vibc [us] | bound | NumPy [us] | one by one [us] |")
    print("| --- | --- | --- | --- | --- | --- |")
    for n, cases in ((2, 400_000), (10, 100_000)):
        cases = max(cases // 20, 3 * FEW) if QUICK else cases
        model = Chain(n)
        text = model.text.replace("param k = 100 N/m", "param k = 100 N/m within 10 %\nparam m = 1 kg spread 3 %").replace("body b0 { mass = 1.0 kg", "body b0 { mass = m")
        # A stiffness that is no linear function of its parameter: each case by itself.
        singly = text.replace("{ k = k }", "{ k = k^2 / (100 N/m) }")
        each = []
        for own, count in ((text, cases), (singly, max(cases // 20, 3 * FEW))):
            pathlib.Path(folder, "model.vib").write_text(own)
            asked = lambda count: ["sweep", "model.vib", "--samples", str(count), "--modes", str(n)]
            more = statistics.median(run(folder, asked(count))[0] - run(folder, asked(FEW))[0] for _ in range(REPEATS))
            each.append(1e6 * more / count)
        pathlib.Path(folder, "model.vib").write_text(text)
        run(folder, ["sweep", "model.vib", "--samples", "200", "--modes", str(n), "--format", "csv", "-o", "rows.csv"])
        with open(pathlib.Path(folder, "rows.csv")) as file:
            rows = list(csv.DictReader(file))
        bound = max(float(row[f"frequency_{i}_bound"]) / float(row[f"frequency_{i} [Hz]"]) for row in rows for i in range(1, n + 1))
        some = min(cases, 50_000)
        rng = numpy.random.default_rng(1)
        m, _, k = arrays(model, rng.uniform(90, 110, some))
        m[:, 0, 0] = rng.normal(1, 0.03, some)
        a = symmetric(m, k)
        print(f"| {n} | {cases} | {each[0]:.3g} | {bound:.0e} | {timed(lambda: numpy.linalg.eigvalsh(a), some)[0]:.3g} | {each[1]:.3g} |", flush=True)


def cores(folder):
    """One core beside two: runs in turn, the least time of five each, which is the one that others had the least part in. The last
    column is what the machine gives: how many times the work of one program two of them do, each on a core of its own."""
    if len(CORES) < 2:
        print("\nOne core beside two: left out, there is one.")
        return
    print("\n| study | cases | ranges: one core [s] | two [s] | times | CSV: one core [s] | two [s] | times | two programs: times |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for model, what, cases in ((Chain(10), ["--modes", "10"], 4_000_000), (Chain(10), ["--poles"], 1_000_000), (Pendulum(), ["--modes", "2"], 10_000)):
        cases = cases // 20 if QUICK else cases
        pathlib.Path(folder, "model.vib").write_text(model.text)
        ranges, rows, pairs = ([], []), ([], []), []
        for _ in range(REPEATS if QUICK else 5):
            for count in (1, 2):
                ranges[count - 1].append(run(folder, asked(model, cases, what), count)[1])
                pathlib.Path(folder, f"{count}.csv").unlink(missing_ok=True)
                rows[count - 1].append(run(folder, [*asked(model, cases // 4, what), "--format", "csv", "-o", f"{count}.csv"], count)[1])
            begun = time.perf_counter()
            programs = [started(folder, asked(model, cases, what), [core]) for core in CORES[:2]]
            if any([program.wait() for program in programs]):
                raise SystemExit("a program beside another one failed")
            pairs.append(time.perf_counter() - begun)
        if not filecmp.cmp(pathlib.Path(folder, "1.csv"), pathlib.Path(folder, "2.csv"), shallow=False):
            raise SystemExit("one core and two give other bytes")
        columns = [column for one, two in (ranges, rows) for column in (f"{min(one):.2f}", f"{min(two):.2f}", f"{min(one) / min(two):.2f}")]
        print(f"| {' '.join(what)}, {model.n} coordinates | {cases} | {' | '.join(columns)} | {2 * min(ranges[0]) / min(pairs):.2f} |", flush=True)


def main():
    os.sched_setaffinity(0, CORES[:1])
    tables = {"beside": beside, "growth": growth, "cases": cases_and_memory, "followed": followed, "drawn": drawn, "cores": cores}
    with tempfile.TemporaryDirectory() as folder:
        for name in ONLY or tables:
            tables[name](folder)


main()
