"""A study of a million cases of ten coordinates, all frequencies with bounds, in parts by two workers of Dask on this machine, each with a core
of its own: cases a second, bytes, the time of the merge, and what a thousand times as many cases would take.

    python3 -m venv target/cluster && target/cluster/bin/pip install --requirement cluster/requirements.txt
    cargo build --release && target/cluster/bin/python benches/study.py [--quick] [PROGRAM]

The parts are those of `cluster/dask_sweep.py`. Times are times on the wall. The bytes are compared with those of one run. The last rows are an
extrapolation, not a measurement: proportional to the number of cases, without waiting for machines or for a common file system.
"""

import filecmp
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from distributed import Client, LocalCluster

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "cluster"))

import dask_sweep

GIVEN = [word for word in sys.argv[1:] if not word.startswith("--")]
VIBC = pathlib.Path(GIVEN[0]).resolve() if GIVEN else ROOT / "target" / "release" / "vibc"
CASES = 50_000 if "--quick" in sys.argv else 1_000_000
PARTS, WORKERS, COORDINATES = 16, 2, 10
MORE, THEIR_CORES = 1_000_000_000, 1_000


def model():
    rows = ["model chain", "param k = 100 N/m"]
    for i in range(COORDINATES):
        before = f"b{i - 1}" if i else "ground"
        stiffness = "k" if i == COORDINATES - 1 else f"{90 + 7 * i} N/m"
        rows += [f"body b{i} {{ mass = {(8 + i) / 8} kg, moves x }}", f"spring s{i}: {before} -- b{i} {{ k = {stiffness} }}"]
    return "\n".join(rows) + "\n"


def main():
    study = ["chain.vib", "--over", f"k=50N/m..150N/m:{CASES}", "--modes", str(COORDINATES)]
    cores = sorted(os.sched_getaffinity(0))
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("bin").mkdir()
        pathlib.Path("bin", "vibc").symlink_to(VIBC)
        os.environ["PATH"] = f"{folder}/bin:{os.environ['PATH']}"
        pathlib.Path("chain.vib").write_text(model())
        with LocalCluster(n_workers=WORKERS, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster, Client(cluster) as client:
            for place, worker in enumerate(client.scheduler_info()["workers"]):
                client.run(os.sched_setaffinity, 0, [cores[place % len(cores)]], workers=[worker])
            client.upload_file(dask_sweep.__file__)
            begun = time.perf_counter()
            dask_sweep.sweep(client, "all.csv", PARTS, study)
            both = time.perf_counter() - begun
        parts = [f"all.csv.parts/{index}.csv" for index in range(PARTS)]
        begun = time.perf_counter()
        subprocess.run(["vibc", "merge", "-o", "again.csv", *parts], check=True)
        merge = time.perf_counter() - begun
        subprocess.run(["vibc", "sweep", *study, "--format", "csv", "-o", "one.csv"], check=True)
        for name in ("again.csv", "one.csv"):
            if not filecmp.cmp("all.csv", name, shallow=False):
                raise SystemExit(f"all.csv and {name} differ")
        size = pathlib.Path("all.csv").stat().st_size
    compute = both - merge
    print(f"| {CASES:.0e} cases of {COORDINATES} coordinates, {PARTS} parts, {WORKERS} workers with {min(WORKERS, len(cores))} cores | |")
    print("| --- | --- |")
    print(f"| parts | {compute:.2f} s: {CASES / compute:.3g} cases a second |")
    print(f"| merge | {merge:.2f} s: {CASES / merge:.3g} cases a second |")
    print(f"| file | {size / 1e6:.0f} MB: {size / CASES:.0f} bytes a case; the bytes of one run |")
    times, share = MORE / CASES, min(WORKERS, len(cores)) / THEIR_CORES
    print(f"| extrapolated to {MORE:.0e} cases on {THEIR_CORES} cores: parts | {compute * times * share:.0f} s |")
    print(f"| extrapolated: merge, one process | {merge * times / 60:.0f} minutes |")
    print(f"| extrapolated: bytes | {size * times / 1e9:.0f} GB |")


if __name__ == "__main__":
    main()
