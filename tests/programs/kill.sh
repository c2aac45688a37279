#!/usr/bin/env bash
# Builds that are killed at any moment and builds on a full disk: the dataset that was there stays whole, or the new one
# is complete; the next build succeeds; nothing temporary is left behind. IWALK_KILLS says how many are killed (default
# 5); the seed of the moments is printed, and IWALK_SEED repeats them.
source "$(dirname "$0")/lib.sh"
preprocess=$bin/iwalk-preprocess
cd "$work"
kills=${IWALK_KILLS:-5} seed=${IWALK_SEED:-$((10#$(date +%N) % 32768))}
RANDOM=$seed
echo "seed $seed"
small=disk
cleanup() { ! mountpoint -q "$work/$small" || umount "$work/$small"; }

make_ply old.ply 30
"$preprocess" generate isosurface --triangles 60000 -o new.ply >/dev/null 2>&1
build_old() { "$preprocess" build old.ply -o "$1" --leaf-triangles 200 >/dev/null 2>"$work/stderr"; }
new=("$preprocess" build new.ply --leaf-triangles 1000 -o)
triangles_in() { "$preprocess" info "$1" --json | sed -n '0,/"triangles"/s/.*"triangles": *\([0-9]*\).*/\1/p'; }

# is_clean DATASET: exactly the files of one generation.
is_clean() {
    local generation
    generation=$(sed -n 's/.*"generation": *\([0-9]*\).*/\1/p' "$1/dataset.json")
    [ "$(ls -A "$1" | tr '\n' ' ')" = "dataset.json hierarchy-$generation.bin pages-$generation.bin " ]
}
# expect_good DATASET TRIANGLES WHEN: verifies, and is the one with so many triangles.
expect_good() {
    "$preprocess" verify "$1" >/dev/null 2>"$work/stderr" || complain "$3: does not verify: $(tail -n 1 "$work/stderr")"
    [ "$(triangles_in "$1")" = "$2" ] || complain "$3: has $(triangles_in "$1") triangles, not $2"
}
expect_clean() { is_clean "$1" || complain "$2: left behind: $(ls -AR "$1" | tr '\n' ' ')"; }

build_old whole
began=$(date +%s%N)
"${new[@]}" reference >/dev/null 2>&1
duration=$(($(date +%s%N) - began))
old_triangles=$(triangles_in whole) new_triangles=$(triangles_in reference)

# Waits for a moment: of the whole duration, of its end, or that at which the first new file is in place.
await() {
    local directory=$1 which=$2 nanoseconds
    case $which in
        0) while kill -0 "$builder" 2>/dev/null && ! compgen -G "$directory/hierarchy-$3.bin" >/dev/null; do :; done ;;
        1) nanoseconds=$((duration / 100 * (85 + RANDOM % 25))) ;;
        *) nanoseconds=$((duration / 1000 * (RANDOM % 1050))) ;;
    esac
    [ "$which" = 0 ] || sleep "$(printf '%d.%09d' $((nanoseconds / 1000000000)) $((nanoseconds % 1000000000)))"
}
# kill_build DIRECTORY WHICH GENERATION: a build that is to be that generation, killed.
kill_build() {
    "${new[@]}" "$1" >/dev/null 2>&1 &
    builder=$!
    await "$@"
    kill -KILL "$builder" 2>/dev/null || true
    wait "$builder" 2>/dev/null || true
}

kept=0 replaced=0
over_old() {
    rm -rf over && build_old over && cp over/dataset.json before.json
    kill_build over "$1" 2
    if cmp -s over/dataset.json before.json; then
        expect_good over "$old_triangles" "kill $2"
        kept=$((kept + 1))
    else
        expect_good over "$new_triangles" "kill $2"
        replaced=$((replaced + 1))
    fi
    build_old over || complain "kill $2: the next build fails: $(cat "$work/stderr")"
    expect_good over "$old_triangles" "after kill $2"
    expect_clean over "after kill $2"
}
into_fresh() {
    rm -rf fresh
    kill_build fresh "$1" 1
    [ ! -e fresh/dataset.json ] || expect_good fresh "$new_triangles" "fresh kill $2"
    build_old fresh || complain "fresh kill $2: the next build fails: $(cat "$work/stderr")"
    expect_good fresh "$old_triangles" "after fresh kill $2"
    expect_clean fresh "after fresh kill $2"
}
for ((i = 0; i < kills; ++i)); do
    over_old $((i % 4)) "$i"
    into_fresh $((i % 4)) "$i"
done
echo "killed $((2 * kills)) builds; the old dataset was kept $kept and replaced $replaced times"

# A disk without room, or without room for one more file.
if [ "$(id -u)" != 0 ] || ! mkdir "$small" || ! mount -t tmpfs -o size=64k none "$small" 2>/dev/null; then
    echo "skipped: no small disk without root and mounts"
    finish
    exit
fi
umount "$small"

# build_on_disk OPTIONS: over the old dataset, on a disk with these; the file that it ends at, nothing when it succeeds.
build_on_disk() {
    local status=0
    mount -t tmpfs -o "$1" none "$small"
    cp -r whole "$small/out"
    "${new[@]}" "$small/out" >/dev/null 2>"$work/stderr" || status=$?
    sed -i '/^iwalk-/!d' "$work/stderr"  # without the progress
    expect_clean "$small/out" "disk of $1"
    if [ "$status" = 0 ]; then
        expect_good "$small/out" "$new_triangles" "disk of $1"
    else
        expect_good_refusal "$status" "$1"
        cmp -s whole/dataset.json "$small/out/dataset.json" || complain "disk of $1: the manifest is another one"
        grep -o "$small/out[^:]*" "$work/stderr" | sed 's|.*/||' >>ended
        expect_good "$small/out" "$old_triangles" "disk of $1"
    fi
    umount "$small"
    return "$status"
}
expect_good_refusal() {
    local text
    text=$(cat "$work/stderr")
    [ "$1" = 1 ] || complain "disk of $2: exit code $1"
    [ "$(grep -c . "$work/stderr")" = 1 ] || complain "disk of $2: not one line: $text"
    grep -q "$small/out.*No space left" "$work/stderr" || complain "disk of $2: names no path or reason: $text"
    grep -q "free some space" "$work/stderr" || complain "disk of $2: does not say what to do: $text"
}
# Each of these must have been where the disk was full.
expect_ended() {
    for name in "$@"; do
        grep -qx "$name" ended || complain "no disk was full at $name, only at $(sort -u ended | tr '\n' ' ')"
    done
    rm ended
}

kilobytes=$(($(du -sk whole | cut -f1) + 20))
while ! build_on_disk "size=${kilobytes}k"; do kilobytes=$((kilobytes * 108 / 100)); done
expect_ended triangles pages-2.bin targets
# Each file and directory takes an inode, of which the old dataset has 5. The hierarchy has that of the targets.
inodes=5
while ! build_on_disk "nr_inodes=$inodes"; do inodes=$((inodes + 1)); done
expect_ended .iwalk-lock .iwalk-build triangles pages-2.bin targets dataset.json.new
finish
