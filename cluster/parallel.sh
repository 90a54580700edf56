#!/usr/bin/env bash
# A sweep in parts by GNU parallel, on this machine or on several:
#
#     cluster/parallel.sh all.csv 64 cart.vib --over k=5N/m..50N/m:1000000 --modes 2
#     SSH=a,b,c cluster/parallel.sh ...     # machines that have vibc and this folder
#
# vibc uses all cores of a machine, so each has one part at a time. A part whose process ends is begun again, up to five times,
# and goes on from the rows that it has; so does the whole when this is started again.
set -euo pipefail
out=$1 count=$2
shift 2
mkdir -p "$out.parts"
logins=()
[ -z "${SSH:-}" ] || logins=(--sshlogin "$SSH" --workdir .)
seq 0 $((count - 1)) | parallel --quote "${logins[@]}" --jobs "${JOBS:-1}" --retries 5 --halt soon,fail=1 \
  vibc sweep "$@" --format csv --shard "{}/$count" -o "$out.parts/{}.csv"
seq -f "$out.parts/%.0f.csv" 0 $((count - 1)) | xargs -d '\n' vibc merge -o "$out"
