#!/bin/sh
# Fuzzes each parser in turn: fuzz.sh [PARSER...]; all without a name.
#
#   FUZZ_SECONDS=60       how long each, or
#   FUZZ_INPUTS=1000000   how many inputs each
#   FUZZ_TARGET           where it is built and what it found is kept [target/fuzz]
#
# An input that makes a parser panic, abort, take more than a second or more than 2 GB is kept in
# $FUZZ_TARGET/found/PARSER/default/{crashes,hangs}; the status is 1 then. To try one: $FUZZ_TARGET/debug/lunula-fuzz PARSER < FILE.
# Once mended, it goes to tests/corpus/PARSER/, small: cargo afl tmin -i FILE -o SMALL -- $FUZZ_TARGET/debug/lunula-fuzz PARSER.
set -eu
cd "$(dirname "$0")/../.."
target=${FUZZ_TARGET:-target/fuzz}
mkdir -p "$target"
target=$(cd "$target" && pwd)
export CARGO_TARGET_DIR="$target" PATH="$target/tools/bin:$PATH"
# Compiled three times as fast as with 3.
export AFL_OPT_LEVEL="${AFL_OPT_LEVEL:-1}"
# The machine is taken as it is: no settings of its processors or of where the kernel puts cores are asked for.
export AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_SKIP_CPUFREQ=1 AFL_NO_AFFINITY=1 AFL_NO_UI=1 AFL_QUIET=1 AFL_AUTORESUME=1
# A parser that works on several threads takes other ways each time.
export RAYON_NUM_THREADS=1
command -v cargo-afl >/dev/null || cargo install cargo-afl --version 0.18.2 --locked --root "$target/tools" --target-dir "$target/tools/build"
cargo afl build --locked -p lunula-fuzz
program=$target/debug/lunula-fuzz
memory=/dev/shm
[ -d "$memory" ] || memory=${TMPDIR:-/tmp}
TMPDIR=$(mktemp -d "$memory/lunula-fuzz.XXXXXX")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
if [ -n "${FUZZ_INPUTS:-}" ]; then until="-E $FUZZ_INPUTS"; else until="-V ${FUZZ_SECONDS:-60}"; fi
[ $# -gt 0 ] || set -- $("$program")
status=0
for parser; do
  seeds=tests/corpus/$parser
  found=$target/found/$parser
  mkdir -p "$found"
  # Words of the seeds, and numbers at the edges.
  {
    cat "$seeds"/* | LC_ALL=C grep -aoE '[A-Za-z][A-Za-z0-9_]{2,30}' | sort -u | head -n 300 | sed 's/.*/"&"/'
    for word in -1 0 1e308 1e-320 1e10 nan inf 255 256 65535 4294967296 9223372036854775807; do echo "\"$word\""; done
  } >"$found.dict"
  cargo afl fuzz $until -t 1000 -m 2048 -x "$found.dict" -i "$seeds" -o "$found" -- "$program" "$parser" >"$found.log" 2>&1 ||
    { tail -n 20 "$found.log" >&2; exit 2; }
  of() { sed -n "s/^$1 *: *//p" "$found/default/fuzzer_stats"; }
  echo "$parser: $(of execs_done) inputs in $(of run_time) s, $(of corpus_count) ways found, $(of saved_crashes) crashes, $(of saved_hangs) hangs"
  [ "$(of saved_crashes)$(of saved_hangs)" = 00 ] || status=1
done
exit $status
