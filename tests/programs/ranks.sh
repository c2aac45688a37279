#!/usr/bin/env bash
# Several tiles a rank: the files are those of a rank for each tile, byte by byte; one cache for all of a rank's tiles.
source "$(dirname "$0")/lib.sh"
cd "$work"
make_ply model.ply 60
"$bin/iwalk-preprocess" build model.ply -o dataset --leaf-triangles 200 >/dev/null 2>&1
printf '[wall]\nrows = 2\ncolumns = 2\ntile_px = [160, 120]\nbezel_px = [8, 4]\n' >wall.toml
frames=$(for i in 1 2 3; do printf '{"eye": [30, -%d, 3], "target": [30, 30, 0], "up": [0, 0, 1]},' $((4 + i)); done)
echo "{\"fov_y_deg\": 50, \"frames\": [${frames%,}]}" >path.json

# fly RANKS NAME OPTION...: pictures, report and what the servers said go to NAME.
fly() {
    local ranks=$1 name=$2
    shift 2
    "$source/scripts/wall" "$work/dataset" --wall wall.toml --ranks "$ranks" --bin "$bin" --path path.json \
        --capture "$name" --report "$name.json" -- --preview-fps 0 "$@" >"$name.log" 2>"$name.errors" ||
        complain "no wall with $ranks ranks ($*): $(cat "$name.errors")"
}
for mode in "frustum" "cplp --occlusion hzb" "cplp --occlusion queries" "plp --plp-budget 1000"; do
    for ranks in 4 3 2 1; do
        fly "$ranks" "$ranks" --mode $mode --present file --out "shown-$ranks"
        [ "$(find "$ranks" "shown-$ranks" -name 'tile-*' | wc -l)" = 24 ] || complain "$ranks ranks: pictures are missing"
        for kind in "$ranks 4" "shown-$ranks shown-4"; do
            diff -rq $kind >different || complain "$ranks ranks, --mode $mode: $(cat different)"
        done
        python3 - "$ranks" <<'PYTHON' || complain "$ranks ranks, --mode $mode: the report is wrong"
import json, sys
ranks = int(sys.argv[1])
mine, four = (json.load(open(f"{n}.json")) for n in (ranks, 4))
places = {1: [0, 0, 0, 0], 2: [0, 0, 1, 1], 3: [0, 1, 2, 2], 4: [0, 1, 2, 3]}[ranks]
same = lambda tile: [tile[key] for key in ("tile", "triangles", "ranges", "hidden_ranges")]
for frame, other in zip(mine["frames"], four["frames"], strict=True):
    assert [tile["rank"] for tile in frame["tiles"]] == places, frame
    assert [same(tile) for tile in frame["tiles"]] == [same(tile) for tile in other["tiles"]]
assert [tile["rank"] for tile in mine["summary"]["tiles"]] == places
hidden = sum(tile["hidden_ranges"] + tile["hidden_pages"] for frame in mine["frames"] for tile in frame["tiles"])
assert (hidden > 0) == (mine["settings"]["mode"] == "cplp"), hidden
drawn = [tile["triangles"] for frame in mine["frames"] for tile in frame["tiles"]]
assert mine["settings"]["mode"] != "plp" or max(drawn) in range(900, 1001), drawn
PYTHON
    done
    rm -rf shown-? ?
done
grep -q 'tiles by rank: tile-0-0 on [^ ,]*, tile-0-1 on [^ ,]*, tile-1-0 on [^ ,]*, tile-1-1 on [^ ,]*$' 4.log ||
    complain "four ranks say: $(cat 4.log)"
grep -q 'tiles by rank: tile-0-0 on [^ ]* (rank 0), tile-0-1 on [^ ]* (rank 1), tile-1-0, tile-1-1 on [^ ]* (rank 2)$' 3.log ||
    complain "three ranks say: $(cat 3.log)"

# Previews come from all tiles of a rank, and a wall that was started again shows the same as before.
cat >previews.py <<'PYTHON'
# The wall's small pictures, by tile: all four of one picture.
import socket, struct, sys
connection = socket.create_connection(("127.0.0.1", int(sys.argv[1])), timeout=30)
hello = struct.pack("<IBBH", 4, 0, 1, 0)  # watches, and wants previews
connection.sendall(struct.pack("<IHH", len(hello), 1, 0) + hello)
stream, pictures = connection.makefile("rb"), {}
while True:
    length, kind, _ = struct.unpack("<IHH", stream.read(8))
    body = stream.read(length)
    if kind != 6: continue
    number, tile, what = struct.unpack_from("<QIB", body)
    assert what == 2 and tile < 4, (what, tile)
    tiles = pictures.setdefault(number, {})
    tiles[tile] = body[13:]
    if len(tiles) == 4: break
for tile, picture in sorted(tiles.items()): print(tile, picture.hex())
PYTHON
"$source/scripts/wall" "$work/dataset" --wall wall.toml --ranks 2 --bin "$bin" --supervise >log 2>errors &
supervisor=$!
cleanup() { kill "$supervisor" 2>/dev/null && wait "$supervisor" || true; }
# eventually TEXT TIMES FILE: it says so, so many times.
eventually() {
    for _ in $(seq 300); do
        [ "$(grep -c "$1" "$3")" -lt "$2" ] || return 0
        sleep 0.1
    done
    complain "no '$1' for $2 times: $(cat log errors)"
    finish
}
eventually 'connect with' 1 log
port=$(sed -n 's/.*listening on .*://p' log | head -1)
"$bin/iwalk-client" --connect "127.0.0.1:$port" --path path.json >/dev/null || complain "a wall of two ranks does not fly"
python3 previews.py "$port" >previews || complain "two ranks of two tiles: no previews"
[ "$(cut -d ' ' -f 2 previews | sort -u | wc -l)" -ge 2 ] || complain "previews are all alike"
sleep 1  # the camera rests, and rank 0 keeps it
kill -KILL "$(pgrep -f "iwalk-server .*$work/dataset" | tail -1)"
eventually 'listening on' 2 log
python3 previews.py "$port" >again || complain "started again: no previews"
cmp -s previews again || complain "started again it shows another picture"
cleanup

# One limit for the process: looking around, each of 4 tiles sees most of 13 MB of pages. Room for 12 MB more makes the
# process 12 MB larger, not four times as much.
"$bin/iwalk-preprocess" generate sphere --triangles 1000000 -o sphere.ply >/dev/null 2>&1
"$bin/iwalk-preprocess" build sphere.ply -o dataset >/dev/null 2>&1
frames=$(for to in '1, 0' '0, 1' '-1, 0' '0, -1'; do printf '{"eye": [0, 0, 0], "target": [%s, 0], "up": [0, 0, 1]},' "$to"; done)
echo "{\"fov_y_deg\": 110, \"frames\": [${frames%,}]}" >path.json
# larger RANKS: MB that the first server grows by.
larger() {
    fly "$1" small --mode frustum --cache 2M
    fly "$1" large --mode frustum --cache 14M
    python3 -c '
import json
small, large = (json.load(open(f"{n}.json"))["summary"]["tiles"][0]["peak_rss_bytes"] for n in ("small", "large"))
print((large - small) >> 20)'
}
one=$(larger 1) each=$(larger 4)
if [ "$one" -lt 8 ] || [ "$one" -gt 18 ]; then complain "12 MB more for a rank of 4 tiles: it grows by $one MB (one tile: $each MB)"; fi

# What cannot be is said in a line.
server="$bin/iwalk-server --dataset dataset --listen 127.0.0.1:0"
refuses "4 tiles, but there are 5 ranks" ranks 5 $server --wall wall.toml
{ cat wall.toml; printf 'host = [["nowhere", "%s"], ["%s", "%s"]]\n' "$(hostname)" "$(hostname)" "$(hostname)"; } >host.toml
refuses "wants tile 'tile-0-0' on host 'nowhere', where no rank is (ranks: 2 on $(hostname))" ranks 2 $server --wall host.toml
finish
