#!/bin/sh
# Builds TBB from Debian's own source package with ThreadSanitizer into DIRECTORY, for the preset `tsan`.
#   sh cmake/build-tsan-tbb.sh build/tsan-tbb
# ThreadSanitizer has to see how threads hand work to each other. Debian's libtbb hides that, so that with it every
# parallel loop looks like a race. Same version and patches as the packaged library, so the same headers and ABI.
set -eu

[ $# -eq 1 ] || { echo "usage: $0 DIRECTORY" >&2; exit 2; }
mkdir -p "$1"
prefix=$(cd "$1" && pwd)
version=$(dpkg-query -W -f='${source:Version}' libtbb-dev)
if [ "$(cat "$prefix/version" 2>/dev/null)" = "$version" ]; then exit 0; fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# A private apt configuration: the machine's own sources with "deb-src" for "deb", which leaves them as they are.
mkdir -p lists/partial sources.d
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
  [ ! -f "$file" ] || sed -n 's/^deb /deb-src /p' "$file" > "sources.d/$(basename "$file" .list).list"
done
for file in /etc/apt/sources.list.d/*.sources; do
  [ ! -f "$file" ] || sed 's/^Types:.*/Types: deb-src/' "$file" > "sources.d/$(basename "$file")"
done
apt() {
  apt-get -qq -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$work/sources.d" \
    -o Dir::State::Lists="$work/lists" -o APT::Sandbox::User=root "$@"
}
apt update
apt source "onetbb=$version"

cmake -S onetbb-*/ -B build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_INSTALL_PREFIX="$prefix" \
  -DCMAKE_INSTALL_LIBDIR=lib -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF \
  -DTBB_DISABLE_HWLOC_AUTOMATIC_SEARCH=ON
cmake --build build
cmake --install build
echo "$version" > "$prefix/version"
