#!/bin/sh
# Makes the pictures of README.md with nothing but the program itself: built-in shapes, their cages, and drawings.
#   sh tools/readme_pictures.sh [PROGRAM [DIRECTORY]]   by default build/release/prcage and tools/pictures
# What the program writes depends on neither time nor threads: an unchanged program leaves the pictures unchanged.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
program=${1-$root/build/release/prcage}
pictures=${2-$root/tools/pictures}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# SHAPE FACES [OPTION OF RENDER...]: input, cage over input and cage, side by side.
picture() {
  shape=$1 faces=$2
  shift 2
  "$program" make "$shape" --faces "$faces" -o "$work/$shape.ply"
  "$program" cage "$work/$shape.ply" -o "$work/$shape-cage.ply" --quiet
  "$program" render "$work/$shape.ply" "$work/$shape-cage.ply" -o "$pictures/$shape.png" --width 1000 --height 350 "$@"
}

# SHAPE NAME OPTION OF POSE...: the shape deformed by its cage, which picture() has left behind.
deformed_picture() {
  shape=$1 name=$2
  shift 2
  "$program" pose "$work/$shape-cage.ply" -o "$work/posed.ply" "$@"
  "$program" deform "$work/$shape.ply" "$work/$shape-cage.ply" "$work/posed.ply" -o "$work/deformed.ply"
  "$program" render "$work/deformed.ply" "$work/posed.ply" -o "$pictures/$name.png" --width 1000 --height 350
}

# COMMAND SHAPE FACES OPTION OF COMMAND...: input, what simplify or lowpoly makes of it over the input, and that alone.
simpler_picture() {
  command=$1 shape=$2 faces=$3
  shift 3
  "$program" make "$shape" --faces "$faces" -o "$work/$shape.ply"
  "$program" "$command" "$work/$shape.ply" -o "$work/$shape-$command.ply" --quiet "$@"
  "$program" render "$work/$shape.ply" "$work/$shape-$command.ply" -o "$pictures/$shape-$command.png" \
    --width 1000 --height 350
}

mkdir -p "$pictures"
picture knot 100000
picture bracket 20000
deformed_picture bracket bracket-bent --bend 90
deformed_picture knot knot-twisted --twist 120
simpler_picture simplify gyroid 60000
simpler_picture lowpoly spikes 40000 --faces 300
