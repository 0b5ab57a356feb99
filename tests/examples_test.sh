#!/usr/bin/env bash
# Every example prints what its last comment says; what the pages show of C++ stands in an example, line for line:
#     examples_test.sh SOURCE_DIR FOLDER_OF_PROGRAMS
set -uo pipefail
source_dir=$1 programs=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

fail() {
    printf '%s\n' "$1"
    failed=1
}

checked=0
for example in "$source_dir"/examples/*.cpp; do
    name=$(basename "$example" .cpp)
    awk '/^\/\/ Prints:/ { inside = 1; next } inside && /^\/\/     / { print substr($0, 8) } inside && !/^\/\// { exit }' \
        "$example" >"$work/expected"
    [ -s "$work/expected" ] || continue
    (cd "$work" && "$programs/$name") | sed 's/ *$//' | diff "$work/expected" - || fail "$name prints something else"
    checked=$((checked + 1))
done
[ "$checked" -ge 7 ] || fail "only $checked examples say what they print"

# A block of a page and the examples, without blank lines and indentation.
squeezed() { sed 's/^ *//; /^$/d'; }
code=$(cat "$source_dir"/examples/*.cpp | squeezed)
blocks=0
for page in README.md docs/engine.md docs/examples.md; do
    # README.md has fragments, too; of it, what tests/readme_test.sh leaves and is a program.
    awk -v page="$page" -v to="$work/block" '
        /^```cpp/ { inside = 1; text = ""; next }
        /^```/ && inside { inside = 0; if (page != "README.md" || text ~ /int main/) printf "%s", text >(to "." ++count) }
        inside { text = text $0 "\n" }' "$source_dir/$page"
    for block in "$work"/block.*; do
        [ -e "$block" ] || continue
        blocks=$((blocks + 1))
        [[ $code == *"$(squeezed <"$block")"* ]] || { cat "$block"; fail "$page: no example has this"; }
    done
    rm -f "$work"/block.*
done
[ "$blocks" -ge 8 ] || fail "only $blocks blocks of C++ in the pages"

[ "$failed" -eq 0 ] && printf '%s examples print what they say, %s blocks of the pages stand in them\n' "$checked" "$blocks"
exit "$failed"
