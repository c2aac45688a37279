# What the program tests share. Each test script is called with the directory of the programs and that of the sources.
set -euo pipefail
bin=$1 source=$2
work=$(mktemp -d)
trap 'status=$?; cleanup; rm -rf "$work"; exit $status' EXIT
trap 'exit 143' TERM INT
cleanup() { :; }
failures=0

export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_btl_vader_single_copy_mechanism=none HWLOC_COMPONENTS=-gl
export LP_NUM_THREADS=0

complain() {
    echo "FAILED: $1" >&2
    failures=$((failures + 1))
}
finish() {
    [ "$failures" = 0 ] || { echo "$failures checks failed" >&2; exit 1; }
    echo "all checks passed"
}

# refuses TEXT COMMAND...: the command ends with exit code 1 and one line of its own on standard error that holds TEXT.
refuses() {
    local text=$1 status=0
    shift
    "$@" >"$work/stdout" 2>"$work/stderr" || status=$?
    [ "$status" = 1 ] || complain "exit code $status, not 1: $*"
    [ "$(grep -c '^iwalk-' "$work/stderr")" = 1 ] || complain "not one line: $* said: $(cat "$work/stderr")"
    grep -qF -- "$text" "$work/stderr" || complain "no '$text': $* said: $(cat "$work/stderr")"
}

launch=(timeout 120 mpirun --quiet --oversubscribe --bind-to none -np)
ranks() { "${launch[@]}" "$@" </dev/null; }

# A closed grid of triangles as ASCII PLY: small, and of more than one page with --leaf-triangles 100.
make_ply() {
    awk -v n="${2:-20}" 'BEGIN {
        print "ply\nformat ascii 1.0\nelement vertex " (n + 1) * (n + 1) "\nproperty float x\nproperty float y\nproperty float z"
        print "element face " 2 * n * n "\nproperty list uchar int vertex_indices\nend_header"
        for (y = 0; y <= n; ++y) for (x = 0; x <= n; ++x) print x, y, sin(x * 0.7) * cos(y * 0.5)
        for (y = 0; y < n; ++y) for (x = 0; x < n; ++x) {
            a = y * (n + 1) + x
            print 3, a, a + 1, a + n + 1
            print 3, a + 1, a + n + 2, a + n + 1
        }
    }' >"$1"
}

# flip FILE OFFSET: inverts one byte.
flip() {
    local byte
    byte=$(od -An -tu1 -j "$2" -N 1 "$1" | tr -d ' ')
    printf "\\x$(printf %02x $((byte ^ 255)))" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none
}
