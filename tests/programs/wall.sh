#!/usr/bin/env bash
# A whole wall: pictures and report along a path; clients that vanish, wait and send garbage; a broken page; a busy port.
source "$(dirname "$0")/lib.sh"
cd "$work"
make_ply model.ply 40
"$bin/iwalk-preprocess" build model.ply -o dataset --leaf-triangles 200 >/dev/null 2>&1
printf '[wall]\nrows = 2\ncolumns = 2\ntile_px = [160, 120]\nbezel_px = [8, 4]\n' >wall.toml
frames=$(for i in 1 2 3 4 5 6; do printf '{"eye": [20, -%d, 12], "target": [20, 20, 0], "up": [0, 0, 1]},' $((8 + i)); done)
echo "{\"fov_y_deg\": 50, \"frames\": [${frames%,}]}" >path.json

# The whole way in one command, and nothing left running.
"$source/scripts/wall" "$work/dataset" --wall wall.toml --bin "$bin" --path path.json --capture pictures --capture-depth \
    --report report.json -- --cache 128k || complain "scripts/wall failed"
for frame in 0 1 2 3 4 5; do
    for tile in 0-0 0-1 1-0 1-1; do
        [ -s "pictures/frame-00000$frame/tile-$tile.png" ] || complain "no picture of tile $tile in frame $frame"
        [ -s "pictures/frame-00000$frame/tile-$tile.exr" ] || complain "no depth of tile $tile in frame $frame"
    done
    [ -s "pictures/frame-00000$frame/wall.png" ] || complain "frame $frame was not stitched"
done
[ "$(grep -c '"visibility_ms"' report.json)" -ge 1 ] || complain "no figures in the report"
"$bin/iwalk-compare" pictures/frame-000000/wall.png pictures/frame-000000/wall.png >/dev/null || complain "a picture differs from itself"
if "$bin/iwalk-compare" pictures/frame-000000/wall.png pictures/frame-000003/wall.png >/dev/null; then
    complain "the camera does not move"
fi
nothing_runs() {
    sleep 0.3
    [ -z "$(pgrep -f "iwalk-server.*$work" || true)" ] || complain "servers still run: $(pgrep -af "iwalk-server.*$work")"
}
nothing_runs

# Free screens have no common picture.
{
    printf '[wall]\neye = [0, 1.2, 0]\n'
    printf '[[screen]]\nname = "%s"\ntop_left = [%s]\ntop_right = [%s]\nbottom_left = [%s]\ntile_px = [160, 120]\n' \
        front '-1, 2, -1' '1, 2, -1' '-1, 0, -1' side '1, 2, -1' '1, 2, 1' '1, 0, -1'
} >cave.toml
"$source/scripts/wall" "$work/dataset" --wall cave.toml --bin "$bin" --path path.json --capture cave || complain "no wall of free screens"
[ -s cave/frame-000005/front.png ] && [ -s cave/frame-000005/side.png ] || complain "no pictures of free screens"
[ ! -e cave/frame-000005/wall.png ] || complain "free screens were stitched"

# A wall of its own for the clients below.
start_wall() {
    : >"$work/log"  # what the last wall said there
    "${launch[@]}" 4 "$bin/iwalk-server" --dataset "$work/$1" --wall wall.toml --listen 127.0.0.1:0 \
        </dev/null >"$work/log" 2>"$work/errors" &
    wall=$!
    until address=$(sed -n 's/.*listening on //p' "$work/log") && [ -n "$address" ]; do
        kill -0 "$wall" || { cat "$work/errors" >&2; exit 1; }
        sleep 0.05
    done
    port=${address##*:}
}
stop_wall() {
    kill -TERM "$wall" 2>/dev/null || true
    wait "$wall" 2>/dev/null || true
    wall=
}
wall=
cleanup() { [ -z "$wall" ] || stop_wall; }
fly() { timeout 60 "$bin/iwalk-client" --connect "$address" --path "${2:-path.json}" --capture "$1" >/dev/null; }
same_as_before() {
    "$bin/iwalk-compare" "$1/frame-000005/wall.png" pictures/frame-000005/wall.png >/dev/null || complain "$2 changed the picture"
}

start_wall dataset
refuses "$port" ranks 4 "$bin/iwalk-server" --dataset dataset --wall wall.toml --listen "127.0.0.1:$port"
fly first || complain "the first client does not fly"
same_as_before first "a second wall"

# One vanishes in the middle, one sends garbage, one is silent, one says only half a message.
repeated=$(for _ in $(seq 60); do echo -n "$frames"; done)
echo "{\"fov_y_deg\": 50, \"frames\": [${repeated%,}]}" >long.json
"$bin/iwalk-client" --connect "$address" --path long.json >/dev/null 2>&1 &
vanishing=$!
sleep 0.3
kill -KILL "$vanishing" 2>/dev/null || true
wait "$vanishing" 2>/dev/null || true
head -c 100000 /dev/urandom >"/dev/tcp/127.0.0.1/$port" 2>/dev/null || true
exec 8<>"/dev/tcp/127.0.0.1/$port" 9<>"/dev/tcp/127.0.0.1/$port"
printf '\x20\x00\x00' >&9
fly second || complain "nobody takes over from a vanished controller"
same_as_before second "bad clients"
exec 8>&- 9>&-
stop_wall

# A server that dies takes the wall with it; --supervise brings it back at the same address, with the same picture.
: >"$work/log"
"$source/scripts/wall" "$work/dataset" --wall wall.toml --bin "$bin" --supervise -- --present file --out "$work/shown" \
    >"$work/log" 2>"$work/errors" &
wall=$!
until address=$(sed -n 's/.*listening on //p' "$work/log") && [ -n "$address" ]; do
    kill -0 "$wall" || { cat "$work/errors" >&2; exit 1; }
    sleep 0.05
done
echo "{\"fov_y_deg\": 50, \"frames\": [${frames%%\},*}}]}" >one.json
fly before one.json || complain "a supervised wall does not fly"
sleep 1  # the camera rests, and is kept
rm -rf shown
victim=$(pgrep -f "iwalk-server.*$work/shown" | tail -1)
kill -KILL "$victim"
for _ in $(seq 200); do [ "$(ls shown/frame-000000/*.png 2>/dev/null | wc -l)" = 4 ] && break; sleep 0.1; done
for tile in 0-0 0-1 1-0 1-1; do
    "$bin/iwalk-compare" "before/frame-000000/tile-$tile.png" "shown/frame-000000/tile-$tile.png" >/dev/null ||
        complain "tile $tile is not as it was before a server died: $(cat "$work/errors")"
done
fly after one.json || complain "a wall that was started again does not take its clients"
stop_wall
nothing_runs

# Nobody waits for ever: a server that hangs at the start is named, and so are all but one that has not even started.
mkdir hanging
mkfifo hanging/dataset.json
server() { echo "$bin/iwalk-server --wall wall.toml --listen 127.0.0.1:0 --dataset $1 --startup-timeout $2"; }
refuses "not ready within 15 s: rank 3 on $(hostname)" "${launch[@]}" 3 $(server dataset 15) : -np 1 $(server hanging 15)
status=0
"${launch[@]}" 3 $(server dataset 3) : -np 1 sleep 60 >/dev/null 2>late || status=$?
[ "$status" = 1 ] || complain "servers that wait for another to start end with exit code $status"
grep -q "rank [012] of 4 on $(hostname) is here" late || complain "nobody says that a server has not started: $(cat late)"
if grep -q 'rank 3 of 4' late; then complain "a program that is no server speaks"; fi

# A page with a flipped byte: the wall draws on without it and says so.
cp -r dataset flipped
flip "$(ls flipped/pages-*.bin)" 1500
start_wall flipped
fly third || complain "a broken page ends the flight"
grep -q 'drawn without page' "$work/errors" || complain "a broken page is not reported: $(cat "$work/errors")"
stop_wall
nothing_runs
finish
