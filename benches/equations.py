"""Equations of motion in symbols beside SymPy's `LagrangesMethod`, in one run: hanging chains of point masses, the cart, and how time grows.

`python benches/equations.py --program target/release/vibc` prints a table. The program's time is that of a whole process, which reads the model,
checks it, lowers it, derives and compares everything and writes the text; beside it what is left of that without a process that only checks.
SymPy's is that of the energies and `form_lagranges_equations` alone, without linearising, and beside it the whole process with its import. Like is
to be compared with like: process with process, and inside running processes: SymPy's in this one, ours from the text of the model to the text of the
equations in `cargo bench --bench equations`, whose binary is named with `--inside`. The fastest of several runs. Needs sympy.
"""

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time

import sympy
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols


def chain(links):
    """A chain of point masses that hangs from the ground."""
    rows = ["model chain", "param m = 1 kg", "param L = 1 m", "gravity 9.81 m/s^2"]
    for i in range(1, links + 1):
        carrier = "ground" if i == 1 else f"b{i - 1}"
        rows.append(f"body b{i} {{ mass = m, inertia = 0 kg*m^2, at = (0, -{i} * L) }}")
        rows.append(f"pivot p{i}: {carrier}@(0, -{i - 1} * L) -- b{i}")
    return "\n".join(rows) + "\n"


def by_sympy(links):
    """Seconds of processor time for the same equations."""
    m, L, g = sympy.symbols("m L g")
    q = dynamicsymbols(f"q:{links}")
    t = dynamicsymbols._t
    started = time.process_time()
    x = y = T = V = sympy.Integer(0)
    for angle in q:
        x, y = x + L * sympy.sin(angle), y - L * sympy.cos(angle)
        T += m * (x.diff(t) ** 2 + y.diff(t) ** 2) / 2
        V += m * g * y
    LagrangesMethod(T - V, q).form_lagranges_equations()
    return time.process_time() - started


def by_program(program, command, model, runs):
    """Seconds of processor time of the fastest process."""
    return by_process([program, command, model], runs)


def by_process(words, runs):
    """Seconds of processor time of the fastest process."""
    fastest = math.inf
    for _ in range(runs):
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = status
        assert status == 0, f"{words}: {status}"
        fastest = min(fastest, used.ru_utime + used.ru_stime)
    return fastest


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--program", default="target/release/vibc")
    words.add_argument("--links", type=int, default=10)
    words.add_argument("--inside", help="the binary of the benchmark `equations`: times inside a running process")
    words.add_argument("--sympy-alone", type=int, help=argparse.SUPPRESS)
    options = words.parse_args()
    if options.sympy_alone:
        by_sympy(options.sympy_alone)
        return
    here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    with tempfile.TemporaryDirectory() as folder:
        def model(links):
            place = os.path.join(folder, f"chain{links}.vib")
            with open(place, "w", encoding="utf-8") as file:
                file.write(chain(links))
            return place

        inside = {}
        if options.inside:
            run = subprocess.run([options.inside, "--bench"], capture_output=True, text=True, check=True)
            inside = {int(links): float(time) for links, time in map(str.split, run.stdout.splitlines())}
        print("| links | SymPy's process [s] | vibc's [ms] | ratio | SymPy inside [s] | vibc inside [ms] | ratio |")
        print("| --- | --- | --- | --- | --- | --- | --- |")
        for links in range(1, options.links + 1):
            repeats = 2 if links < 6 else 1
            theirs = min(by_sympy(links) for _ in range(repeats))
            process = by_process([sys.executable, os.path.abspath(__file__), "--sympy-alone", str(links)], repeats)
            own = by_program(options.program, "equations", model(links), 60)
            derived = inside.get(links, math.nan) * 1e-6
            whole = f"{process:.2f} | {1e3 * own:.2f} | {process / own:.0f}"
            print(f"| {links} | {whole} | {theirs:.3f} | {1e3 * derived:.2f} | {theirs / derived:.0f} |", flush=True)
        nothing = by_process(["/bin/true"], 200)
        print(f"\na process that does nothing: {1e3 * nothing:.2f} ms")
        cart = os.path.join(here, "examples", "cart.vib")
        check, equations = (by_program(options.program, command, cart, 200) for command in ("check", "equations"))
        print(f"\ncart: check {1e3 * check:.2f} ms, equations {1e3 * equations:.2f} ms: {(equations - check) / check:+.0%} of check")
        print("\n| links | vibc [ms] | power |\n| --- | --- | --- |")
        before = None
        for links in (5, 10, 20, 40):
            own = by_program(options.program, "equations", model(links), 3)
            power = f"{math.log(own / before) / math.log(2):.1f}" if before else ""
            print(f"| {links} | {1e3 * own:.1f} | {power} |", flush=True)
            before = own
        refused = subprocess.run([options.program, "equations", model(60)], capture_output=True, text=True, check=False)
        print("\n60 links: " + next(line for line in refused.stderr.splitlines() if "products" in line).strip())


main()
