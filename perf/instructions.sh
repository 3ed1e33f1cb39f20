#!/bin/sh
# Counts the instructions of make_cage() in one small run of the program under valgrind's callgrind and compares them
# with the figure in perf/instructions.json. Counts, unlike times, are the same on a busy machine: this may fail a build.
#   sh perf/instructions.sh PROGRAM            exit code 1 if there are more than 10 % more than recorded
#   sh perf/instructions.sh PROGRAM --record   makes the present figure the recorded one
# PROGRAM is prcage, built as Release. One thread, the SSE2 kernels, a built-in shape. Libraries choose kernels by the
# processor too, but valgrind's is the same everywhere: AVX2.
set -eu

record=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)/instructions.json
allowed=1.10
usage() { sed -n '4,5s/^# \{0,1\}//p' "$0" >&2; exit 2; }
case "$#${2-}" in
  1 | 2--record) ;;
  *) usage ;;
esac
program=$1
[ -x "$program" ] || { echo "$program is not a program" >&2; exit 2; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$program" make bumpy --faces 2000 -o "$scratch/mesh.ply"
PRCAGE_SIMD=sse2 valgrind --tool=callgrind --callgrind-out-file="$scratch/callgrind.out" \
  --toggle-collect='prcage::make_cage(*)' \
  "$program" cage "$scratch/mesh.ply" -o "$scratch/cage.ply" --threads 1 --quiet 2>"$scratch/valgrind.log" ||
  { cat "$scratch/valgrind.log" >&2; exit 2; }
counted=$(sed -n 's/^\(totals\|summary\): //p' "$scratch/callgrind.out" | tail -1)

if [ $# -eq 2 ]; then
  printf '{"run": "prcage make bumpy --faces 2000, cage --threads 1", "instructions": %s}\n' "$counted" >"$record"
  echo "recorded: $counted instructions"
  exit 0
fi
recorded=$(sed -n 's/.*"instructions": \([0-9]*\).*/\1/p' "$record")
echo "instructions: $counted, recorded $recorded, ratio $(awk "BEGIN { printf \"%.3f\", $counted / $recorded }")"
if awk "BEGIN { exit !($counted > $allowed * $recorded) }"; then
  echo "More than $allowed times the recorded figure. Where they go:"
  callgrind_annotate "$scratch/callgrind.out" | grep -E '^ *[0-9,]+ \(' | head -20 | cut -c1-150
  echo "If they are worth it: sh perf/instructions.sh $program --record, and say why in the commit."
  exit 1
fi
