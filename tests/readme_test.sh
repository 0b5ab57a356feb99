#!/usr/bin/env bash
# The README shows examples/first.cpp and what it really prints:  readme_test.sh SOURCE_DIR FIRST
set -uo pipefail
cd "$1" || exit 1

block() { # the N-th fenced block of the README
    awk -v wanted="$1" '/^```/ { if (inside) inside = 0; else { inside = 1; ++count }; next } inside && count == wanted' README.md
}

diff <(block 1) <(grep -v '^//' examples/first.cpp) || { printf 'the program differs\n'; exit 1; }
diff <(block 2) <("$2") || { printf 'the output differs\n'; exit 1; }
# What it shows of shading stands in examples/pixel.cpp, which is compiled.
awk '/^```cpp/ { inside = 1; next } /^```/ { inside = 0 } inside && /using kernel/ { wanted = 1 } !inside { wanted = 0 } wanted && NF' \
    README.md | sed 's/^ *//' >"${TMPDIR:-/tmp}/readme_shading.$$"
[ -s "${TMPDIR:-/tmp}/readme_shading.$$" ] || { printf 'the README shows no shading\n'; exit 1; }
missing=$(sed 's/^ *//' examples/pixel.cpp | grep -vxFf - "${TMPDIR:-/tmp}/readme_shading.$$")
rm -f "${TMPDIR:-/tmp}/readme_shading.$$"
[ -z "$missing" ] || { printf 'not in examples/pixel.cpp:\n%s\n' "$missing"; exit 1; }
printf 'the README shows the program and its output\n'
