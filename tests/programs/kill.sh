#!/usr/bin/env bash
# Builds, inserts and compactions that are killed at any moment, and some on a full disk: the dataset that was there
# stays whole, or the new one is complete; the next run succeeds; nothing temporary is left behind. IWALK_KILLS says how
# many of each are killed (default 5); the seed of the moments is printed, and IWALK_SEED repeats them.
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

# is_clean DATASET: exactly the manifest and the files that it names.
is_clean() {
    local named
    named=$({ echo dataset.json; grep -o '[a-z]*-[0-9]*\.bin' "$1/dataset.json"; } | sort | tr '\n' ' ')
    [ "$(ls -A "$1" | sort | tr '\n' ' ')" = "$named" ]
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

# Waits for a moment of what runs for $duration ns: any, near its end, or when the first new file is in place.
await() {
    local directory=$1 which=$2 nanoseconds
    case $which in
        0) while kill -0 "$builder" 2>/dev/null && ! compgen -G "$directory/hierarchy-$3.bin" >/dev/null; do :; done ;;
        1) nanoseconds=$((duration / 100 * (85 + RANDOM % 25))) ;;
        *) nanoseconds=$((duration / 1000 * (RANDOM % 1050))) ;;
    esac
    [ "$which" = 0 ] || sleep "$(printf '%d.%09d' $((nanoseconds / 1000000000)) $((nanoseconds % 1000000000)))"
}
# kill_run DIRECTORY WHICH GENERATION COMMAND...: what is to make that generation, killed.
kill_run() {
    "${@:4}" >/dev/null 2>&1 &
    builder=$!
    await "${@:1:3}"
    kill -KILL "$builder" 2>/dev/null || true
    wait "$builder" 2>/dev/null || true
}

kept=0 replaced=0
over_old() {
    rm -rf over && build_old over && cp over/dataset.json before.json
    kill_run over "$1" 2 "${new[@]}" over
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
    kill_run fresh "$1" 1 "${new[@]}" fresh
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

# in_place NAME WHICH I GENERATION BEFORE AFTER COMMAND...: COMMAND makes that generation of the dataset `place`, a copy
# of NAME, and is killed. The dataset then has as many triangles as BEFORE or AFTER says; run again it has those of AFTER.
in_place() {
    rm -rf place && cp -r "$1" place
    kill_run place "$2" "$4" "${@:7}"
    if cmp -s "$1/dataset.json" place/dataset.json; then
        expect_good place "$5" "$7 $8, kill $3"
        "${@:7}" >/dev/null 2>"$work/stderr" || complain "$8, kill $3: the next run fails: $(cat "$work/stderr")"
        kept=$((kept + 1))
    else
        replaced=$((replaced + 1))
    fi
    expect_good place "$6" "after $8, kill $3"
    "$preprocess" compact place >/dev/null 2>"$work/stderr" || complain "$8, kill $3: cannot compact"
    expect_clean place "after $8, kill $3"
}
# timed DATASET COMMAND...: sets duration. COMMAND works on `place`.
timed() {
    rm -rf place && cp -r "$1" place
    began=$(date +%s%N)
    "${@:2}" >/dev/null 2>&1
    duration=$(($(date +%s%N) - began))
}
insert=("$preprocess" insert place old.ply)
compact=("$preprocess" compact place)
both=$((new_triangles + old_triangles))
timed reference "${insert[@]}"
cp -r place inserted
kept=0 replaced=0
for ((i = 0; i < kills; ++i)); do in_place reference $((i % 4)) "$i" 2 "$new_triangles" "$both" "${insert[@]}"; done
echo "killed $kills inserts; the old dataset was kept $kept and replaced $replaced times"
timed inserted "${compact[@]}"
kept=0 replaced=0
for ((i = 0; i < kills; ++i)); do in_place inserted $((i % 4)) "$i" 3 "$both" "$both" "${compact[@]}"; done
echo "killed $kills compactions; the old dataset was kept $kept and replaced $replaced times"

# A disk without room, or without room for one more file.
if [ "$(id -u)" != 0 ] || ! mkdir "$small" || ! mount -t tmpfs -o size=64k none "$small" 2>/dev/null; then
    echo "skipped: no small disk without root and mounts"
    finish
    exit
fi
umount "$small"

# run_on_disk OPTIONS: `make_new` the old dataset, on a disk with these; the file that it ends at goes into `ended`.
run_on_disk() {
    local status=0
    mount -t tmpfs -o "$1" none "$small"
    cp -r whole "$small/out"
    make_new "$small/out" >/dev/null 2>"$work/stderr" || status=$?
    sed -i '/^iwalk-/!d' "$work/stderr"  # without the progress
    expect_clean "$small/out" "disk of $1"
    if [ "$status" = 0 ]; then
        expect_good "$small/out" "$made_triangles" "disk of $1"
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

# fill_room KILOBYTES FILE...: with a disk for just a little more each time; it is full at these files.
fill_room() {
    local kilobytes=$1
    while ! run_on_disk "size=${kilobytes}k"; do kilobytes=$((kilobytes * 108 / 100)); done
    expect_ended "${@:2}"
}
fill_disks() {
    local inodes=5
    fill_room $(($(du -sk whole | cut -f1) + 20)) triangles pages-2.bin
    # Each file and directory takes an inode, of which the old dataset has 5. The levels' temporary file, the hierarchy and
    # the new manifest have those of temporary files that are gone by then, as they have their room.
    while ! run_on_disk "nr_inodes=$inodes"; do inodes=$((inodes + 1)); done
    expect_ended .iwalk-lock .iwalk-build triangles pages-2.bin
}
make_new() { "${new[@]}" "$1"; }
made_triangles=$new_triangles
fill_disks
make_new() { "$preprocess" insert "$1" new.ply; }
made_triangles=$both
fill_disks
# Levels that are not simplified go through the levels' temporary file.
"$preprocess" generate hard-point --triangles 400000 -o point.ply >/dev/null 2>&1
make_new() { "$preprocess" build point.ply -o "$1"; }
made_triangles=400000
fill_room 8000 triangles pages-2.bin targets
finish
