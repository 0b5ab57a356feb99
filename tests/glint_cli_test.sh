#!/usr/bin/env bash
# The program as its users call it:
#     glint_cli_test.sh GLINT errors|hostile|determinism|tiles|environments|comparison|furnace|lights|costs
set -uo pipefail
glint=$1
part=$2
scenes=$(cd "$(dirname "$0")/../examples/scenes" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail() {
    printf 'FAILED: %s\n' "$*"
    failures=$((failures + 1))
}

# An equirectangular Radiance file, not run-length coded: WIDTH HEIGHT BYTES, the bytes of one texel as \x escapes.
write_hdr() {
    printf '#?RADIANCE\nGAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n' "$2" "$1"
    for ((i = 0; i < $1 * $2; ++i)); do printf "$3"; done
}

# Exit code 2, one line on standard error that says $1, nothing on standard output, no file left behind.
expect_error() {
    local says=$1 before after code
    shift
    before=$(ls -A)
    timeout 30 "$glint" "$@" >out.txt 2>err.txt
    code=$?
    [ "$code" -eq 2 ] || fail "$*: exit code $code"
    [ "$(wc -l <err.txt)" -eq 1 ] || fail "$*: $(wc -l <err.txt) lines of error"
    grep -q -- "$says" err.txt || fail "$*: does not say '$says' but '$(cat err.txt)'"
    [ ! -s out.txt ] || fail "$*: wrote to standard output"
    rm -f out.txt err.txt
    after=$(ls -A)
    [ "$before" = "$after" ] || fail "$*: left behind: $after"
}

errors() {
    write_hdr 8 4 '\x80\x80\x80\x81' >whole.hdr
    head -c 150 whole.hdr >truncated.hdr
    write_hdr 8 8 '\x80\x80\x80\x81' >square.hdr
    printf 'not a picture at all, only text\n' >text.hdr
    : >empty.hdr
    mkdir folder.png folder.hdr
    { # run-length coded: the first of 4 scanlines, and half of the second
        printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n'
        printf '\x02\x02\x00\x08\x88\x80\x88\x80\x88\x80\x88\x81\x02\x02\x00\x08\x88\x80'
    } >truncated_runs.hdr
    local small="--size 8x8 -o x.png"
    expect_error 'No such file' render --env missing.hdr $small
    expect_error 'truncated' render --env truncated.hdr $small
    expect_error 'truncated' render --env truncated_runs.hdr $small
    for length in 1 5 11 20 30 45 60 80; do # within the header
        head -c $length whole.hdr >cut.hdr
        expect_error 'cut.hdr' render --env cut.hdr $small
    done
    expect_error 'env is empty' render --env '' $small
    expect_error 'not an environment map' render --env square.hdr $small
    expect_error 'not an environment map' render --env text.hdr $small
    expect_error 'not an environment map' render --env empty.hdr $small
    expect_error 'is a folder' render --env folder.hdr $small
    expect_error 'size 0x540' render --size 0x540 -o x.png
    expect_error 'size -3x5' render --size=-3x5 -o x.png
    expect_error 'size 64' render --size 64 -o x.png
    expect_error 'size 99999x2' render --size 99999x2 -o x.png
    expect_error 'roughness -0.1' render --roughness -0.1 $small
    expect_error 'roughness nan' render --roughness nan $small
    expect_error 'roughness 1.5' render --roughness 1.5 $small
    expect_error 'density inf' render --density inf $small
    expect_error 'levels 1' render --levels 1 $small
    expect_error 'levels -4' render --levels -4 $small
    expect_error 'levels 9' render --levels 9 $small
    expect_error "unknown law 'poisson'" render --law poisson $small
    expect_error "unknown light 'moon'" render --light moon $small
    expect_error "unknown shape 'cube'" render --shape cube $small
    expect_error 'unknown interpolation' render --interpolate nothing $small
    expect_error 'cannot be written' render --size 8x8 -o nowhere/x.png
    expect_error 'cannot be written' render --size 8x8 -o folder.png
    expect_error 'cannot be written' render --size 8x8 -o x.jpg
    expect_error 'roughness' render --roughness much $small
    expect_error 'seed' render --seed -1 $small
    expect_error 'threads' render --threads -1 $small
    expect_error 'required' # no command
    expect_error 'help' render --wings 2
    expect_error "unknown law" furnace --law poisson
    expect_error 'not positive' furnace --precision 0
    expect_error 'softness 1' render --softness 1 $small
    expect_error 'softness' render --softness nan $small
    expect_error 'needs --law quantile' render --softness 0.2 --law exact $small
    expect_error 'is for --interpolate variates' render --softness 0.2 --interpolate counts $small
    expect_error "unknown classes 'taste'" render --classes taste $small
    expect_error 'occluder 1,2 is not x,y,z' render --occluder 1,2 $small
    expect_error 'occluder is not a direction' render --occluder 0,0,0 $small
    expect_error 'not compiled in for published' render --occluder 1,0,0 --classes published $small
    expect_error 'lights 0 is not in' render --light sun --lights 0 $small
    expect_error 'an environment is one light' render --lights 2 $small
    expect_error 'effects are not compiled in for law' render --tint 0.5 --law exact $small
    expect_error 'one_grid is for counts' render --one-grid $small
    expect_error 'counts are not compiled in for law' render --interpolate counts --law exact $small
    expect_error 'tint 3 is not in' render --tint 3 $small
    expect_error 'env is for environments, not for --light sun' render --light sun --env missing.hdr $small
    expect_error 'levels is for environments' render --light area --levels 5 $small
    expect_error 'knows one light' compare --light wdh20 -o x.png
    expect_error 'facets is not in' compare --light sun --facets 0 -o x.png
    expect_error 'size is not in' costs --size 1
    scene_error() { # SAYS JSON
        printf '%s' "$2" >scene.json
        expect_error "$1" render --scene scene.json -o x.png
    }
    expect_error 'missing.json cannot be read' render --scene missing.json -o x.png
    scene_error 'scene.json: .*parse error' '{"size": [8, 8'
    scene_error "unknown field 'ligths'" '{"ligths": []}'
    scene_error "scene.lights\[0\] has an unknown field 'colour'" '{"lights": [{"type": "sun", "colour": [1, 1, 1]}]}'
    scene_error 'scene.lights\[0\].radiance is not an array of 3 numbers' '{"lights": [{"type": "sun", "radiance": [1, 1]}]}'
    scene_error 'scene.seed is not a whole number' '{"seed": -1}'
    scene_error 'scene.surfaces\[1\].shape is not a string' '{"surfaces": [{}, {"shape": 4}]}'
    scene_error 'environments are compiled in for ggx' '{"surfaces": [{"distribution": "beckmann"}]}'
    scene_error 'environments are compiled in for ggx' '{"surfaces": [{}, {"roughness_across": 0.9}]}'
    scene_error 'needs a light' '{"lights": []}'
    scene_error 'needs a surface' '{"surfaces": []}'
    scene_error "unknown light 'moon'" '{"lights": [{"type": "moon"}]}'
    scene_error 'at most one environment' '{"size": [8, 8], "lights": [{}, {}]}'
    scene_error 'classes of light are not compiled in' '{"lights": [{"levels": 8}, {"type": "sun"}]}'
    expect_error 'is for scenes without a file' render --scene scene.json --levels 4 -o x.png
    rm scene.json
    expect_error "unknown mode 'guess'" compare --mode guess -o x.png
    expect_error "unknown law 'gaussian'" compare --law gaussian -o x.png
    expect_error 'trials' compare --trials 1e9 -o x.png
    expect_error 'probability' compare --probability 2 -o x.png
    expect_error 'ratio' compare --ratio 0.5 -o x.png
    expect_error 'cannot be written' compare -o nowhere/x.png
    expect_error 'cannot be written' strips -o nowhere/x.png
    "$glint" render --env whole.hdr $small --json >out.json || fail "a whole .hdr is not accepted"
    [ "$(head -c 4 x.png | tail -c 3)" = PNG ] || fail "no PNG"
    for field in width height law levels seconds ns_per_pixel binomials_per_pixel mean_glint mean_smooth; do
        grep -q "\"$field\": " out.json || fail "no field $field in $(cat out.json)"
    done
    timeout -s INT 1 "$glint" render --size 4096x4096 --threads 1 -o interrupted.png >/dev/null
    [ -z "$(ls | grep interrupted)" ] || fail "an interrupt leaves $(ls | grep interrupted)"
    "$glint" --help >/dev/null || fail "--help"
    [ "$("$glint" render $small 2>&1 >/dev/null | wc -c)" -eq 0 ] || fail "progress in a pipe"
}

# Files that mean harm: one line, exit code 2, nothing written, at once and in little memory. Sanitizers map terabytes, so
# memory is limited where it can be.
hostile() {
    local header='#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n' small="-o x.png --size 8x8" limit=unlimited
    (ulimit -v 2000000 && "$glint" --version) >/dev/null 2>&1 && limit=2000000
    ulimit -v "$limit"
    for size in '-Y 16000 +X 32000' '-Y 1000000000 +X 2000000000' '-Y 99999999999999999999 +X 1' '-Y -4 +X -8' '-Y 0 +X 0' \
        '-Y 4' '-Y +X' 'X' '' '-Y 4 +X 8 +Z 9'; do
        printf "$header%s\n" "$size" >size.hdr
        expect_error 'size.hdr' render --env size.hdr $small
    done
    printf "$header"'-Y 4096 +X 8192\n\x02\x02' >large.hdr
    expect_error 'truncated: 8192x4096 pixels are not in it' render --env large.hdr $small
    printf "$header"'-Y 8192 +X 16384\n\x02\x02' >wide.hdr
    expect_error 'too large' render --env wide.hdr $small
    { printf "$header"'-Y 4 +X 8\n\x02\x02\x00\x08\xff\x01' && head -c 100 /dev/zero; } >runs.hdr # a run beyond the line
    expect_error 'runs.hdr: cannot be read' render --env runs.hdr $small
    { printf '#?RADIANCE\n' && head -c 1000000 /dev/zero | tr '\0' 'x'; } >header.hdr # without an end
    expect_error 'header.hdr' render --env header.hdr $small
    mkfifo pipe.hdr
    expect_error 'not a plain file' render --env pipe.hdr $small
    expect_error 'not a plain file' render --env /dev/zero $small
    expect_error 'render: \?.\[31m\|not expected' render "$(printf 'a\e[31m')"
    rm ./*.hdr

    scene_error() { # SAYS JSON
        printf '%s' "$2" >scene.json
        expect_error "$1" render --scene scene.json -o x.png
        rm scene.json
    }
    head -c 3000000 /dev/zero | tr '\0' '[' >deep.json
    expect_error 'parse error' render --scene deep.json -o x.png
    { head -c 1000000 /dev/zero | tr '\0' '['; head -c 1000000 /dev/zero | tr '\0' ']'; } >deep.json
    expect_error 'is not an object' render --scene deep.json -o x.png
    rm deep.json
    mkdir folder.json
    expect_error 'folder.json' render --scene folder.json -o x.png
    scene_error 'parse error' ''
    scene_error 'parse error' '{"seed": NaN}'
    scene_error 'parse error' $'{"law": "\xff"}'
    scene_error 'out of range\|out_of_range' '{"softness": 1e999}'
    scene_error 'size 0x4' '{"size": [0, 4]}'
    scene_error 'size 4294967295x1 is not' '{"size": [4294967295, 1]}'
    scene_error 'whole number' '{"size": [1e9, 1]}'
    scene_error 'levels 1000000000 is not' '{"lights": [{"levels": 1000000000}]}'
    scene_error 'whole number' '{"lights": [{"levels": -1}]}'
    scene_error 'whole number from 0 to 2147483647' '{"lights": [{"levels": 4294967295}]}'
    scene_error '9 lights' '{"lights": [{}, {}, {}, {}, {}, {}, {}, {}, {}]}'
    scene_error 'at most one environment' '{"lights": [{}, {"type": "sun"}, {}]}'
    scene_error 'radius -1' '{"surfaces": [{"radius": -1}]}'
    scene_error 'radius 1e+30' '{"lights": [{"type": "disk", "radius": 1e30}]}'
    scene_error 'half_angle_degrees' '{"lights": [{"type": "sun", "half_angle_degrees": 1e9}]}'
    scene_error 'roughness inf' '{"surfaces": [{"roughness": 1e300}]}'
    scene_error 'reflectance -0.5' '{"surfaces": [{"reflectance": [1, -0.5, 0]}]}'
    scene_error 'centre inf' '{"surfaces": [{"centre": [1e300, 0, 0]}]}'
    scene_error 'eye 1e+30' '{"camera": {"eye": [1e30, 0, 0]}}'
    scene_error 'half_u -1e+20' '{"lights": [{"type": "area", "half_u": [-1e20, 0, 0], "half_v": [0, 1e-20, 0]}]}'
    scene_error 'radiance -1' '{"lights": [{"type": "sun", "radiance": [0, -1, 0]}]}'
    scene_error 'log density' '{"surfaces": [{"log_density": 1e9}]}'
    scene_error 'passwd: is not an environment map' '{"lights": [{"file": "/etc/passwd"}]}'
    # What terminals obey is not sent to them, and a name of a megabyte is cut.
    scene_error 'unknown law .a .31mb' '{"law": "a\u001b[31mb"}'
    printf '{"law": "%s"}' "$(head -c 100000 /dev/zero | tr '\0' 'x')" >scene.json
    "$glint" render --scene scene.json -o x.png 2>err.txt
    [ "$(wc -c <err.txt)" -lt 1100 ] || fail "an error of $(wc -c <err.txt) characters"
    rm scene.json err.txt
    # In the domain, but extreme: rendered, and nothing that is not finite.
    printf '%s' '{"size": [16, 9], "camera": {"eye": [0, 0.5, 1e6], "target": [0, 0, 0], "field_of_view_degrees": 0.01},
        "surfaces": [{"radius": 1e-6, "roughness": 0, "log_density": 60}, {"shape": "plane", "roughness": 1, "log_density": -60},
                     {"radius": 100, "glint_size": 1e-30}, {"radius": 50, "glint_size": 1e30, "roughness_across": 1}],
        "lights": [{"type": "sun", "radiance": [1e12, 1e12, 1e12], "half_angle_degrees": 180},
                   {"type": "rectangle", "centre": [1e6, 1e6, 1e6]}, {"type": "disk", "radius": 1e6}]}' >scene.json
    "$glint" render --scene scene.json --json -o x.png >out.json || fail "an extreme scene"
    grep -q '"non_finite_pixels": 0,' out.json || fail "an extreme scene: $(cat out.json)"
    if [ "$limit" != unlimited ]; then
        rm -f x.png
        expect_error 'not enough memory' render --size 16384x16384 -o x.png
    fi
}

determinism() {
    for shape in sphere plane; do
        "$glint" render --shape $shape --size 160x90 --threads 1 -o one.png >/dev/null || fail "one thread"
        "$glint" render --shape $shape --size 160x90 --threads 2 -o two.png >/dev/null || fail "two threads"
        cmp one.png two.png || fail "$shape: one and two threads give different pictures"
        "$glint" render --shape $shape --size 160x90 --seed 2 -o other.png >/dev/null || fail "another seed"
        ! cmp -s one.png other.png || fail "$shape: another seed gives the same picture"
    done
}

# One frame in tiles that other processes render, in any order.
tiles() {
    local scene="--size 101x67 --light area --lights 2 --tint 0.4" tile
    "$glint" render $scene -o whole.png >/dev/null && "$glint" render $scene -o whole.exr >/dev/null || fail "whole"
    for tile in 64,0,37,31 0,0,64,31 0,31,1,36 1,31,100,36; do
        "$glint" render $scene --tile $tile --threads 1 -o "tile-$tile.exr" >/dev/null || fail "tile $tile"
    done
    "$glint" merge tile-*.exr -o merged.png >/dev/null && "$glint" merge tile-*.exr -o merged.exr >/dev/null || fail "merge"
    cmp whole.png merged.png || fail "the merged picture is not the whole one"
    cmp whole.exr merged.exr || fail "the merged radiance is not that of the whole picture"

    expect_error 'no tile has pixel 64,0' merge tile-0*.exr tile-1*.exr -o x.png
    expect_error 'overlaps tile-0,0,64,31.exr' merge tile-*.exr tile-0,0,64,31.exr -o x.png
    "$glint" render $scene --seed 2 --tile 0,0,1,1 -o other.exr >/dev/null
    expect_error 'is of another picture than' merge tile-*.exr other.exr -o x.png
    expect_error 'tile 0,0,102,1 is not within 101x67' render $scene --tile 0,0,102,1 -o x.exr
    expect_error 'tile 0,0,0,1 is not within' render $scene --tile 0,0,0,1 -o x.exr
    expect_error 'is not x,y,width,height' render $scene --tile 0,0,1 -o x.exr
    expect_error 'needs an .exr output' render $scene --tile 0,0,1,1 -o x.png
    head -c 2000 whole.exr >truncated.exr
    printf 'not a picture\n' >text.exr
    expect_error 'truncated.exr: cannot be read as OpenEXR' merge truncated.exr -o x.png
    expect_error 'text.exr: cannot be read as OpenEXR' merge text.exr -o x.png
    expect_error 'No such file' merge missing.exr -o x.png
    expect_error 'required' merge -o x.png

    # Environments too.
    "$glint" render --size 64x32 -o map.exr >/dev/null
    "$glint" render --env map.exr --size 32x32 -o lit.png >/dev/null || fail "an environment in OpenEXR"
    expect_error 'is not twice as wide as high' render --env whole.exr --size 8x8 -o x.png
    head -c 2000 map.exr >truncated.exr
    expect_error 'cannot be read as OpenEXR' render --env truncated.exr --size 8x8 -o x.png
}

environments() {
    local maps=("${MICA_HDRI_DIR:-}"/*.hdr)
    if [ ! -e "${maps[0]}" ]; then
        printf 'skipped: no environment maps in MICA_HDRI_DIR=%s\n' "${MICA_HDRI_DIR:-}"
        exit 77
    fi
    for map in "${maps[@]}"; do
        for shape in sphere plane; do
            "$glint" render --env "$map" --shape $shape --size 96x54 --levels 4 --json -o x.png >out.json ||
                fail "$map is not accepted"
            grep -q '"non_finite_pixels": 0,' out.json || fail "$map: $(cat out.json)"
        done
        head -c 200000 "$map" >truncated.hdr
        expect_error 'truncated' render --env truncated.hdr --size 8x8 -o x2.png
    done
}

# Variates have the law, counts about half of its variance, and every row has its fields.
comparison() {
    "$glint" compare --mode counts,variates,facets --ratio 1,16 --trials 1.5,50 --probability 0.02,0.5 --samples 65536 \
        --json -o compare.png >rows.json || fail "compare"
    [ "$(grep -c '"mode"' rows.json)" -eq 48 ] || fail "not 48 rows: $(cat rows.json)"
    for field in mode footprint_ratio trials probability mean_ratio variance_ratio p0 p0_exact tv correlation_length \
        jumps evaluations_per_pixel ns_per_pixel; do
        [ "$(grep -c "\"$field\": " rows.json)" -eq 48 ] || fail "no field $field"
    done
    awk -F'[:,] *' '
        /"mode"/ {
            gsub(/[{}"]/, "")
            for (i = 1; i < NF; i += 2) { gsub(/^ +/, "", $i); row[$i] = $(i + 1) }
            far = row["mean_ratio"] - 1; error = row["mean_error"]
            bad = 0
            if (row["mode"] == "variates") {
                bad = far > 5 * error || far < -5 * error || row["evaluations_per_pixel"] != 1
                if (row["variance_ratio"] - 1 > 5 * row["variance_error"] + 0.001) bad = 1
                if (1 - row["variance_ratio"] > 5 * row["variance_error"] + 0.001) bad = 1
                if (row["tv"] > 3 * row["tv_by_chance"] + 0.001) bad = 1
                if (row["jumps"] > 0.6) bad = 1
            }
            if (row["mode"] == "counts" && (row["variance_ratio"] > 0.62 || row["evaluations_per_pixel"] != 12)) bad = 1
            if (bad) { print; failed = 1 }
        }
        END { exit failed }' rows.json || fail "rows that miss what is demanded"
    "$glint" strips -o strips.png >/dev/null || fail "strips"
    [ "$(head -c 4 strips.png | tail -c 3)" = PNG ] || fail "no strips"
}

# Every light renders, the same twice, and a scene file says the same as the options do.
lights() {
    for light in environment wdh20 directional sun area disk; do
        for run in one two; do
            "$glint" render --light $light --size 64x36 --json -o $run.png >$run.json || fail "$light"
        done
        cmp one.png two.png || fail "$light: the same frame twice is not the same"
        grep -q '"non_finite_pixels": 0,' one.json || fail "$light: $(cat one.json)"
    done
    "$glint" render --light sun --lights 5 --size 64x36 --json -o five.png >five.json || fail "five suns"
    grep -q '"binomials_per_pixel": 5,' five.json || fail "five suns: $(cat five.json)"
    "$glint" render --levels 6 --roughness 0.25 --density 12 --tint 0.3 --size 64x36 -o options.png >/dev/null || fail "options"
    printf '%s' '{"size": [64, 36], "surfaces": [{"roughness": 0.25, "log_density": 12}],
                  "lights": [{"levels": 6}], "effects": {"tint": 0.3}}' >scene.json
    "$glint" render --scene scene.json -o scene.png >/dev/null || fail "scene"
    cmp options.png scene.png || fail "the scene file gives another picture than the options"
    for scene in "$scenes"/*.json; do
        sed 's/"size": \[[^]]*\]/"size": [64, 36]/' "$scene" >small.json
        "$glint" render --scene small.json --json -o scene.png >scene.json.out || fail "$scene"
        grep -q '"non_finite_pixels": 0,' scene.json.out || fail "$scene: $(cat scene.json.out)"
    done
}

costs() {
    "$glint" costs --size 8 --repetitions 1 --no-callgrind --json >rows.json || fail "costs"
    for row in 'environment, 4 classes, smooth:0' 'environment, 4 classes:3' 'environment, 8 classes:7' '  counts:36' \
        'directional:1' '  counts, angular_grid:48' '8 suns, one multinomial:8'; do
        grep -q "\"effects\": \"${row%:*}\".*\"binomials_per_pixel\": ${row#*:}," rows.json ||
            fail "not ${row#*:} binomials: $(grep "\"${row%:*}\"" rows.json)"
    done
}

furnace() {
    "$glint" furnace --law exact --levels 2,4,8 --roughness 0.04,0.5 --facets 0.14,7 --json >rows.json || fail "furnace"
    [ "$(grep -c '"passes": true' rows.json)" -eq 24 ] || fail "$(cat rows.json)"
    ! grep -q '"passes": false' rows.json || fail "$(grep '"passes": false' rows.json)"
}

"$part"
[ "$failures" -eq 0 ] || exit 1
printf '%s: passed\n' "$part"
