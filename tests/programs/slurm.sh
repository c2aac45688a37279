#!/usr/bin/env bash
# scripts/wall.slurm without Slurm: scontrol says what a job of two hosts would hear, and mpirun notes what it was called
# with and starts the servers here.
source "$(dirname "$0")/lib.sh"
cd "$work"
make_ply model.ply 20
"$bin/iwalk-preprocess" build model.ply -o dataset >/dev/null 2>&1
printf '[wall]\nrows = 1\ncolumns = 2\ntile_px = [64, 48]\n' >wall.toml
echo '{"fov_y_deg": 50, "frames": [{"eye": [10, -9, 12], "target": [10, 10, 0], "up": [0, 0, 1]}]}' >one.json

mkdir fake
cat >fake/scontrol <<TEXT
#!/bin/sh
case "\$1 \$2 \$3" in
    "show job 42") printf 'JobId=42 JobName=iwalk\n   Command=$source/scripts/wall.slurm dataset\n   WorkDir=/\n' ;;
    "show hostnames left,right[7-8]") printf 'left\nright7\nright8\n' ;;
    *) echo "scontrol: what is \$*?" >&2; exit 1 ;;
esac
TEXT
cat >fake/mpirun <<TEXT
#!/bin/bash
printf '%s\n' "\$@" >>$work/called
options=()
while [ \$# -gt 0 ]; do
    if [ "\$1" = --host ]; then shift; else options+=("\$1"); fi
    shift
done
exec env -u SLURM_JOB_ID -u SLURM_JOB_NODELIST $(command -v mpirun) "\${options[@]}"
TEXT
chmod +x fake/*

status=0
"$source/scripts/wall.slurm" dataset --wall wall.toml >/dev/null 2>errors || status=$?
[ "$status" = 1 ] || complain "outside of a job: exit code $status"
grep -q 'no Slurm job' errors || complain "outside of a job: $(cat errors)"

export SLURM_JOB_ID=42 SLURM_JOB_NODELIST='left,right[7-8]' SLURM_SUBMIT_DIR=$work
cp "$source/scripts/wall.slurm" slurm_script  # as Slurm does
# slurm ARGUMENT...: a job, until its wall listens.
job=
cleanup() {
    [ -z "$job" ] || { kill -TERM "$job" 2>/dev/null || true; wait "$job" 2>/dev/null || true; }
    job=
}
slurm() {
    : >called; : >log  # the last job must not be taken for this one
    PATH=$work/fake:$PATH ./slurm_script "$work/dataset" --wall wall.toml --bin "$bin" "$@" >log 2>errors &
    job=$!
    for _ in $(seq 600); do
        ! grep -q 'connect with' log || return 0
        kill -0 "$job" || break
        sleep 0.1
    done
    complain "no wall: $(cat errors)"
}
called_with() { grep -qxF -- "$1" called || complain "mpirun was not called with $1: $(tr '\n' ' ' <called)"; }

# Another port than the usual one, in case that one is taken here.
slurm --listen 127.0.0.1:0 --hang-timeout 600 -- --max-fps 50
called_with left:1,right7:1,right8:1
called_with --resume
called_with --max-fps
called_with "$work/iwalk-42.token"
[ "$(stat -c %a iwalk-42.token)" = 600 ] || complain "others can read the token"
address=$(sed -n 's/.*listening on //p' log)
"$bin/iwalk-client" --connect "$address" --token-file iwalk-42.token --path one.json >/dev/null || complain "the wall does not fly"
# The job's end is a SIGTERM.
cleanup
sleep 0.5
[ -z "$(pgrep -f "iwalk-server.*$work" || true)" ] || complain "servers outlive the job: $(pgrep -af "iwalk-server.*$work")"

cp iwalk-42.token before.token
(umask 077; echo a-secret-of-its-own >own.token)
export SLURM_NTASKS_PER_NODE=2
slurm --listen 127.0.0.1:0 --token-file own.token
called_with left:2,right7:2,right8:2
called_with own.token
cmp -s iwalk-42.token before.token || complain "the job's token changed"
cleanup

# Without --listen, the host's own address.
mine=$(hostname --all-ip-addresses | awk '{ print $1 }')
if [ -n "$mine" ]; then
    PATH=$work/fake:$PATH timeout 60 ./slurm_script "$work/dataset" --wall wall.toml --bin "$bin" -- --nonsense >log 2>errors || true
    called_with "$mine:7117"
fi
finish
