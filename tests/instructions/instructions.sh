#!/usr/bin/env bash
# Counts the instructions of a step of each kernel of instructions.cpp, and holds them against instructions.txt: a change
# of more than 2% is an error, whatever it does to seconds. So is a generic source that needs more than 1.02 of the step
# written by hand.
#   tests/instructions/instructions.sh [--update] BINARY
# Exits with 77, which CTest calls skipped, where counting is impossible.
set -euo pipefail

update=no
if [[ ${1:-} == --update ]]; then
  update=yes
  shift
fi
binary=$(realpath "${1:?the built kernels, as build/ci/tests/instructions}")
golden=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/instructions.txt
skip() { printf 'skipped: %s\n' "$*"; exit 77; }

command -v valgrind >/dev/null || skip "valgrind is not installed"
grep -q avx2 /proc/cpuinfo || skip "this machine has no AVX2, for which the kernels are compiled"
[[ $(g++ -dumpversion 2>/dev/null | cut -d. -f1) == 12 ]] || skip "the numbers in instructions.txt are those of g++ 12"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=out "$binary" >kernels 2>log || { cat log; exit 1; }
[[ -e out.1 ]] || skip "the kernels were compiled without valgrind/callgrind.h"

# name, instructions of one step
while read -r name steps; do
  dump=$(grep -l "^desc: Trigger: Client Request: $name\$" out.*)
  awk -v name="$name" -v steps="$steps" '/^(summary|totals):/ { count = $2 } END { printf "%s %.1f\n", name, count / steps }' "$dump"
done <kernels >counts

if [[ $update == yes ]]; then
  { grep '^#' "$golden"; cat counts; } >new
  cp new "$golden"
  cat "$golden"
  exit 0
fi
awk '
  FNR == NR { if ($1 !~ /^#/ && NF) golden[$1] = $2; next }
  {
    seen[$1] = $2
    verdict = "ok"
    if (!($1 in golden)) verdict = "not in instructions.txt"
    else if ($2 > 1.02 * golden[$1] || $2 < 0.98 * golden[$1]) verdict = "changed by more than 2%"
    if (verdict != "ok") wrong = 1
    printf "%-32s %9.1f  was %9.1f  %s\n", $1, $2, golden[$1], verdict
  }
  END {
    for (name in golden) if (!(name in seen)) { printf "%-32s is not counted any more\n", name; wrong = 1 }
    ratio = seen["free_body/rk4"] / seen["free_body/rk4/by_hand"]
    printf "generic source / written by hand: %.3f (at most 1.02)\n", ratio
    if (!(ratio <= 1.02)) wrong = 1
    if (wrong) print "If the change is meant: tests/instructions/instructions.sh --update BINARY"
    exit wrong
  }' "$golden" counts
