"""Tables of `vibc transfer --range` that hold few of many poles, in chains of pieces of 77 masses each: as the pieces are alike, so are many
of their frequencies.

    cargo build --release && python3 benches/range.py [PROGRAM]

Prints, for each number of masses, the processor time of the whole program (the median of three), the extrema in the range, the largest bound
of their gains, and whether it is proved that there are no others.
"""

import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIBC = pathlib.Path(sys.argv[1]).resolve() if sys.argv[1:] else ROOT / "target" / "release" / "vibc"
REPEATS = 3


def chain(n):
    rows = ["model chain"]
    for i in range(n):
        before = f"b{i - 1}" if i else "ground"
        rows.append(f"body b{i} {{ mass = {1 + i % 7 / 8} kg, moves x }}")
        rows.append(f"spring s{i}: {before} -- b{i} {{ k = {90 + 7 * (i % 11)} N/m }}")
        rows.append(f"damper d{i}: {before} -- b{i} {{ c = {(1 + i % 3) / 1000} N*s/m }}")
    rows += [f"force F: b{n // 2} along x", "output x = b0.x"]
    return "\n".join(rows) + "\n"


def run(folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [VIBC, "transfer", "chain.vib", "--range", "0.001Hz..0.045Hz", "--format", "json"]
    out = subprocess.run(command, cwd=folder, check=True, capture_output=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, json.loads(out)["pairs"][0]


def main():
    print("| masses | time [s] | extrema | largest bound | complete |")
    print("| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for n in (160, 300, 400, 1000, 1001, 2000, 4000):
            pathlib.Path(folder, "chain.vib").write_text(chain(n))
            runs = [run(folder) for _ in range(REPEATS)]
            found = runs[0][1]
            bound = max((row["gain_error_bound"] for row in found["extrema"]), default=0.0)
            complete = "yes" if found["complete"] else "no"
            time = statistics.median(seconds for seconds, _ in runs)
            print(f"| {n} | {time:.2f} | {len(found['extrema'])} | {bound:.0e} | {complete} |", flush=True)


main()
