#!/usr/bin/env bash
# Does what the README's "Your first glint" says, as it stands there, in an empty folder:
#     first_glint_test.sh SOURCE_DIR CMAKE_GENERATOR
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The blocks of the section: program, command, output, CMakeLists.txt, command.
awk '/^## / { wanted = /Your first glint/ }
     wanted && /^```/ { inside = !inside; if (inside) ++count; next }
     wanted && inside { print >("block." count) }' "$1/README.md"
cp block.1 first_glint.cpp
cp block.4 CMakeLists.txt
ln -s "$1" mica

commands_print() { # what the commands of block $1 print, but for the build's own lines
    bash -euo pipefail block."$1" 2>errors | grep -v '^-- \|^\[' | sed 's/ *$//' | diff block.3 - || {
        cat errors
        printf 'block %s of the section does not give block 3\n' "$1"
        exit 1
    }
}
commands_print 2
export CMAKE_GENERATOR="$2"
commands_print 5
printf 'the README leads to a glint by g++ and by CMake\n'
