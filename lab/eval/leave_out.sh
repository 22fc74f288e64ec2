#!/usr/bin/env bash
# Fits the evidence of the lookout method without each family in turn, and scores it there, beside the peers: ./dev leave-out.
#   lab/eval/leave_out.sh [--out DIR] [--jobs N] [--keep] [--eval-seeds N] [--families NAME,NAME] [OPTION of lookout-fit ...]
#     --out          folder of the evidence and the tables (default build/leave-out)
#     --jobs         fits at a time (default: as many as there are cores)
#     --keep         evidence that is there already is not fitted again: after a change of what is scored, not of what is fitted
#     --eval-seeds   layouts of each family that are scored (default 60)
#     --families     left out, one after the other (default all)
# All else goes to lookout-fit: its seeds (of 1 to 100), its length of a scene, its trees. Families that are not left out are always fitted on.
# The captures of the second world, which nothing is fitted on, lie beside the project, or where LOOKOUT_CAPTURES says.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=build/leave-out keep='' jobs=$(nproc) seeds=60 families='' fit_options=()
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$2; shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    --keep) keep=1; shift ;;
    --eval-seeds) seeds=$2; shift 2 ;;
    --families) families=$2; shift 2 ;;
    *) fit_options+=("$1"); shift ;;
  esac
done
bin=build/release/bin
if [ -z "$families" ]; then
  families=$(cd config/scenes/families && printf '%s,' *.txtpb)
  families=${families//.txtpb/}
  families=${families%,}
fi
mkdir -p "$out"

fit() {  # FILE [OPTION ...]
  local file=$1
  shift
  if [ -n "$keep" ] && [ -e "$file" ]; then return; fi
  echo "== $file" >&2
  "$bin/lookout-fit" --config config/catabot --scenes families "${fit_options[@]}" "$@" --out "$file" --force >"${file%.txtpb}.log"
}
fits=()
trap 'kill "${fits[@]}" 2>/dev/null || true' EXIT
IFS=, read -r -a left_out <<<"$families"
for family in '' "${left_out[@]}"; do
  while [ "$(jobs -pr | wc -l)" -ge "$jobs" ]; do sleep 1; done
  if [ -z "$family" ]; then fit "$out/all.txtpb" & else fit "$out/without-$family.txtpb" --without "$family" & fi
  fits+=($!)
done
for one in "${fits[@]}"; do wait "$one"; done
fits=()

"$bin/lookout-eval" --config config/catabot --scenes "$families" --leave-out "$families" --weights "$out" --methods ours,peers --seeds "$seeds" --seconds 0.3 \
  --captures "${LOOKOUT_CAPTURES:-../shared/data/second_world}" --csv "$out/tables" --force | tee "$out/tables.txt"
