#!/usr/bin/env bash
# Bad input of every kind: one line that names file and place, exit code 1, nothing left behind.
source "$(dirname "$0")/lib.sh"
preprocess=$bin/iwalk-preprocess
cd "$work"
make_ply good.ply
nothing_left() { [ ! -e "$1" ] || complain "$1 was left behind: $(ls -A "$1" 2>/dev/null)"; }
build_refuses() {
    local text=$1
    shift
    refuses "$text" "$preprocess" build "$@" -o out
    nothing_left out
}

# Inputs.
build_refuses missing.ply missing.ply
head -c 3000 good.ply >short.ply
build_refuses short.ply short.ply
sed 's/^element face .*/element face 4000000000/' good.ply >lies.ply
build_refuses lies.ply lies.ply
sed 's/^3 0 1 21$/3 0 1 4711/' good.ply >range.ply
build_refuses 4711 range.ply
sed '/^element vertex/s/.*/element vertex 0/; /^element face/s/.*/element face 0/; /end_header/q' good.ply >empty.ply
build_refuses "nothing to build" empty.ply
: >nothing.ply
build_refuses nothing.ply nothing.ply
echo "just text" >text.xyz
build_refuses text.xyz text.xyz
mkdir directory.ply
build_refuses directory.ply directory.ply
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n' >range.obj
build_refuses range.obj range.obj

# Positions that are no numbers: the triangle is dropped and counted, the rest is built.
awk '/end_header/ {print; getline; print "nan 0 0"; next} {print}' good.ply >nan.ply
"$preprocess" build nan.ply -o nan >/dev/null 2>&1 || complain "a NaN spoils the build"
"$preprocess" info nan --json | grep -Eq '"?(droppedNonFinite|dropped_non_finite)"?: *1\b' || complain "dropped triangles are not counted: $("$preprocess" info nan --json | tr -d '\n')"

# Outputs.
touch file
refuses file "$preprocess" build good.ply -o file/out
mkdir foreign && touch foreign/precious
refuses foreign "$preprocess" build good.ply -o foreign
[ "$(ls -A foreign)" = precious ] || complain "a foreign directory was changed"
if [ "$(id -u)" = 0 ] && mkdir small && mount -t tmpfs -o size=64k none small 2>/dev/null; then
    make_ply large.ply 120
    refuses small "$preprocess" build large.ply -o small/out
    nothing_left small/out
    umount small
else
    echo "skipped: no small file system without root and mounts"
fi

# A dataset that stays whole when a later build over it fails.
"$preprocess" build good.ply -o dataset --leaf-triangles 100 >/dev/null 2>&1
sum() { cat dataset/* | md5sum; }
before=$(sum)
refuses short.ply "$preprocess" build short.ply -o dataset
[ "$(sum)" = "$before" ] || complain "a failed build changed the dataset"
"$preprocess" verify dataset >/dev/null || complain "the dataset does not verify"

# Damaged datasets.
pages=$(ls dataset/pages-*.bin)
cp -r dataset flipped
flip "flipped/$(basename "$pages")" 2000
refuses "page" "$preprocess" verify flipped
cp -r dataset cut
truncate -s -1 "cut/$(basename "$pages")"
refuses "$(basename "$pages")" "$preprocess" verify cut
cp -r dataset future
sed -i 's/"version": *[0-9]*/"version": 77/' future/dataset.json
refuses 77 "$preprocess" info future
refuses 77 ranks 1 "$bin/iwalk-server" --dataset future --wall "$source/config/wall-1x1.toml"
refuses nowhere "$preprocess" info nowhere

# Servers that cannot start.
server="$bin/iwalk-server"
refuses "there are 2 ranks" ranks 2 "$server" --dataset dataset --wall "$source/config/wall-1x1.toml"
sed 's/columns/colums/' "$source/config/wall-1x1.toml" >typo.toml
line=$(grep -n colums typo.toml | cut -d: -f1)
refuses "typo.toml:$line:1" ranks 1 "$server" --dataset dataset --wall typo.toml
refuses nowhere ranks 1 "$server" --dataset nowhere --wall "$source/config/wall-1x1.toml"
finish
