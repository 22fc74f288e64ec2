#!/usr/bin/env bash
# SqueezeSeg in C++ gives the probabilities that PyTorch gives, on 100 scans and more; a training run twice gives the same weights.
#   learned_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -euo pipefail
. "$1/lab/learned/find_torch.sh"
find_torch "$1" || { echo 'skipped: python3-torch is not installed, and ./dev test slow could not unpack it'; exit 77; }
work=$(mktemp -d -t learned.XXXXXX)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
export OMP_NUM_THREADS=1
learned=$1/lab/learned

mkdir "$work/set" "$work/tiny"
"$2/lookout-learned" --config "$1/config/catabot" --scenes families --first-seed 95 --seeds 6 --weights "$learned/weights/all.json" --out "$work/set" 2>/dev/null
said=$($python -B "$learned/compare.py" "$work/set" "$learned/weights/all.json") || fail "C++ and PyTorch differ: $said"
echo "$said"
[ "${said%% *}" -ge 100 ] || fail "these are fewer than 100 scans: $said"

"$2/lookout-learned" --config "$1/config/catabot" --scenes beach,rough --seeds 2 --out "$work/tiny" 2>/dev/null
train() {  # NAME SEED
  $python -B "$learned/train.py" --set "$work/tiny" --steps 3 --batch 8 --seed "$2" --out "$work/$1.json" 2>/dev/null || fail "the training ended with $?"
}
train one 1
train again 1
train other 2
cmp "$work/one.f16" "$work/again.f16" || fail "the same training gave other weights"
cmp -s "$work/one.f16" "$work/other.f16" && fail "another seed gave the same weights"
cmp "$work/one.csv" "$work/again.csv" || fail "the same training gave another curve"
echo "trained twice: the same weights"
