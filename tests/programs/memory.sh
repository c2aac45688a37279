#!/usr/bin/env bash
# --memory is kept, however many threads are asked for.
source "$(dirname "$0")/lib.sh"
preprocess=$bin/iwalk-preprocess
if ldd "$preprocess" | grep -Eq 'lib[at]san'; then
    echo "skipped: sanitizers take memory of their own"
    exit 77
fi
cd "$work"
"$preprocess" generate plant --triangles 600000 -o plant.ply >/dev/null 2>&1

# peak COMMAND...: the most that it had in memory, KiB.
peak() {
    python3 -c 'import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)' "$@"
}
for limit in "64 1" "64 4" "128 64"; do
    read -r mib threads <<<"$limit"
    kib=$(peak "$preprocess" build plant.ply -o dataset --memory "${mib}M" --threads "$threads") ||
        complain "no build with $mib MiB"
    [ "${kib:-0}" -gt 0 ] && [ "$kib" -le $((mib * 1024)) ] ||
        complain "--memory ${mib}M --threads $threads took ${kib:-?} KiB"
done
finish
