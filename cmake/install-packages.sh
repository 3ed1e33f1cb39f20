#!/bin/sh
# Installs the Debian 12 packages that prcage needs. The only list of them: README and CI call this script.
#   sh cmake/install-packages.sh         to build the library, the program and the tests
#   sh cmake/install-packages.sh checks  in addition what only CI runs: formatter, linter, instrumented TBB, perf/,
#                                        browser
# Does nothing, and needs neither root nor a network, if everything is there.
set -eu

packages="g++ cmake ninja-build pkg-config
  libtbb-dev libembree-dev libopenvdb-dev libeigen3-dev libxsimd-dev
  libcgal-dev libboost-dev libgmp-dev libmpfr-dev
  libcli11-dev nlohmann-json3-dev libfmt-dev libsqlite3-dev libstb-dev libmeshoptimizer-dev libpng-dev libxxhash-dev
  libgtest-dev libgmock-dev"
# For the page of the report. Node.js from elsewhere than Debian comes with its own npm.
command -v npm >/dev/null || packages="$packages nodejs npm"
case "${1-}" in
  "") ;;
  checks) packages="$packages clang-format clang-tidy dpkg-dev ccache
    libbenchmark-dev valgrind python3 gnuplot-nox chromium" ;;
  *) echo "usage: $0 [checks]" >&2; exit 2 ;;
esac

missing=""
for package in $packages; do
  dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then as_root="sudo"; fi
$as_root apt-get update -qq
# shellcheck disable=SC2086 # a list of words
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
