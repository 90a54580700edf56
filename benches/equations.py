"""Equations of motion in symbols beside SymPy's `LagrangesMethod`, in one run: hanging chains of point masses, the cart, and how time grows.

`python benches/equations.py --program target/release/vibc` prints a table. The program's time is that of a whole process, which reads the model,
checks it, lowers it, derives and compares everything and writes the text; beside it what is left of that without a process that only checks.
SymPy's is that of the energies and `form_lagranges_equations` alone: no import, no linearising. Processor time of the fastest of several runs.
Needs sympy.
"""

import argparse
import math
import os
import subprocess
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
    fastest = math.inf
    for _ in range(runs):
        process = subprocess.Popen([program, command, model], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = status
        assert status == 0, f"{command} {model}: {status}"
        fastest = min(fastest, used.ru_utime + used.ru_stime)
    return fastest


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--program", default="target/release/vibc")
    words.add_argument("--links", type=int, default=10)
    options = words.parse_args()
    here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    with tempfile.TemporaryDirectory() as folder:
        def model(links):
            place = os.path.join(folder, f"chain{links}.vib")
            with open(place, "w", encoding="utf-8") as file:
                file.write(chain(links))
            return place

        print("| links | SymPy [s] | vibc, whole process [ms] | ratio | less `vibc check` [ms] | ratio |\n| --- | --- | --- | --- | --- | --- |")
        for links in range(1, options.links + 1):
            theirs = min(by_sympy(links) for _ in range(2 if links < 6 else 1))
            check, own = (by_program(options.program, command, model(links), 60) for command in ("check", "equations"))
            derived = own - check
            print(f"| {links} | {theirs:.3f} | {1e3 * own:.2f} | {theirs / own:.0f} | {1e3 * derived:.2f} | {theirs / derived:.0f} |", flush=True)
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
