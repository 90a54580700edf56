"""Ranges of `vibc analyze --tolerances` beside what corners and samples reach: how wide they are, and whether a value lies outside.

    cargo build --release
    python benches/tolerances.py --scenes 300 --samples 10000      # generated scenes beside NumPy, some minutes
    python benches/tolerances.py --hanging --scenes 100            # rods under gravity, whose rest the parameters move
    python benches/tolerances.py --examples                        # the project's examples beside `vibc sweep`

Generated scenes are damped nets of one to four bodies whose masses, springs and dampers are functions of two to four parameters; the
frequencies, damping ratios, poles and measures of all samples of a scene are computed by NumPy side by side. The examples get a
tolerance for each parameter that has a unit.
"""

import argparse
import csv
import itertools
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile
from collections import defaultdict

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
# What NumPy's eigenvalues of these small matrices are off by at most, relative to the size of the number: of a pole, not of its real part.
ROUNDING = 1e-9


def size_of(name, values):
    """What the rounding of a quantity is relative to."""
    if name == "damping" or name.startswith("ratio"):
        return 1.0
    pole = [values[f"{part} {name.split()[1]}"] for part in ("re", "im")] if name.startswith("re ") else [values[name]]
    return max(np.abs(part).max() for part in pole)


def analyze(program, model):
    ran = subprocess.run([program, "analyze", str(model), "--tolerances", "--format", "json"], capture_output=True, text=True)
    try:
        return json.loads(ran.stdout).get("tolerances")
    except json.JSONDecodeError:
        return None


def damped(k, c):
    """The poles of q'' + c q' + k q = 0 of all samples and their damping ratios, if all of them oscillate."""
    count, n, _ = k.shape
    zero, one = np.zeros_like(k), np.broadcast_to(np.eye(n), k.shape)
    poles = np.linalg.eigvals(np.concatenate([np.concatenate([zero, one], 2), np.concatenate([-k, -c], 2)], 1))
    if not (np.abs(poles.imag) > 1e-6 * np.abs(poles)).all():
        return {}
    upper = poles[poles.imag > 0].reshape(count, n)
    upper = np.take_along_axis(upper, np.argsort(np.abs(upper), 1), 1)
    found = {}
    for i in range(n):
        found[f"ratio {i}"] = -upper[:, i].real / np.abs(upper[:, i])
        found[f"re {i}"], found[f"im {i}"] = upper[:, i].real, upper[:, i].imag
    return found | {"damping": found["ratio 0"]}


class Scene:
    """A damped net: text, ranges, and functions of arrays of parameters."""

    def __init__(self, rng):
        self.names, self.low, self.high, rows = [], [], [], []
        self.kinds = defaultdict(list)
        for kind, unit, (least, most) in (("m", "kg", (0.5, 5)), ("k", "N/m", (20, 400)), ("c", "N*s/m", (0.3, 6))):
            for i in range(rng.choice((1, 1, 2) if kind == "k" else (0, 1, 1))):
                name, value, share = f"{kind}{i}", float(f"{rng.uniform(least, most):.3g}"), rng.choice((1, 3, 5, 10))
                rows.append(f"param {name} = {value!r} {unit} within {share} %")
                self.kinds[kind].append(len(self.names))
                self.names.append(name)
                self.low.append(value * (1 - share / 100))
                self.high.append(value * (1 + share / 100))
        self.n = n = rng.choice((1, 2, 2, 3, 4))
        weight = lambda kind, unit, size: self.weight(rng, kind, unit, size)
        self.masses = [weight("m", "kg", 2) for _ in range(n)]
        links = [(-1, 0)] + [(rng.randrange(i), i) for i in range(1, n)] + [(-1, rng.randrange(n))] * rng.choice((0, 1))
        self.springs = [(a, b, weight("k", "N/m", 100)) for a, b in links]
        self.dampers = [(a, b, weight("c", "N*s/m", 2)) for a, b in links if rng.random() < 0.7 or (a, b) == (-1, 0)]
        end = lambda a: "ground" if a < 0 else f"b{a}"
        rows += [f"body b{i} {{ mass = {m[0]}, moves x }}" for i, m in enumerate(self.masses)]
        rows += [f"spring s{i}: {end(a)} -- {end(b)} {{ k = {k[0]} }}" for i, (a, b, k) in enumerate(self.springs)]
        rows += [f"damper d{i}: {end(a)} -- {end(b)} {{ c = {c[0]} }}" for i, (a, b, c) in enumerate(self.dampers)]
        self.hertz = float(f"{rng.uniform(0.2, 2):.2g}")
        self.out = rng.randrange(n)
        rows += [f"force F: b0 along x = step(1 N, 0 s)", f"force G: b0 along x = harmonic(1 N, {self.hertz} Hz)", f"output y = b{self.out}.x"]
        self.measures = {
            "damping": "damping(1) < 1e9 %", "gain": f"gain(F -> y, {self.hertz} Hz) < 1e9 m/N", "amplitude": "amplitude(y) < 1e9 m",
            "static": "static(y) < 1e9 m", "phase": f"phase(F -> y, {self.hertz} Hz) < 360 deg", "peak_gain": "peak_gain(F -> y) < 1e9 m/N",
        }
        self.text = "\n".join(rows + [f"require {line}" for line in self.measures.values()]) + "\n"

    def weight(self, rng, kind, unit, size):
        own = self.kinds[kind]
        if not own or rng.random() < 0.25:
            value = float(f"{size * rng.uniform(0.3, 2):.3g}")
            return f"{value!r} {unit}", lambda p: np.full(len(p), value)
        i, j = rng.choice(own), rng.choice(own)
        a, b = self.names[i], self.names[j]
        return rng.choice((
            (f"{a}", lambda p: p[:, i]), (f"{a} + {b}", lambda p: p[:, i] + p[:, j]), (f"2 * {a}", lambda p: 2 * p[:, i]),
            (f"{a}^2 / {b}", lambda p: p[:, i] ** 2 / p[:, j]), (f"3 * {a} - {b}", lambda p: 3 * p[:, i] - p[:, j]),
        ))

    def matrices(self, p):
        n, count = self.n, len(p)
        m, c, k = (np.zeros((count, n, n)) for _ in range(3))
        for i, (_, of) in enumerate(self.masses):
            m[:, i, i] += of(p)
        for matrix, links in ((k, self.springs), (c, self.dampers)):
            for a, b, (_, of) in links:
                for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                    if i >= 0 and j >= 0:
                        matrix[:, i, j] += sign * of(p)
        return m, c, k

    def samples(self, count, rng):
        low, high = np.array(self.low), np.array(self.high)
        corners = np.array(list(itertools.product(*zip(low, high))))
        return np.concatenate([corners, low + (high - low) * rng.random((count, len(low)))])

    def response(self, matrices, hertz):
        m, c, k = matrices
        omega = np.reshape(2 * np.pi * hertz, (-1, 1, 1))
        force = np.zeros((len(m), self.n, 1))
        force[:, 0] = 1
        try:
            return np.linalg.solve(k - omega**2 * m + 1j * omega * c, force)[:, self.out, 0]
        except np.linalg.LinAlgError:
            # A branch that the force does not move and nothing damps, at its own frequency: beside it there is the same value.
            return self.response(matrices, hertz * (1 + 1e-9))

    def values(self, p):
        """Of each quantity the values at all samples; least and largest of what is only known to lie between two numbers."""
        m, c, k = matrices = self.matrices(p)
        root = 1 / np.sqrt(np.einsum("sii->si", m))
        squares = np.linalg.eigvalsh(k * root[:, :, None] * root[:, None, :])
        found = {f"frequency {i}": np.sqrt(squares[:, i]) / (2 * np.pi) for i in range(self.n)}
        inverse = root[:, :, None] ** 2
        found |= damped(inverse * k, inverse * c)
        h = self.response(matrices, self.hertz)
        found["gain"] = found["amplitude"] = np.abs(h)
        found["phase"] = np.angle(h)
        found["static"] = self.response(matrices, 0).real
        few = slice(0, 2 ** len(self.names) + 100)
        few_matrices = tuple(x[few] for x in matrices)
        top = np.zeros(len(few_matrices[0]))
        around = 1 + 0.1 * np.linspace(-1, 1, 161) ** 3
        for i, share in [(self.n - 1, share) for share in np.linspace(0, 1.3, 300)] + [(i, share) for i in range(self.n) for share in around]:
            top = np.maximum(top, np.abs(self.response(few_matrices, share * found[f"frequency {i}"][few])))
        found["peak_gain"] = top
        return found


class Hanging(Scene):
    """Rods one on another under gravity, held by torsion springs so stiff that there is one rest: it moves with masses, lengths and springs."""

    def __init__(self, rng):
        self.names, self.low, self.high, rows = [], [], [], ["gravity 9.81 m/s^2", "point P0 = (0 m, 0 m)"]
        self.n = n = rng.choice((1, 1, 2, 2, 3))
        self.out, self.hertz, inertia = rng.randrange(n), float(f"{rng.uniform(0.1, 1):.2g}"), 0.05
        shares = (1, 3) if n > 1 else (1, 3, 5, 10)

        def number(name, value, unit):
            value = float(f"{value:.3g}")
            if rng.random() < 0.5 and len(self.names) < 4 or name == "k0":
                share, place = rng.choice(shares), len(self.names)
                rows.append(f"param {name} = {value!r} {unit} within {share} %")
                self.names.append(name)
                self.low.append(value * (1 - share / 100))
                self.high.append(value * (1 + share / 100))
                return name, lambda p: p[:, place]
            return f"{value!r} {unit}", lambda p: np.full(len(p), value)

        masses = [number(f"m{i}", rng.uniform(0.5, 3), "kg") for i in range(n)]
        lengths = [number(f"l{i}", rng.uniform(0.3, 1.5), "m") for i in range(n)]
        # Every torque of the weights turns by less than the springs hold, wherever the rods are.
        springs = [number(f"k{i}", rng.uniform(1.5, 5) * 9.81 * 3 * n * 1.5 * 2, "N*m/rad") for i in range(n)]
        dampers = [number(f"c{i}", rng.uniform(0.5, 5), "N*m*s/rad") for i in range(n)]
        turns = [rng.uniform(-1.5, 1.5) for _ in range(n)]
        self.ways = [(float(f"{np.cos(turn):.3f}"), float(f"{np.sin(turn):.3f}")) for turn in turns]
        self.of = [[of for _, of in kind] for kind in (masses, lengths, springs, dampers)]
        self.inertia = inertia
        before = lambda i: f"b{i - 1}" if i else "ground"
        for i, (x, y) in enumerate(self.ways):
            rows.append(f"point P{i + 1} = P{i} + {lengths[i][0]} * ({x!r}, {y!r})")
        for i in range(n):
            rows.append(f"body b{i} {{ mass = {masses[i][0]}, inertia = {inertia} kg*m^2, at = P{i + 1} }}")
            rows.append(f"pivot p{i}: {before(i)}@P{i} -- b{i}@P{i}")
            rows.append(f"spring s{i}: {before(i)} -- b{i} {{ k = {springs[i][0]} }}")
            rows.append(f"damper d{i}: {before(i)} -- b{i} {{ c = {dampers[i][0]} }}")
        rows += ["torque F: b0 = step(1 N*m, 0 s)", f"output y = b{self.out}.angle"]
        self.measures = {
            "damping": "damping(1) < 1e9 %", "gain": f"gain(F -> y, {self.hertz} Hz) < 1e9 rad/N/m", "static": "static(y) < 1e9 rad",
            "rest": f"rest(b{n - 1}.angle) < 10 rad",
        }
        self.text = "\n".join(rows + [f"require {line}" for line in self.measures.values()]) + "\n"

    def matrices(self, p):
        n, count = self.n, len(p)
        mass, length, spring, damper = (np.stack([of(p) for of in kind], 1) for kind in self.of)
        drawn = length[:, :, None] * np.array(self.ways)[None]
        above = np.flip(np.cumsum(np.flip(mass, 1), 1), 1)
        joined = lambda weights: sum(
            weights[:, i, None, None] * (row := np.eye(n)[i] - (np.eye(n)[i - 1] if i else 0))[:, None] * row for i in range(n)
        )
        stiffness = joined(spring)
        turn = np.zeros((count, n))
        for _ in range(60):
            x = np.cos(turn) * drawn[:, :, 0] - np.sin(turn) * drawn[:, :, 1]
            y = np.sin(turn) * drawn[:, :, 0] + np.cos(turn) * drawn[:, :, 1]
            force = 9.81 * above * x + np.einsum("sij,sj->si", stiffness, turn)
            k = stiffness - (9.81 * above * y)[:, :, None] * np.eye(n)
            turn = turn - np.linalg.solve(k, force[:, :, None])[:, :, 0]
        assert np.abs(force).max() < 1e-9
        self.rest = turn
        both = above[:, np.maximum.outer(np.arange(n), np.arange(n))]
        m = both * (x[:, :, None] * x[:, None] + y[:, :, None] * y[:, None]) + self.inertia * np.eye(n)
        return m, joined(damper), k

    def values(self, p):
        m, c, k = matrices = self.matrices(p)
        found = {"rest": self.rest[:, -1]}
        lower = np.linalg.inv(np.linalg.cholesky(m))
        squares = np.linalg.eigvalsh(lower @ k @ lower.transpose(0, 2, 1))
        found |= {f"frequency {i}": np.sqrt(squares[:, i]) / (2 * np.pi) for i in range(self.n)}
        found["gain"] = np.abs(self.response(matrices, self.hertz))
        found["static"] = self.response(matrices, 0).real
        inverse = np.linalg.inv(m)
        found |= damped(inverse @ k, inverse @ c)
        return found


def told_ranges(scene, told):
    ranges = {f"frequency {row['mode'] - 1}": (row["least_hz"], row["largest_hz"], row["proved"], row["reached_hz"]) for row in told["frequencies"]}
    ends = lambda row: (row["least"], row["largest"], row["proved"], row["reached"])
    ranges |= {f"ratio {row['motion'] - 1}": ends(row) for row in told["damping_ratios"]}
    for row in told["poles"]:
        ranges[f"re {row['pole'] - 1}"], ranges[f"im {row['pole'] - 1}"] = ends(row["re"]), ends(row["im"])
    for name, row in zip(scene.measures, told["requirements"]):
        if row["values"]:
            ranges[name] = ends(row["values"])
    return ranges


def generated(program, scenes, samples, seed, kind):
    rng, numbers = random.Random(seed), np.random.default_rng(seed)
    rows, outside = defaultdict(list), 0
    kinds = lambda name: name.split()[0]
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.vib"
        for number in range(scenes):
            scene = kind(rng)
            if not scene.names:
                continue
            path.write_text(scene.text)
            told = analyze(program, path)
            if told is None:
                print(f"scene {number}: no answer", file=sys.stderr)
                continue
            values = scene.values(scene.samples(samples, numbers))
            for name, (least, largest, proved, reached) in told_ranges(scene, told).items():
                if least is None or name not in values:
                    rows[kinds(name)].append((None, False, False))
                    continue
                low, high = values[name].min(), values[name].max()
                off = ROUNDING * size_of(name, values)
                # The grid of frequencies finds a peak to some parts in 1e4, from below.
                short = 2e-3 * high if name == "peak_gain" else off
                if proved and (low + short < least or high - off > largest):
                    outside += 1
                    print(f"scene {number}: {name}: {low!r} .. {high!r} outside of {least!r} .. {largest!r}\n{scene.text}", file=sys.stderr)
                width = max(high, reached[1]) - min(low, reached[0])
                size = max(abs(low), abs(high))
                ratio = max(largest - least - 1e-6 * size, width) / width if width > 1e-9 * size else 1.0
                rows[kinds(name)].append((ratio, proved, [least, largest] == reached))
    print("| quantity | ranges | proved | both ends reached | width / w: median | 95 % | largest | within 1.5 w |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    for kind, found in rows.items():
        ratios = np.array([ratio for ratio, proved, _ in found if proved])
        share = lambda of: f"{100 * sum(map(bool, of)) / len(found):.0f} %"
        told = f"{np.median(ratios):.3f} | {np.quantile(ratios, 0.95):.3f} | {ratios.max():.3f} | {100 * np.mean(ratios <= 1.5 + 1e-3):.0f} %" if len(ratios) else "| | |"
        print(f"| {kind} | {len(found)} | {share([p for _, p, _ in found])} | {share([r for _, _, r in found])} | {told} |")
    print(f"\n{outside} values outside of a proved range")
    return outside


def examples(program, samples, share):
    print("| example | parameters | measure | told | w | width / w |\n| --- | --- | --- | --- | --- | --- |")
    for path in sorted((ROOT / "examples").glob("*.vib")):
        text = path.read_text()
        if not re.search(r"^require", text, re.M):
            continue
        with_share = lambda match: f"{match[1]} within {share} %{match[2]}"
        text = re.sub(r"^(param\s+\w+\s*=\s*[-0-9.e]+ [A-Za-z%*/^0-9]+)(\s*(?://.*)?)$", with_share, text, flags=re.M)
        with tempfile.TemporaryDirectory() as folder:
            model = pathlib.Path(folder) / path.name
            for other in path.parent.iterdir():
                if other.is_file():
                    (pathlib.Path(folder) / other.name).write_bytes(other.read_bytes())
            model.write_text(text)
            told = analyze(program, model)
            if not told:
                continue
            names, measures = [row["parameter"] for row in told["parameters"]], told["requirements"]
            swept = csv_of(program, model, ["--samples", str(samples)])
            for row in measures:
                values, measure = row["values"], re.split(r"\s*[<>]=?\s*", row["text"])
                if values is None or values["least"] is None:
                    print(f"| {path.stem} | {len(names)} | `{row['text']}` | {'-' if values is None else 'no value somewhere'} | | |")
                    continue
                seen = column_of(swept, measure)
                low, high = min(seen + [values["reached"][0]]), max(seen + [values["reached"][1]])
                kind = "reached alone" if not values["proved"] else "exact" if [values["least"], values["largest"]] == values["reached"] else "bounds"
                width = high - low
                ratio = f"{(values['largest'] - values['least']) / width:.3f}" if width > 0 else "-"
                print(f"| {path.stem} | {len(names)} | `{row['text']}` | {kind} | {width:.3g} | {ratio} |")


def csv_of(program, model, options):
    ran = subprocess.run([program, "sweep", str(model), *options, "--format", "csv"], capture_output=True, text=True)
    return list(csv.DictReader(ran.stdout.splitlines()))


def column_of(table, measure):
    """The values of a measure; none where they are not in SI units, so that what the program reached counts alone."""
    bare = [name for name in (table[0] if table else ()) if name in measure]
    return [float(row[name]) for name in bare for row in table if row[name] not in ("", "true", "false")]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "target/release/vibc"))
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--samples", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--hanging", action="store_true")
    parser.add_argument("--share", default="5", help="tolerance of each parameter of an example, percent")
    parser.add_argument("--examples", action="store_true")
    asked = parser.parse_args()
    if asked.examples:
        examples(asked.program, min(asked.samples, 2000), asked.share)
    else:
        sys.exit(generated(asked.program, asked.scenes, asked.samples, asked.seed, Hanging if asked.hanging else Scene) > 0)
