#!/usr/bin/env bash
# --memory is kept, however many threads are asked for, and whatever the model.
source "$(dirname "$0")/lib.sh"
preprocess=$bin/iwalk-preprocess
if ldd "$preprocess" | grep -Eq 'lib[at]san'; then
    echo "skipped: sanitizers take memory of their own"
    exit 77
fi
cd "$work"
for scene in plant hard-point hard-slivers; do
    "$preprocess" generate $scene --triangles 600000 -o $scene.ply >/dev/null 2>&1
done

# peak COMMAND...: the most that it had in memory, KiB.
peak() {
    python3 -c 'import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)' "$@"
}
for build in "64 1 plant" "64 4 plant" "128 64 plant" "64 2 hard-point" "64 2 hard-slivers"; do
    read -r mib threads scene <<<"$build"
    kib=$(peak "$preprocess" build $scene.ply -o dataset --memory "${mib}M" --threads "$threads") ||
        complain "no build of $scene with $mib MiB"
    [ "${kib:-0}" -gt 0 ] && [ "$kib" -le $((mib * 1024)) ] ||
        complain "$scene: --memory ${mib}M --threads $threads took ${kib:-?} KiB"
done
finish
