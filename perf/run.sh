#!/bin/sh
# The short run for CI: the micro-benchmarks for a moment each and the smallest rungs of the ladder. It prints. Times on
# a shared machine are no reason to fail, a program that does not work is.
#   sh perf/run.sh BUILD_DIR
set -eu

[ $# -eq 1 ] || { sed -n '4s/^# \{0,1\}//p' "$0" >&2; exit 2; }
perf=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
for program in prcage_bench prcage_ladder; do
  [ -x "$1/$program" ] && continue
  echo "$1/$program is not there: configure with -DPRCAGE_BUILD_PERF=ON and build" >&2
  exit 2
done

"$1/prcage_bench" --benchmark_min_time=0.01
"$1/prcage_ladder" --shapes bumpy,bracket --sizes 4000,15625 --repetitions 2 --output "$1/perf/ladder-short.json"
python3 "$perf/ladder-table" "$1/perf/ladder-short.json"
