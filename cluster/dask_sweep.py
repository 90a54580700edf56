"""A sweep in parts by Dask's `distributed`, on the workers of a cluster that see this folder, or on two of this machine:

    pip install -r cluster/requirements.txt
    python cluster/dask_sweep.py [--scheduler tcp://HOST:8786] all.csv 64 cart.vib --over k=5N/m..50N/m:1000000 --modes 2

vibc uses all cores of a machine: start one worker on each, `dask worker tcp://HOST:8786 --nthreads 1`. The parts of a worker
that is lost go to the others, which go on from the rows that are there.
"""

import argparse
import pathlib
import subprocess
import time

from distributed import Client, LocalCluster, as_completed

# What vibc says about a part that another process is writing. A worker may be gone while the vibc that it had started goes on.
BUSY = "another run is writing it"


def computed(study, index, count, path):
    """Writes a part, in a worker; its path."""
    command = ["vibc", "sweep", *study, "--format", "csv", "--shard", f"{index}/{count}", "-o", path]
    while True:
        run = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if run.returncode == 0:
            return path
        if BUSY not in run.stderr:
            raise RuntimeError(f"part {index}: status {run.returncode}: {run.stderr.strip()}")
        time.sleep(1)


def sweep(client, out, count, study):
    """Computes all parts on the workers of a client, and merges them here."""
    # Workers may run in another folder.
    folder = pathlib.Path(f"{out}.parts").resolve()
    folder.mkdir(exist_ok=True)
    paths = [str(folder / f"{index}.csv") for index in range(count)]
    model = str(pathlib.Path(study[0]).resolve())
    parts = [client.submit(computed, [model, *study[1:]], index, count, path, pure=False, retries=5) for index, path in enumerate(paths)]
    for done in as_completed(parts):
        done.result()
    subprocess.run(["vibc", "merge", "-o", out, *paths], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scheduler", help="the address of a running scheduler")
    parser.add_argument("out", help="the file of all cases")
    parser.add_argument("parts", type=int)
    parser.add_argument("study", nargs=argparse.REMAINDER, metavar="MODEL OPTIONS", help="the arguments of `vibc sweep`: the model first")
    options = parser.parse_args()
    if options.scheduler:
        with Client(options.scheduler) as client:
            sweep(client, options.out, options.parts, options.study)
    else:
        with LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster, Client(cluster) as client:
            sweep(client, options.out, options.parts, options.study)


if __name__ == "__main__":
    main()
