#!/usr/bin/env bash
# A wall in windows: what the display shows is what the headless wall draws, and people can end it.
source "$(dirname "$0")/lib.sh"
for program in Xvfb xdotool import; do
    command -v $program >/dev/null || { echo "skipped: there is no $program (scripts/setup installs it)"; exit 77; }
done
cd "$work"
xvfb='' wall=''
cleanup() {
    for process in $wall $xvfb; do kill -TERM "$process" 2>/dev/null || true; done
    wait 2>/dev/null || true
}
Xvfb -displayfd 3 -br -noreset -nolisten tcp -screen 0 640x480x24 3>display 2>/dev/null &
xvfb=$!
for _ in $(seq 200); do [ -s display ] && break; sleep 0.05; done
DISPLAY=:$(cat display)
export DISPLAY

make_ply model.ply 40
"$bin/iwalk-preprocess" build model.ply -o dataset --leaf-triangles 200 >/dev/null 2>&1
printf '[wall]\nrows = 2\ncolumns = 2\ntile_px = [160, 120]\nbezel_px = [8, 4]\n' >wall.toml
echo '{"fov_y_deg": 50, "frames": [{"eye": [20, -9, 12], "target": [20, 20, 0], "up": [0, 0, 1]}]}' >path.json

# start_wall NAME OPTION...: returns when a client can connect, or with --pattern when the windows are there.
servers=4
start_wall() {
    local log=$1
    shift
    "${launch[@]}" $servers "$bin/iwalk-server" --wall wall.toml "$@" </dev/null >"$log" 2>"$log.errors" &
    wall=$!
}
listening() {
    until address=$(sed -n 's/.*listening on //p' "$1") && [ -n "$address" ]; do
        kill -0 "$wall" || { cat "$1.errors" >&2; exit 1; }
        sleep 0.05
    done
}
fly() { timeout 60 "$bin/iwalk-client" --connect "$address" --path path.json --capture "$1" >/dev/null; }
ends() {
    for _ in $(seq 100); do kill -0 "$wall" 2>/dev/null || break; sleep 0.1; done
    if kill -0 "$wall" 2>/dev/null; then complain "$1 does not end the wall"; kill -TERM "$wall"; fi
    wait "$wall" || complain "a wall that was ended by $1 says that it failed"
    wall=
}
# shows PICTURE WHAT: the display's top left corner is the picture, soon.
shows() {
    local width height
    read -r width height < <(identify -format '%w %h\n' "$1")
    for _ in $(seq 40); do
        import -silent -window root -crop "${width}x$height+0+0" +repage png24:shot.png
        "$bin/iwalk-compare" "$1" shot.png >/dev/null 2>&1 && return
        sleep 0.1
    done
    complain "$2: the display does not show $1: $("$bin/iwalk-compare" "$1" shot.png 2>&1)"
}

start_wall headless --dataset dataset --listen 127.0.0.1:0
listening headless
fly headless-pictures || complain "the headless wall does not draw"
kill -TERM "$wall"; wait "$wall" || true

start_wall windows --dataset dataset --listen 127.0.0.1:0 --present window
listening windows
fly windows-pictures || complain "the wall in windows does not draw"
"$bin/iwalk-compare" headless-pictures/frame-000000/wall.png windows-pictures/frame-000000/wall.png >/dev/null ||
    complain "captures of windows differ from those without"
shows headless-pictures/frame-000000/wall.png "four windows"

# A picture that the display has lost comes back without a new frame.
comes_back() {
    local window
    window=$(xdotool search --name tile-1-0 | head -1)
    xdotool windowunmap --sync "$window"
    xdotool windowmap --sync "$window"
    shows headless-pictures/frame-000000/wall.png "$1"
}
comes_back "after unmapping a window"
xdotool mousemove 250 200 key Escape
ends Escape

# One server shows all four tiles, then two show two each.
for servers in 1 2; do
    start_wall "shared-$servers" --dataset dataset --listen 127.0.0.1:0 --present window
    listening "shared-$servers"
    fly "shared-$servers-pictures" || complain "$servers servers with windows do not draw"
    "$bin/iwalk-compare" headless-pictures/frame-000000/wall.png "shared-$servers-pictures/frame-000000/wall.png" >/dev/null ||
        complain "captures of $servers servers' windows differ"
    shows headless-pictures/frame-000000/wall.png "four windows of $servers servers"
    if [ $servers = 1 ]; then
        comes_back "after unmapping a window of a server with four"
        fly again || complain "a server with four windows does not draw again"
        shows headless-pictures/frame-000000/wall.png "the next frame of a server with four windows"
    fi
    xdotool mousemove 250 200 key Escape
    ends "Escape in the last of $servers servers' windows"
done
servers=4

# Test patterns: no dataset, no client; the same in files and in windows.
for pattern in grid identity blend; do
    ranks 4 "$bin/iwalk-server" --wall wall.toml --pattern "$pattern" --present file --out "$pattern" || complain "no pattern $pattern"
done
convert -size 328x244 xc:black grid/frame-000000/tile-0-0.png -geometry +0+0 -composite \
    grid/frame-000000/tile-0-1.png -geometry +168+0 -composite grid/frame-000000/tile-1-0.png -geometry +0+124 -composite \
    grid/frame-000000/tile-1-1.png -geometry +168+124 -composite png24:grid.png
ranks 1 "$bin/iwalk-server" --wall wall.toml --pattern grid --present file --out grid-1 || complain "no pattern of one server"
diff -r grid grid-1 >/dev/null || complain "one server's grid is another"
for servers in 4 1; do
    start_wall pattern --pattern grid --present window
    shows grid.png "the grid pattern of $servers servers"
    xdotool mousemove 20 20 key Escape
    ends "Escape in a pattern"
done

# What cannot be shown is said in one line.
printf '[wall]\nrows = 1\ncolumns = 1\ntile_px = [160, 120]\nmonitor = "DP-7"\n' >monitor.toml
refuses "no monitor 'DP-7'" "$bin/iwalk-server" --wall monitor.toml --pattern grid --present window
printf "[wall]\nrows = 1\ncolumns = 1\ntile_px = [160, 120]\ndisplay = \":4711\"\n" >display.toml
refuses "X display :4711" "$bin/iwalk-server" --wall display.toml --pattern grid --present window
printf "[wall]\nrows = 1\ncolumns = 2\ntile_px = [160, 120]\ndisplay = [[\"$DISPLAY\", \":4711\"]]\n" >displays.toml
refuses "start a rank for each display" "$bin/iwalk-server" --wall displays.toml --pattern grid --present window
printf "[wall]\nrows = 1\ncolumns = 2\ntile_px = [160, 120]\ndisplay = [[\"$DISPLAY.0\", \"$DISPLAY\"]]\n" >displays.toml
ranks 1 "$bin/iwalk-server" --wall displays.toml --pattern grid --present window >one 2>&1 &
wall=$!
for _ in $(seq 100); do [ "$(xdotool search --name 'tile-0-' 2>/dev/null | wc -l)" = 2 ] && break; sleep 0.1; done
xdotool mousemove 20 20 key Escape
ends "Escape on one display under two names"
finish
