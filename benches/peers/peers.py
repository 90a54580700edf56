"""Modes, poles, transfer functions and motions by vibc and by what people would use instead: processor time, and errors beside it.

Run it by `benches/peers/run`. The scenes are random networks of n masses, each on springs to up to three others; undamped,
classically damped (each damper in proportion to its spring) and generally damped. The libraries get the matrices in binary64 and
are timed without their import and without assembly; vibc gets the text of a model and is timed as a whole process, from reading
the file to the printed report.

"Error" is the largest relative error of a result. The reference are vibc's own values, each of which comes with a proved bound;
in the row of vibc stands the largest of these bounds, printed digits included. Of a transfer function it is the largest error
over the largest gain, of a motion the error at the last time over the largest displacement of that time.
"""

import argparse
import csv
import io
import json
import math
import pathlib
import random
import resource
import subprocess
import sys
import tempfile
import time
import warnings

import control
import exudyn
import numpy
import scipy.linalg
import sympy
from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SIZES = [2, 10, 50, 100, 200, 500, 1000, 2000]
KINDS = ["undamped", "classical", "general"]
# Sizes up to which a peer is asked: beyond, it takes minutes or gigabytes.
LIMITS = {"SymPy": 10, "python-control": 200, "SciPy QZ": 500, "Exudyn": 500, "solve": 500, "expm": 500}
VIBC_LIMITS = {"modes": 2000, "poles": 1000, "transfer": 2000, "motion": 200}
FREQUENCIES = 200
STEPS, STEP = 100, 0.1


class Network:
    """A random network: its matrices and its model."""

    def __init__(self, n, kind):
        chance = random.Random(1000 * n + len(kind))
        self.n, self.kind = n, kind
        self.m, self.c, self.k = (numpy.zeros((n, n)) for _ in range(3))
        lines = ["model network"]
        for i in range(n):
            mass = chance.randint(100, 200) / 100
            self.m[i, i] = mass
            lines.append(f"body m{i} {{ mass = {mass} kg, moves x }}")
        pairs = [(None, 0)]
        for i in range(1, n):
            pairs += [(j, i) for j in sorted({i - 1, max(0, i - 2), chance.randrange(i)})]
        for number, (a, b) in enumerate(pairs):
            stiffness = chance.randint(100, 300) / 100
            damping = {"undamped": 0, "classical": stiffness / 64, "general": chance.randint(10, 100) / 1000}[kind]
            end = "ground" if a is None else f"m{a}"
            lines.append(f"spring s{number}: {end} -- m{b} {{ k = {stiffness} N/m }}")
            self.add(self.k, stiffness, a, b)
            if damping:
                lines.append(f"damper d{number}: {end} -- m{b} {{ c = {damping!r} N*s/m }}")
                self.add(self.c, damping, a, b)
        lines += ["force F: m0 along x = step(1 N, 0 s)", f"output y = m{n - 1}.x", ""]
        self.text = "\n".join(lines)

    @staticmethod
    def add(matrix, value, a, b):
        matrix[b, b] += value
        if a is not None:
            matrix[a, a] += value
            matrix[a, b] -= value
            matrix[b, a] -= value

    def states(self):
        inverse = numpy.diag(1 / numpy.diag(self.m))
        zero, one = numpy.zeros_like(self.m), numpy.eye(self.n)
        return numpy.block([[zero, one], [-inverse @ self.k, -inverse @ self.c]])

    def force(self):
        b = numpy.zeros((2 * self.n, 1))
        b[self.n, 0] = 1 / self.m[0, 0]
        return b

    def seen(self):
        c = numpy.zeros((1, 2 * self.n))
        c[0, self.n - 1] = 1
        return c


# ---- vibc


def vibc(program, arguments):
    """Standard output and processor time of a run."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if not done.stdout:
        raise RuntimeError(done.stderr.strip().splitlines()[0])
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def by_vibc(program, what, path, network, grid):
    """Values, their largest bound, and the time of a report (or of the table, where that is the answer)."""
    if what in ("modes", "poles"):
        text, _ = vibc(program, ["analyze", "--modes", str(network.n), "--format", "json", path])
        _, seconds = vibc(program, ["analyze", "--modes", str(network.n), path])
        data = json.loads(text)
        if what == "modes":
            values = numpy.array([mode["omega"] for mode in data["modes"]])
            bounds = [mode["omega_error_bound"] for mode in data["modes"]]
        else:
            values = numpy.array([complex(pole["re"], pole["im"]) for pole in data["poles"]])
            bounds = [pole["error_bound"] for pole in data["poles"]]
        return values, largest(bounds), seconds
    if what == "transfer":
        frequencies = [argument for f in grid for argument in ("--at", f"{float(f)!r}Hz")]
        text, seconds = vibc(program, ["transfer", "--format", "csv", *frequencies, path])
        rows = list(csv.DictReader(io.StringIO(text)))
        # An empty field: next to a resonance without damping vibc may say that a value, or its bound, is not known.
        values = numpy.array([complex(float(row["re"] or "nan"), float(row["im"] or "nan")) for row in rows])
        return values, largest(float(row["error_bound"] or "nan") for row in rows), seconds
    arguments = ["simulate", "--until", f"{STEPS * STEP:g}s", "--step", f"{STEP:g}s", "--format", "csv", "--bounds", path]
    text, seconds = vibc(program, arguments)
    last = list(csv.reader(io.StringIO(text)))[-1]
    values = numpy.array([float(last[1])])
    return values, abs(float(last[2]) / values[0]), seconds


def largest(bounds):
    bounds = [math.nan if bound is None else bound for bound in bounds]
    return max(bounds) if not any(map(math.isnan, bounds)) else math.nan


# ---- The peers: each a function of the network and the grid


def numpy_modes(network, _):
    scale = 1 / numpy.sqrt(numpy.diag(network.m))
    return numpy.sqrt(numpy.abs(numpy.linalg.eigh(scale[:, None] * network.k * scale)[0]))


def scipy_modes(network, _):
    return numpy.sqrt(numpy.abs(scipy.linalg.eigh(network.k, network.m)[0]))


def sympy_modes(network, _):
    x = sympy.symbols("x")
    exact = lambda matrix: sympy.Matrix(network.n, network.n, lambda i, j: sympy.Rational(str(round(matrix[i, j], 9))))
    determinant = sympy.Poly((exact(network.k) - x * exact(network.m)).det(method="berkowitz"), x)
    return numpy.array(sorted(float(sympy.sqrt(sympy.re(root))) for root in determinant.nroots(n=30)))


def exudyn_system(network, force):
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    zeros = [0.0] * network.n
    node = system.AddNode(NodeGenericODE2(numberOfODE2Coordinates=network.n, referenceCoordinates=zeros,
                                          initialCoordinates=zeros, initialCoordinates_t=zeros))
    system.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=network.m, stiffnessMatrix=network.k,
                                       dampingMatrix=network.c, forceVector=force))
    system.Assemble()
    return container, system, node


def exudyn_modes(network, _):
    container, system, _ = exudyn_system(network, numpy.zeros(network.n))
    values = system.ComputeODE2Eigenvalues(ignoreAlgebraicEquations=True)[0]
    return numpy.sqrt(numpy.abs(numpy.array(values)))


def exudyn_motion(network, _):
    force = numpy.zeros(network.n)
    force[0] = 1
    container, system, node = exudyn_system(network, force)
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = STEPS * 100
    settings.timeIntegration.endTime = STEPS * STEP
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    system.SolveDynamic(settings)
    return numpy.array([system.GetNodeOutput(node, exudyn.OutputVariableType.Coordinates)[-1]])


def numpy_poles(network, _):
    return numpy.linalg.eigvals(network.states())


def scipy_poles(network, _):
    zero, one = numpy.zeros_like(network.m), numpy.eye(network.n)
    left = numpy.block([[zero, one], [-network.k, -network.c]])
    return scipy.linalg.eig(left, numpy.block([[one, zero], [zero, network.m]]), right=False)


def control_poles(network, _):
    return control.poles(control.ss(network.states(), network.force(), network.seen(), 0))


def numpy_transfer(network, grid):
    b = numpy.zeros(network.n)
    b[0] = 1
    gain = lambda w: numpy.linalg.solve(network.k - w * w * network.m + 1j * w * network.c, b)[-1]
    return numpy.array([gain(2 * math.pi * f) for f in grid])


def control_transfer(network, grid):
    system = control.ss(network.states(), network.force(), network.seen(), 0)
    return numpy.ravel(control.frequency_response(system, 2 * math.pi * grid).complex)


def scipy_motion(network, _):
    size = 2 * network.n
    whole = numpy.zeros((size + 1, size + 1))
    whole[:size, :size], whole[:size, size:] = network.states(), network.force()
    step = scipy.linalg.expm(STEP * whole)
    state = numpy.zeros(size + 1)
    state[-1] = 1
    for _ in range(STEPS):
        state = step @ state
    return state[network.n - 1 : network.n]


PEERS = {
    "modes": [("NumPy eigh", "", numpy_modes), ("SciPy eigh", "", scipy_modes), ("SymPy roots", "SymPy", sympy_modes),
              ("Exudyn", "Exudyn", exudyn_modes)],
    "poles": [("NumPy eigvals", "", numpy_poles), ("SciPy QZ", "SciPy QZ", scipy_poles),
              ("python-control", "python-control", control_poles)],
    "transfer": [("NumPy solve", "solve", numpy_transfer), ("python-control", "python-control", control_transfer)],
    "motion": [("SciPy expm", "expm", scipy_motion), ("Exudyn, h = 1 ms", "Exudyn", exudyn_motion)],
}


def timed(function, network, grid):
    """The value, and the least processor time of up to three runs."""
    least, spent = math.inf, 0.0
    for _ in range(3):
        start = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value = function(network, grid)
        least = min(least, time.process_time() - start)
        spent += least
        if spent > 1:
            break
    return value, least


def error(what, found, reference):
    """The largest error of the values, matched to the nearest reference."""
    if reference is None or len(found) != len(reference):
        return math.nan
    if what == "poles":
        nearest = numpy.array([reference[numpy.abs(reference - value).argmin()] for value in found])
        return float(numpy.max(numpy.abs(found - nearest) / numpy.abs(nearest)))
    if what == "modes":
        return float(numpy.max(numpy.abs(numpy.sort(found) - numpy.sort(reference)) / numpy.sort(reference)))
    return float(numpy.nanmax(numpy.abs(found - reference)) / numpy.nanmax(numpy.abs(reference)))


# ---- The picture


COLOURS = ["#1b6ca8", "#c8553d", "#588157", "#8a5a83", "#7f7f7f"]


def picture(results):
    """Processor time over size, a panel for each quantity, both axes logarithmic; in the key the largest error of each tool.

    The networks are generally damped, those of the modes undamped."""
    width, height, left, top = 250, 190, 46, 26
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * (width + left) + 20} {2 * (height + top + 34)}" '
           'font-family="sans-serif" font-size="10">', '<rect width="100%" height="100%" fill="white"/>']
    x_of = lambda n: width * math.log(n / 2) / math.log(1000)
    y_of = lambda seconds: height * (1 - (math.log10(min(max(seconds, 1e-5), 1e2)) + 5) / 7)
    for number, what in enumerate(PEERS):
        damping = "undamped" if what == "modes" else "general"
        dx, dy = left + number % 2 * (width + left), top + number // 2 * (height + top + 34)
        out.append(f'<g transform="translate({dx} {dy})"><text x="0" y="-8" font-weight="bold">{what}</text>'
                   f'<text x="{width}" y="-8" text-anchor="end">{"no damping" if what == "modes" else "general damping"}</text>'
                   f'<text x="{width}" y="{height + 26}" text-anchor="end">masses</text>')
        for power in range(-5, 3, 1):
            y = y_of(10.0**power)
            out.append(f'<path d="M0 {y:.1f}H{width}" stroke="#ddd"/><text x="-4" y="{y + 3:.1f}" text-anchor="end">1e{power} s</text>')
        for n in [2, 10, 100, 1000, 2000]:
            if n != 1000:
                out.append(f'<text x="{x_of(n):.1f}" y="{height + 14}" text-anchor="middle">{n}</text>')
        names = ["vibc"] + [name for name, _, _ in PEERS[what]]
        for index, name in enumerate(names):
            own = [(n, *found) for (w, kind, n, tool), found in results.items()
                   if w == what and tool == name and kind == damping]
            points = [(n, seconds) for n, seconds, _ in own]
            errors = [error for *_, error in own if not math.isnan(error)]
            off = f", error {'≤ ' if name == 'vibc' else ''}{f'{max(errors):.0e}' if max(errors) else 0}" if errors else ""
            path = " ".join(f"{'ML'[i > 0]}{x_of(n):.1f} {y_of(s):.1f}" for i, (n, s) in enumerate(sorted(points)))
            wide = 2.4 if name == "vibc" else 1.2
            if path:
                out.append(f'<path d="{path}" fill="none" stroke="{COLOURS[index]}" stroke-width="{wide}"/>')
            out.append(f'<text x="6" y="{12 + 12 * index}" fill="{COLOURS[index]}">{name}{off}</text>')
        out.append("</g>")
    return "\n".join([*out, "</svg>", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)))
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "vibc"))
    parser.add_argument("--svg", help="write a picture of time over size")
    options = parser.parse_args()
    print(f"numpy {numpy.__version__}, scipy {scipy.__version__}, python-control {control.__version__}, "
          f"sympy {sympy.__version__}, exudyn {exudyn.config.Version()}\n")
    print("| quantity | damping | n | tool | ms | of vibc's time | error |\n| --- | --- | --- | --- | --- | --- | --- |")
    results = {}
    with tempfile.TemporaryDirectory() as folder:
        for n in map(int, options.sizes.split(",")):
            for kind in KINDS:
                network = Network(n, kind)
                path = str(pathlib.Path(folder) / "network.vib")
                pathlib.Path(path).write_text(network.text)
                grid = numpy.geomspace(0.01, 0.5, FREQUENCIES)
                for what, peers in PEERS.items():
                    if what == "modes" and kind != "undamped":
                        continue
                    measure(options.program, what, peers, network, path, grid, results)
    if options.svg:
        pathlib.Path(options.svg).write_text(picture(results))


def measure(program, what, peers, network, path, grid, results):
    """Prints a row for each tool."""

    def row(name, seconds, ratio, error):
        results[what, network.kind, network.n, name] = (seconds, error)
        print(f"| {what} | {network.kind} | {network.n} | {name} | {seconds * 1e3:.3g} | {ratio} | {error:.0e} |", flush=True)

    reference, own = None, None
    if network.n <= VIBC_LIMITS[what]:
        try:
            reference, bound, own = by_vibc(program, what, path, network, grid)
            row("vibc", own, "1", bound)
        except Exception as reason:
            print(f"| {what} | {network.kind} | {network.n} | vibc | | | {str(reason)[:60]} |", flush=True)
    for name, limit, function in peers:
        if network.n > LIMITS.get(limit, max(SIZES)):
            continue
        try:
            found, seconds = timed(function, network, grid)
        except Exception as reason:
            print(f"| {what} | {network.kind} | {network.n} | {name} | | | fails: {str(reason)[:50]} |", flush=True)
            continue
        row(name, seconds, f"{seconds / own:.2g}" if own else "", error(what, found, reference))


if __name__ == "__main__":
    sys.exit(main())
