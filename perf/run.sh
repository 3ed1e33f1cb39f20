#!/bin/sh
# The short run for CI: the micro-benchmarks for a moment each, the smallest rungs of the ladder, and the comparison and
# the ablation on one small mesh. It prints. Times on a shared machine are no reason to fail, a program that does not
# work is.
#   sh perf/run.sh BUILD_DIR
set -eu

[ $# -eq 1 ] || { sed -n '5s/^# \{0,1\}//p' "$0" >&2; exit 2; }
perf=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
for program in prcage_bench prcage_ladder; do
  [ -x "$1/$program" ] && continue
  echo "$1/$program is not there: configure with -DPRCAGE_BUILD_PERF=ON and build" >&2
  exit 2
done

"$1/prcage_bench" --benchmark_min_time=0.01
"$1/prcage_ladder" --shapes bumpy,bracket --sizes 4000,15625 --repetitions 2 --output "$1/perf/ladder-short.json"
python3 "$perf/ladder-table" "$1/perf/ladder-short.json"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/meshes"
"$1/prcage" make sphere --faces 1000 -o "$scratch/meshes/sphere.ply"
python3 "$perf/compare" "$1" "$scratch/meshes/sphere.ply" --faces 600 --output "$1/perf/compare-short.json"
python3 "$perf/ablation" "$1/prcage" "$scratch/meshes" "$scratch/ablation"
