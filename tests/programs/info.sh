#!/usr/bin/env bash
# What info says, as text, as JSON and as a picture; and that drawing needs no memory of builds.
source "$(dirname "$0")/lib.sh"
preprocess=$bin/iwalk-preprocess
cd "$work"
make_ply model.ply 60
"$preprocess" build model.ply -o dataset --leaf-triangles 500 >/dev/null 2>&1
says() { grep -Eq "$1" text || complain "info does not say '$1': $(cat text)"; }

"$preprocess" info dataset >text
says '^version: +1, generation 1$'
says '^triangles: +7200$'
says '^tree: .* nodes with more than 500 triangles are split$'
says '^ *level full: +7200 triangles, error 0 '
says '^pages: .* ranges of '
"$preprocess" info dataset --json >text
says '"leaf_triangles": 500'
says '"depths": \['
says '"full": \{'
says '"stored_triangles": 7200'

"$preprocess" info dataset --draw picture.png >/dev/null 2>text || complain "info --draw fails: $(cat text)"
says '^picture.png: the model at level full, leaves of depth '
[ "$(head -c 4 picture.png | tail -c 3)" = PNG ] || complain "no PNG was drawn"
refuses nowhere/out.png "$preprocess" info dataset --draw nowhere/out.png
flip dataset/pages-1.bin 2000
refuses page "$preprocess" info dataset --draw bad.png
[ ! -e bad.png ] || complain "a picture of a broken dataset was left behind"
refuses nowhere "$preprocess" info nowhere --draw picture.png

if ldd "$preprocess" | grep -q OpenImageIO; then complain "builds load OpenImageIO"; fi
finish
