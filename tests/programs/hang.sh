#!/usr/bin/env bash
# A supervised wall whose servers hang: it is killed and started again with the last camera and the last settings, also when
# nobody asked for a frame. And a wall that only rests is left alone. Servers with different datasets do not start.
source "$(dirname "$0")/lib.sh"
cd "$work"
make_ply model.ply 40
"$bin/iwalk-preprocess" build model.ply -o dataset --leaf-triangles 200 >/dev/null 2>&1
printf '[wall]\nrows = 1\ncolumns = 2\ntile_px = [160, 120]\n' >wall.toml
echo '{"fov_y_deg": 50, "frames": [{"eye": [20, -9, 12], "target": [20, 20, 0], "up": [0, 0, 1]}]}' >one.json

# Ranks may have their copies at different places, but not different ones.
cp -r dataset copy
"$bin/iwalk-preprocess" build model.ply -o other --leaf-triangles 300 >/dev/null 2>&1
server() { echo "$bin/iwalk-server --wall wall.toml --listen 127.0.0.1:0 --dataset $1"; }
refuses "other on $(hostname) (rank 1) is another dataset, or another state of it, than dataset on $(hostname) (rank 0)" \
    "${launch[@]}" 1 $(server dataset) : -np 1 $(server other)
"${launch[@]}" 1 $(server dataset) : -np 1 $(server copy) >copies 2>errors &
wall=$!
cleanup() { kill -TERM "$wall" 2>/dev/null || true; wait "$wall" 2>/dev/null || true; }
for _ in $(seq 600); do ! grep -q 'listening on' copies || break; sleep 0.1; done
grep -q 'listening on' copies || complain "no wall with a copy of the dataset: $(cat errors)"
cleanup

"$source/scripts/wall" "$work/dataset" --wall wall.toml --bin "$bin" --supervise --hang-timeout 10 -- \
    --present file --out "$work/shown" >log 2>errors &
wall=$!
starts() { grep -c 'listening on' log || true; }
# await TEXT COMMAND...: until the command succeeds, half a minute at the most.
await() {
    local text=$1
    shift
    for _ in $(seq 300); do ! "$@" || return 0; sleep 0.1; done
    complain "$text: $(cat errors)"
}
started() { [ "$(starts)" = "$1" ]; }
await "the wall does not start" started 1
address=$(sed -n 's/.*listening on //p' log)
fly() { timeout 60 "$bin/iwalk-client" --connect "$address" --path one.json --capture "$1" --report "$1.json" >/dev/null; }

# A client that changes a setting and goes.
exec 9<>"/dev/tcp/${address%:*}/${address##*:}"
printf '\x08\0\0\0\x01\0\0\0\x04\0\0\0\x01\0\0\0' >&9                             # Hello
printf '\x18\0\0\0\x08\0\0\0\x01\0\0\0\x0a\x00background\x06\x00102030' >&9  # ChangeSettings
sleep 0.5
exec 9>&-
fly before || complain "the wall does not fly"
grep -q '"background": "#102030"' before.json || complain "a setting did not change: $(grep background before.json)"
sleep 13  # at rest for longer than the timeout
started 1 || complain "a wall at rest was started again: $(cat errors)"

# hang WHICH: stops a server (tail: the last one started) for ever; the wall must come back with the same picture.
hang() {
    local before
    before=$(starts)
    rm -rf shown
    kill -STOP "$(pgrep -f "^[^ ]*iwalk-server.*$work/shown" | "$1" -n 1)"
    await "a server that hangs ($1) is not noticed" started $((before + 1))
    await "the last camera does not come back" test -s shown/frame-000000/tile-0-1.png
    for tile in 0-0 0-1; do
        "$bin/iwalk-compare" "before/frame-000000/tile-$tile.png" "shown/frame-000000/tile-$tile.png" >/dev/null ||
            complain "tile $tile is not as it was before a server hung"
    done
}
hang tail
hang head
[ "$(grep -c 'something hangs' errors)" = 2 ] || complain "not said twice that something hangs: $(cat errors)"
fly after || complain "the wall does not fly after it hung"
grep -q '"background": "#102030"' after.json || complain "the setting is lost"
cleanup
wall=
cleanup() { :; }
sleep 0.5
[ -z "$(pgrep -f "iwalk-server.*$work" || true)" ] || complain "servers still run: $(pgrep -af "iwalk-server.*$work")"
finish
