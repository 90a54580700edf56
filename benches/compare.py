"""The hard cases of tests/hardcases by vibc and by what people would use instead, in one run on one machine.

    python3 -m venv target/venv && target/venv/bin/pip install numpy==2.4.6 scipy==1.17.1 control==0.10.2
    cargo build --release && target/venv/bin/python benches/compare.py

Every tool gets the same numbers: the others the matrices in binary64, vibc a model whose parameters are the same numbers
in full. "Digits" is -log10 of the relative error of the worst value of a case against the certified reference (complex
error for poles and transfer functions; for motions the error of a displacement over the largest of the case), 17 at the
most. A rigid motion that comes out with a frequency above 1e-9 of the lowest true one counts as no digit, as does a value
that is missing or not a number. "fails" is an exception, or more than a minute.
Times are medians of five: of the call for the libraries, whose import is not counted; of the whole process for vibc.
"""

import json
import math
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from fractions import Fraction

import control
import numpy
import scipy.integrate
import scipy.linalg

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIBC = ROOT / "target" / "release" / "vibc"
PINNED = {"numpy": ("2.4.6", numpy), "scipy": ("1.17.1", scipy), "control": ("0.10.2", control)}
RUNS = 5
MOST = 17.0
PATIENCE = 60


# ---- The cases


class Case:
    """A hard case: matrices in binary64, a model of the same numbers, references in full precision."""

    def __init__(self, path):
        data = json.loads(path.read_text())
        self.name = data["name"]
        self.small = "f64" in data
        if not self.small:
            return
        self.names = data["dofs"]
        self.m, self.c, self.k = (numpy.array(data["f64"][key], dtype=float) for key in "MCK")
        self.damped = bool(numpy.any(self.c))
        self.factored = data["factored"]
        self.reference = {entry["id"]: Fraction(entry["value"]) for entry in data["reference"]}
        self.expect = data["expect"] if isinstance(data["expect"], dict) else {}

    def frequencies(self):
        """rad/s, ascending: the true ones."""
        return [float(self.reference[key]) for key in sorted_ids(self.reference, "omega_")]

    def poles(self):
        """One of each pair."""
        found = []
        for key in sorted_ids({i for i in self.reference if i.endswith("_re")}, "lambda_"):
            im = self.reference.get(key[:-3] + "_im", Fraction(0))
            found.append((self.reference[key], im))
        return found

    def transfer(self):
        """(output, input, rad/s as written, re, im), receptances between coordinates that are not exactly zero."""
        found = []
        for key, re in self.reference.items():
            if not key.startswith("frf[") or not key.endswith(":re"):
                continue
            pair, omega = key[4:-3].split("]@w=")
            output, source = pair.split("/")
            im = self.reference.get(key[:-3] + ":im")
            if source in self.names and output in self.names and im is not None and (re, im) != (0, 0):
                found.append((output, source, omega, re, im))
        return found

    def motions(self):
        """{time: {coordinate: displacement}} after a release of the first coordinate from 1."""
        found = {}
        for key, value in self.reference.items():
            if key.startswith("x[") and self.name in RELEASED:
                name, at = key[2:].split("]@t=")
                found.setdefault(at, {})[name] = value
        return found

    def model(self):
        """The same numbers as a .vib text. A row of several entries is a massless body that is coupled to them."""
        text = []
        own = {}
        squares = []
        for term in self.factored["masses"]:
            row = {name: Fraction(value) for name, value in term["row"].items()}
            if len(row) == 1 and abs(next(iter(row.values()))) == 1:
                own[next(iter(row))] = term["m"]
            else:
                squares.append(("mass", row, term["m"]))
        for name in self.names:
            text.append(f"body {name} {{ mass = {own.get(name, '0')} kg, moves x }}")
        for kind, group, key in (("k", "springs", "k"), ("k", "geometric", "g"), ("c", "dampers", "c")):
            for term in self.factored[group]:
                squares.append((kind, {n: Fraction(v) for n, v in term["row"].items()}, term.get(key, term.get("k"))))
        for i, (kind, row, weight) in enumerate(squares):
            text += element(i, kind, row, weight)
        for name in self.names:
            text += [f"force f_{name}: {name} along x", f"output o_{name} = {name}.x"]
        text.append(f"initial {self.names[0]} {{ x = 1 m }}")
        return "\n".join(text) + "\n"


RELEASED = ["o12_critical_sdof", "o13_near_critical_sdof", "o27_long_phase", "o28_stiff_transient", "o32_nearcritical_2dof"]


def sorted_ids(ids, prefix):
    return sorted((i for i in ids if i.startswith(prefix)), key=lambda i: int(i.split("_")[1]))


def element(i, kind, row, weight):
    word, unit = ("damper", "N*s/m") if kind == "c" else ("spring", "N/m")
    ends = None
    if kind != "mass" and len(row) == 1 and abs(next(iter(row.values()))) == 1:
        ends = f"ground -- {next(iter(row))}"
    if kind != "mass" and len(row) == 2 and sum(row.values()) == 0 and abs(next(iter(row.values()))) == 1:
        ends = " -- ".join(row)
    if ends:
        return [f"{word} e{i}: {ends} {{ {kind} = {weight} {unit} }}"]
    total = " + ".join(f"({v.numerator}/{v.denominator}) * {n}.x" for n, v in row.items())
    mass = weight if kind == "mass" else "0"
    lines = [f"body row{i} {{ mass = {mass} kg, moves x }}", f"couple same{i}: row{i}.x = {total}"]
    return lines if kind == "mass" else lines + [f"{word} e{i}: ground -- row{i} {{ {kind} = {weight} {unit} }}"]


# ---- What people would use


def eigh(case):
    squares = scipy.linalg.eigh(case.k, case.m, eigvals_only=True)
    return [math.sqrt(s) if s >= 0 else math.nan for s in squares]


def inverse(case):
    squares = sorted(numpy.linalg.eigvals(numpy.linalg.solve(case.m, case.k)).real)
    return [math.sqrt(s) if s >= 0 else math.nan for s in squares]


def state_matrix(case):
    n = len(case.m)
    below = -numpy.linalg.solve(case.m, numpy.hstack([case.k, case.c]))
    return numpy.vstack([numpy.hstack([numpy.zeros((n, n)), numpy.eye(n)]), below])


def companion(case):
    return numpy.linalg.eigvals(state_matrix(case))


def qz(case):
    n = len(case.m)
    zero, one = numpy.zeros((n, n)), numpy.eye(n)
    a = numpy.block([[zero, one], [-case.k, -case.c]])
    b = numpy.block([[one, zero], [zero, case.m]])
    return scipy.linalg.eigvals(a, b)


def state_space(case):
    n = len(case.m)
    b = numpy.vstack([numpy.zeros((n, n)), numpy.linalg.inv(case.m)])
    return control.ss(state_matrix(case), b, numpy.eye(n, 2 * n), numpy.zeros((n, n)))


def control_poles(case):
    return control.poles(state_space(case))


def solve(case):
    values = []
    for output, source, omega, _, _ in case.transfer():
        w = float(omega)
        load = numpy.zeros(len(case.m))
        load[case.names.index(source)] = 1
        q = numpy.linalg.solve(case.k + 1j * w * case.c - w * w * case.m, load)
        values.append(q[case.names.index(output)])
    return values


def control_transfer(case):
    system = state_space(case)
    return [
        system(1j * float(omega))[case.names.index(output), case.names.index(source)]
        if len(case.m) > 1
        else system(1j * float(omega))
        for output, source, omega, _, _ in case.transfer()
    ]


def start(case):
    z = numpy.zeros(2 * len(case.m))
    z[0] = 1
    return z


def by_solve_ivp(method):
    def run(case):
        a, z = state_matrix(case), start(case)
        times = [float(t) for t in case.motions() if float(t) <= LONGEST]
        options = {"rtol": 1e-12, "atol": 1e-14, "method": method}
        found = [scipy.integrate.solve_ivp(lambda _, y: a @ y, (0, t), z, t_eval=[t], **options) for t in times]
        return [f.y[: len(case.m), -1] if f.success else numpy.full(len(case.m), math.nan) for f in found]

    return run


def by_expm(case):
    a, z = state_matrix(case), start(case)
    times = [float(t) for t in case.motions() if float(t) <= LONGEST]
    return [(scipy.linalg.expm(a * t) @ z)[: len(case.m)] for t in times]


# Longer motions take an integrator hours; vibc computes them too.
LONGEST = 1000.0


# ---- vibc


class Vibc:
    def __init__(self, case, folder):
        self.case = case
        self.path = folder / f"{case.name}.vib"
        self.path.write_text(case.model())

    def run(self, *arguments):
        done = subprocess.run([VIBC, *arguments, "-q"], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr.strip().splitlines()[0])
        return done.stdout

    def report(self, _):
        return json.loads(self.run("analyze", self.path, "--format", "json"))

    def frequencies(self, case):
        return [m["omega"] if m["omega"] is not None else math.nan for m in self.report(case)["modes"]]

    def poles(self, case):
        return [complex(p["re"], p["im"]) for p in self.report(case)["poles"]]

    def transfer(self, case):
        wanted = case.transfer()
        at = [word for omega in dict.fromkeys(w[2] for w in wanted) for word in ("--at", exactly(omega) + "rad/s")]
        rows = json.loads(self.run("transfer", self.path, *at, "--format", "json"))
        found = {(r["output"], r["input"], r["frequency_hz"]): r for r in rows}
        values = []
        for output, source, omega, _, _ in wanted:
            near = min(
                (r for (o, i, _), r in found.items() if (o, i) == ("o_" + output, "f_" + source)),
                key=lambda r: abs(r["frequency_hz"] * 2 * math.pi - float(omega)),
            )
            values.append(math.nan if near["re"] is None else complex(near["re"], near["im"]))
        return values

    def motions(self, case):
        values = []
        for at in (t for t in case.motions() if float(t) <= LONGEST):
            step = exactly(at) + "s"
            table = self.run("simulate", self.path, "--until", step, "--step", step).splitlines()
            row = dict(zip(table[0].split(","), map(float, table[-1].split(","))))
            values.append(numpy.array([row["o_" + name] for name in case.names]))
        return values


def exactly(text):
    """The binary64 number that a decimal stands for, written out."""
    whole = Fraction(float(text))
    digits = 0
    while whole.denominator != 1:
        whole *= 10
        digits += 1
    return f"{whole.numerator}e-{digits}"


# ---- Errors and times


def digits(error):
    if math.isnan(error):
        return 0.0
    return MOST if error == 0 else max(0.0, min(MOST, -math.log10(error)))


def relative(found, truth):
    """|found - truth| / |truth| in exact arithmetic."""
    if math.isnan(found):
        return math.nan
    return float(abs(Fraction(found) - truth) / abs(truth))


def relative_complex(found, re, im):
    if math.isnan(found.real) or math.isnan(found.imag):
        return math.nan
    error = (Fraction(found.real) - re) ** 2 + (Fraction(found.imag) - im) ** 2
    return math.sqrt(float(error / (re**2 + im**2)))


def worst(errors):
    errors = list(errors)
    return math.nan if any(math.isnan(e) for e in errors) else max(errors)


def frequency_error(case, found):
    ids = sorted_ids(case.reference, "omega_")
    truth = [case.reference[i] for i in ids]
    if len(found) < len(truth):
        return math.nan
    lowest = float(min(t for t in truth if t > 0))
    rigid = [f for f, t in zip(found, truth) if t == 0]
    if any(math.isnan(f) or f > 1e-9 * lowest for f in rigid):
        return math.nan
    return worst(relative(f, t) for f, t in zip(found, truth) if t != 0)


def pole_error(case, found):
    def nearest(re, im):
        a = complex(float(re), float(im))
        pole = min(found, key=lambda p: min(abs(p - a), abs(p.conjugate() - a)))
        return relative_complex(complex(pole.real, abs(pole.imag)), re, abs(im))

    return worst(nearest(re, im) for re, im in case.poles())


def real_part_error(case, found):
    def nearest(re, im):
        a = complex(float(re), float(im))
        pole = min(found, key=lambda p: min(abs(p - a), abs(p.conjugate() - a)))
        return relative(float(pole.real), re)

    return worst(nearest(re, im) for re, im in case.poles() if re != 0)


def transfer_error(case, found):
    return worst(relative_complex(complex(f), re, im) for f, (_, _, _, re, im) in zip(found, case.transfer()))


def motion_error(case, found):
    errors = []
    wanted = [truth for t, truth in case.motions().items() if float(t) <= LONGEST]
    size = max(abs(v) for truth in wanted for v in truth.values())
    for values, truth in zip(found, wanted):
        for name, value in zip(case.names, values):
            errors.append(math.nan if math.isnan(value) else float(abs(Fraction(float(value)) - truth[name]) / size))
    return worst(errors)


def measured(run, case, error):
    """Digits and milliseconds, as a cell."""
    times = []
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        while len(times) < RUNS and sum(times) < PATIENCE / 10:
            began = time.perf_counter()
            found = run(case)
            times.append(time.perf_counter() - began)
        return f"{digits(error(case, found)):.1f} ({statistics.median(times) * 1e3:.2g})"
    except (RuntimeError, ValueError, ArithmeticError, TimeoutError, numpy.linalg.LinAlgError, control.ControlArgument):
        return "fails"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def too_long(*_):
    raise TimeoutError


# ---- The tables


def table(title, note, cases, columns, error):
    print(f"\n### {title}\n\n{note}\n" if note else f"\n### {title}\n")
    print("| case | n |" + "".join(f" {name} |" for name, _ in columns))
    print("| --- | --- |" + " --- |" * len(columns))
    for case in cases:
        cells = [f" {measured(tool(case), case, error)} |" for _, tool in columns]
        print(f"| {case.name} | {len(case.m)} |" + "".join(cells), flush=True)


def main():
    for name, (version, module) in PINNED.items():
        if module.__version__ != version:
            sys.exit(f"compare.py is pinned to {name} {version}, this is {module.__version__}")
    signal.signal(signal.SIGALRM, too_long)
    warnings.simplefilter("ignore")
    cases = [Case(path) for path in sorted((ROOT / "tests" / "hardcases").glob("o*.json"))]
    cases = [case for case in cases if case.small]
    print("Digits of the worst value (milliseconds), by " + ", ".join(f"{n} {v}" for n, (v, _) in PINNED.items()) + ".")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        always = lambda run: lambda _: run
        vibc = lambda what: lambda case: getattr(Vibc(case, folder), what)
        undamped = [c for c in cases if any(i.startswith("omega_") for i in c.reference)]
        table(
            "Natural frequencies",
            "",
            undamped,
            [("SciPy `eigh`", always(eigh)), ("NumPy `eig(M⁻¹K)`", always(inverse)), ("vibc", vibc("frequencies"))],
            frequency_error,
        )
        damped = [c for c in cases if c.damped and c.poles()]
        methods = [("NumPy companion", always(companion)), ("SciPy QZ", always(qz)), ("python-control", always(control_poles))]
        table("Poles", "The complex number.", damped, methods + [("vibc", vibc("poles"))], pole_error)
        table("Decay rates", "The real part of the same poles.", damped, methods + [("vibc", vibc("poles"))], real_part_error)
        table(
            "Transfer functions",
            "",
            [c for c in cases if c.transfer()],
            [("NumPy `solve`", always(solve)), ("python-control", always(control_transfer)), ("vibc", vibc("transfer"))],
            transfer_error,
        )
        table(
            "Motions",
            f"After a release from 1, times up to {LONGEST:g} s; integrators with rtol = 1e-12 and atol = 1e-14. vibc starts a process for each time.",
            [c for c in cases if c.motions()],
            [
                ("`solve_ivp` DOP853", always(by_solve_ivp("DOP853"))),
                ("`solve_ivp` Radau", always(by_solve_ivp("Radau"))),
                ("SciPy `expm`", always(by_expm)),
                ("vibc", vibc("motions")),
            ],
            motion_error,
        )


if __name__ == "__main__":
    main()
