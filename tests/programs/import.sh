#!/usr/bin/env bash
# Inputs of all kinds through the programs: directories, patterns, assemblies, height maps, y up, libraries' formats.
source "$(dirname "$0")/lib.sh"
preprocess=$bin/iwalk-preprocess
cd "$work"
make_ply good.ply

# of FILE JSON-POINTER...: numbers of a dataset's description.
of() { "$preprocess" info "$1" --json | python3 -c "
import json, sys
value = json.load(sys.stdin)
for key in sys.argv[1:]: value = value[int(key) if key.isdigit() else key]
print(value)" "${@:2}"; }
# same WHAT GOT WANTED
same() { [ "$2" = "$3" ] || complain "$1: $2, not $3"; }
build() { "$preprocess" build "$@" >log 2>&1 || complain "build $*: $(cat log)"; }

# The same triangle in five formats.
mkdir -p parts/deep
printf 'v 0 0 0\nv 1 0 0\nv 0 2 3\nf 1 2 3\n' >parts/a.obj
printf 'solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 3\nendloop\nendfacet\nendsolid\n' >parts/b.stl
printf '#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0 1 0 0 0 2 3] } coordIndex [0 1 2] } }\n' >parts/deep/c.wrl
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 2 3\n3 0 1 2\n' >parts/deep/d.off
echo 'no model' >parts/readme.txt
build parts -o all
same "a directory's triangles" "$(of all triangles)" 4
build 'parts/*.obj' 'parts/deep/?.wrl' -o some
same "patterns' triangles" "$(of some triangles)" 2
refuses "no-such-*.ply" "$preprocess" build 'no-such-*.ply' -o none
mkdir empty
refuses "has no models in it" "$preprocess" build empty -o none
"$preprocess" verify all >/dev/null || complain "the dataset does not verify"
for other in parts/b.stl parts/deep/c.wrl parts/deep/d.off; do
    "$bin/iwalk-same-triangles" parts/a.obj $other >log || complain "not the same triangle: $(cat log)"
done

# Turned: (0, 2, 3) becomes (0, -3, 2).
build --up y parts/a.obj -o turned
same "y up" "$(of turned bounds)" "{'min': [0.0, -3.0, 0.0], 'max': [1.0, 0.0, 2.0]}"

# An assembly that places one file twice, and measuring.
cat >pair.json <<'JSON'
{"parts": [{"file": "good.ply"}, {"file": "good.ply", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,100, 0,0,0,1], "color": "#ff0000"}]}
JSON
build pair.json -o pair
same "an assembly's triangles" "$(of pair triangles)" 1600
same "an assembly's colours" "$(of pair attributes colors)" True
status=0
"$bin/iwalk-same-triangles" good.ply pair.json --within 1 >log || status=$?
same "the exit code when some are only in one" $status 1
same "the triangles only in one" "$(grep -o 'only in.*: [0-9]*' log | tr '\n' ' ')" "only in good.ply: 0 only in pair.json: 800 "
"$preprocess" measure good.ply pair.json --json | python3 -c '
import json, sys
good, pair = json.load(sys.stdin)
assert good["vertices"] == 441 and good["bounds"]["min"][:2] == [0, 0] and not good["colors"], good
assert pair["vertices"] == 882 and pair["colors"] and pair["bounds"]["max"][2] > 100, pair' || complain "measure is wrong"
refuses missing.ply "$preprocess" measure missing.ply

# A height map with a hole, of 16 bits.
python3 -c '
import struct, sys
def entry(tag, kind, value): return struct.pack("<HHII", tag, kind, 1, value)
samples = [100 * x + y for y in range(20) for x in range(30)]
samples[7 * 30 + 9] = 65535
entries = [(256, 4, 30), (257, 4, 20), (258, 3, 16), (259, 3, 1), (262, 3, 1), (273, 4, 122), (277, 3, 1), (278, 4, 20), (279, 4, 1200)]
sys.stdout.buffer.write(b"II*\0" + struct.pack("<IH", 8, 9) + b"".join(entry(*e) for e in entries) + bytes(4)
                        + struct.pack("<600H", *samples))' >heights.tif
build heights.tif --spacing 5 --height-scale 0.1 --no-data 65535 -o heights
same "a height map's triangles" "$(of heights triangles)" $((2 * 29 * 19 - 4))
same "its bounds" "$(of heights bounds max)" "[145.0, 95.0, 291.8999938964844]"
same "and no colours" "$(of heights attributes colors)" False
build heights.tif --sea-level 1000 -o sea
same "a sea's colours" "$(of sea attributes colors)" True
# With a round hole, of integers and of floats.
wanted=$(python3 -c '
import math
there = lambda x, y: math.hypot(x - 30, y - 20) >= 5
corners = lambda x, y: there(x, y) + there(x + 1, y) + there(x, y + 1) + there(x + 1, y + 1)
print(sum(max(corners(x, y) - 2, 0) for y in range(39) for x in range(59)))')
for options in "hole.tif" "hole.png" "hole.exr --float"; do
    # shellcheck disable=SC2086
    "$bin/iwalk-height-map" 60 40 $options --holes || complain "iwalk-height-map $options"
    build "${options% *}" --no-data 65535 -o hole
    same "triangles of $options" "$(of hole triangles)" "$wanted"
done
truncate -s 500 heights.tif
refuses heights.tif "$preprocess" build heights.tif -o none
[ ! -e none ] || complain "a failed build left its directory"

# What assimp's authors test with: everything imports, or ends with one line, in 10 seconds and 1 GB.
models=/usr/share/assimp/models
if [ -d $models ]; then
    read_files=0 refused=0
    while IFS= read -r -d '' file; do
        status=0
        (ulimit -v 4000000; timeout 10 "$preprocess" measure "$file" --json >stdout 2>stderr) || status=$?
        if [ $status = 0 ]; then
            read_files=$((read_files + 1))
        elif [ $status = 1 ] && [ "$(grep -c '^iwalk-preprocess: ' stderr)" = 1 ]; then
            refused=$((refused + 1))
        else
            complain "$file: exit code $status: $(tail -n 3 stderr)"
        fi
    done < <(find $models -type f -print0 | sort -z)
    echo "assimp's models: $read_files read, $refused refused with a line"
else
    echo "skipped: no assimp-testmodels"
fi
finish
