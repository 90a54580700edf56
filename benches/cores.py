"""One core beside two: times on the wall of analyses of random networks from 100 masses on, and whether both give the same bytes.

    cargo build --release && python3 benches/cores.py [PROGRAM]

Runs take turns; each time is the least of three, the run in which others had the least part. The last column is what the machine gives: how
many times the work of one program two of them do at once, each on a core of its own. Other bytes end the program with status 1.
"""

import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIBC = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT / "target" / "release" / "vibc"
CORES = sorted(os.sched_getaffinity(0))[:2]
RUNS = 3


def network(n, is_damped):
    """Masses, each on springs (and dampers that are in no proportion to them) to up to three before it."""
    chance = random.Random(n)
    rows, pairs = ["model network"], [("ground", 0)]
    for i in range(n):
        rows.append(f"body m{i} {{ mass = {chance.randint(100, 200) / 100} kg, moves x }}")
        before = {i - 1, max(0, i - 2), chance.randrange(i)} if i else set()
        pairs += [(f"m{j}", i) for j in sorted(before)]
    for number, (a, b) in enumerate(pairs):
        rows.append(f"spring s{number}: {a} -- m{b} {{ k = {chance.randint(100, 300)} N/m }}")
        if is_damped:
            rows.append(f"damper d{number}: {a} -- m{b} {{ c = {chance.randint(10, 100) / 1000} N*s/m }}")
    return "\n".join([*rows, "force F: m0 along x = step(1 N, 0 s)", f"output y = m{n - 1}.x", ""])


def started(folder, arguments, cores):
    return subprocess.Popen([VIBC, *arguments], cwd=folder, stdout=subprocess.PIPE, preexec_fn=lambda: os.sched_setaffinity(0, cores))


def timed(programs):
    """What programs that are started together write, and the seconds until all have ended."""
    begun = time.perf_counter()
    texts = [program.communicate()[0] for program in programs()]
    return texts, time.perf_counter() - begun


def main():
    if len(CORES) < 2:
        raise SystemExit("there is one core only")
    print("| n | damped | command | one core [s] | two [s] | times | two programs: times |\n| --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for n in (100, 200, 500, 1000):
            for is_damped in (False, True):
                pathlib.Path(folder, "model.vib").write_text(network(n, is_damped))
                for command in (["analyze", "--modes", str(n)], ["transfer"], ["simulate", "--step", "0.01s", "--until", "10s"]):
                    arguments = [command[0], "model.vib", *command[1:]]
                    rows = []
                    for _ in range(RUNS):
                        (one,), alone = timed(lambda: [started(folder, arguments, CORES[:1])])
                        (two,), both = timed(lambda: [started(folder, arguments, CORES)])
                        if one != two or not one:
                            raise SystemExit(f"{' '.join(arguments)}: nothing, or other bytes on two cores")
                        _, pair = timed(lambda: [started(folder, arguments, [core]) for core in CORES])
                        rows.append((alone, both, pair))
                    alone, both, pair = map(min, zip(*rows))
                    print(f"| {n} | {'yes' if is_damped else 'no'} | {' '.join(command)} | {alone:.3f} | {both:.3f} | {alone / both:.2f} | {2 * alone / pair:.2f} |", flush=True)


main()
