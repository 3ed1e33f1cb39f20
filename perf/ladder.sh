#!/bin/sh
# Climbs the ladder of sizes with real meshes, made dense by the tool `densify`, where ../shared is there, and with
# built-in shapes where it is not.
#   sh perf/ladder.sh BUILD_DIR [LARGEST [OPTIONS OF prcage_ladder...]]     LARGEST: faces, 250000 if it is not given
# Meshes are kept in BUILD_DIR/perf/meshes and made only once. JSON goes to BUILD_DIR/perf/ladder.json, the table of it
# to standard output.
set -eu

source=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
shared=$source/../shared
[ $# -ge 1 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
build=$1
largest=${2:-250000}
if [ $# -ge 2 ]; then shift 2; else shift; fi

ladder=$build/prcage_ladder
meshes=$build/perf/meshes
[ -x "$ladder" ] || { echo "$ladder is not there: configure with -DPRCAGE_BUILD_PERF=ON and build" >&2; exit 2; }

sizes=""
for size in 15625 62500 250000 1000000 4000000; do
  [ "$size" -gt "$largest" ] || sizes="$sizes $size"
done

# Small meshes whose subdivisions by 3 and 4 come close to the sizes; genus 0, 3 and 3.
real="organic/bunny genus/elephant genus/three_holes"

densify() {  # NAME SIZE: the path of the mesh; of at least that many faces
  mesh=$meshes/$(basename "$1")-$2.ply
  [ -e "$mesh" ] || "$meshes/densify" subdivide "$shared/meshes/$1.ply" "$mesh" --faces "$2" >&2
  echo "$mesh"
}

if [ -e "$shared/tools/densify.cpp" ]; then
  mkdir -p "$meshes"
  [ -n "$(find "$meshes/densify" -newer "$shared/tools/densify.cpp" 2>/dev/null)" ] ||
    "${CXX:-c++}" -std=c++17 -O2 "$shared/tools/densify.cpp" -o "$meshes/densify"
  files=""
  for mesh in $real; do
    for size in $sizes; do
      file=$(densify "$mesh" "$size")
      files="$files $file"
    done
  done
else
  echo "no ../shared: built-in shapes" >&2
  files="--shapes bumpy,knot,gyroid --sizes $(echo "$sizes" | sed 's/^ //; s/ /,/g')"
fi

# shellcheck disable=SC2086 # words
"$ladder" --output "$build/perf/ladder.json" "$@" $files
python3 "$source/perf/ladder-table" "$build/perf/ladder.json"
