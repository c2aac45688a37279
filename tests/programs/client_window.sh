#!/usr/bin/env bash
# The client's window on a display of its own, with keys and mouse from outside: it flies, keeps views, records, changes
# settings, and brings all of that back to servers that were started anew.
source "$(dirname "$0")/lib.sh"
for tool in Xvfb xdotool; do
    command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed (scripts/setup)"; exit 77; }
done
cd "$work"
unset DISPLAY WAYLAND_DISPLAY
refuses "cannot open a window" "$bin/iwalk-client" --connect 127.0.0.1:1

make_ply model.ply 40
"$bin/iwalk-preprocess" build model.ply -o dataset --leaf-triangles 200 >/dev/null 2>&1
printf '[wall]\nrows = 1\ncolumns = 2\ntile_px = [160, 120]\n' >wall.toml

server='' client='' xvfb=''
cleanup() {
    local process
    for process in $client $server $xvfb; do kill -TERM "$process" 2>/dev/null || true; done
    for process in $client $server $xvfb; do wait "$process" 2>/dev/null || true; done
}
# eventually WHAT COMMAND...: the command succeeds within 20 s.
eventually() {
    local what=$1
    shift
    for _ in $(seq 200); do
        "$@" 2>/dev/null && return
        sleep 0.1
    done
    complain "$what: servers said: $(cat errors); client said: $(cat client)"
    finish
}
start_servers() {
    : >log
    setsid "${launch[@]}" 2 "$bin/iwalk-server" --dataset "$work/dataset" --wall wall.toml --listen "127.0.0.1:$1" \
        </dev/null >log 2>errors &
    server=$!
    eventually "no server" grep -q 'listening on' log
    port=$(sed -n 's/.*listening on .*://p' log)
}
# The eyes of a camera path: one line each, without repetitions.
eyes() { tr -d ' \n' <"$1" | grep -o '"eye":\[[^]]*\]' | uniq; }

: >client
Xvfb -displayfd 5 -noreset -screen 0 1280x800x24 -nolisten tcp 5>display >/dev/null 2>&1 &
xvfb=$!
eventually "no display" test -s display
export DISPLAY=:$(cat display)
start_servers 0

"$bin/iwalk-client" --connect "127.0.0.1:$port" --views views.json --record flight.json >client 2>&1 &
client=$!
eventually "no window" xdotool search --onlyvisible --name '^iWalk' windowfocus
eventually "no control" grep -q 'controls' errors

hold() { xdotool keydown "$1"; sleep "$2"; xdotool keyup "$1"; sleep 0.5; }
hold w 0.5
xdotool key ctrl+2
eventually "no view was saved" test -s views.json
view=$(eyes views.json | sed -n 2p)
home=$(eyes views.json | sed -n 1p)
[ -n "$view" ] && [ "$view" != "$home" ] || complain "the camera did not move: $view"
hold d 0.5
# keeps N: the view is kept as number N; kept KEY N: the eye or target of view N.
keeps() { xdotool key "ctrl+$1"; sleep 0.5; }
kept() { tr -d ' \n' <views.json | grep -o "\"$1\":\[[^]]*\]" | sed -n "$2p"; }
keeps 3
xdotool mousemove 600 400 mousedown 1 mousemove 700 380 mouseup 1
sleep 0.5
keeps 4
xdotool mousemove 600 400 mousedown 3 mousemove 500 420 mouseup 3 click 4
sleep 0.5
keeps 5
[ "$(kept eye 3)" = "$(kept eye 4)" ] || complain "looking around moved the eye"
[ "$(kept target 3)" != "$(kept target 4)" ] || complain "the left button does not look around"
[ "$(kept eye 4)" != "$(kept eye 5)" ] || complain "the right button does not orbit"
xdotool key m
eventually "no setting changed" grep -q 'mode = frustum' errors
xdotool key h Tab v
sleep 0.3
xdotool key v h Tab 2
sleep 0.5

# All servers die; new ones are told where the wall was.
kill -KILL -- "-$server" 2>/dev/null || true
wait "$server" 2>/dev/null || true
start_servers "$port"
eventually "settings did not come back" grep -q 'mode = frustum' errors

xdotool key --clearmodifiers ctrl+q
eventually "the window does not close" sh -c "! kill -0 $client"
wait "$client" || complain "the client ends with $?: $(cat client)"
client=
[ -s client ] && complain "the client said: $(cat client)"

[ "$(eyes flight.json | wc -l)" -ge 5 ] || complain "few cameras were recorded: $(eyes flight.json)"
[ "$(eyes flight.json | tail -n 1)" = "$view" ] || complain "the saved view did not come back: $(eyes flight.json | tail -n 1), not $view"
finish
