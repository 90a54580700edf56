#!/usr/bin/env bash
#SBATCH --job-name=vibc
#SBATCH --requeue
#SBATCH --open-mode=append
# A sweep in parts as a Slurm job array, and a job that merges them when all are there:
#
#     cluster/slurm.sh all.csv 64 cart.vib --over k=5N/m..50N/m:1000000 --modes 2
#
# Options of sbatch (partition, time, cores) stand in SBATCH, as in SBATCH='--time=10 --cpus-per-task=8'. A task whose node is
# lost is queued again and goes on from the rows that it has. Started again, this computes what is missing only. Slurm's
# usual limit is 1001 tasks an array.
set -euo pipefail
out=$1 count=$2
shift 2
parts="$out.parts"
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
  # With the count written out, `sbatch --array=17` may compute one part alone.
  exec vibc sweep "$@" --format csv --shard "$SLURM_ARRAY_TASK_ID/$count" -o "$parts/$SLURM_ARRAY_TASK_ID.csv"
fi
mkdir -p "$parts"
read -ra asked <<<"${SBATCH:-}"
array=$(sbatch --parsable "${asked[@]}" --array="0-$((count - 1))" --output="$parts/%a.log" "$0" "$out" "$count" "$@")
merge=$(printf '%q ' vibc merge -o "$out")$(printf "$(printf '%q' "$parts")/%s.csv " $(seq 0 $((count - 1))))
sbatch --parsable "${asked[@]}" --dependency="afterok:${array%%;*}" --kill-on-invalid-dep=yes --output="$parts/merge.log" --wrap "$merge"
