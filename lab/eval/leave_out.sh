#!/usr/bin/env bash
# Fits the evidence of the lookout method without each family in turn, and scores it there, beside the peers: ./dev leave-out.
#   lab/eval/leave_out.sh [--out DIR] [--jobs N] [--keep] [--eval-seeds N] [--families NAME,NAME] [--parts N] [--tracks] [OPTION of lookout-fit ...]
#     --out          folder of the evidence and the tables (default build/leave-out)
#     --jobs         fits at a time (default: as many as there are cores)
#     --keep         evidence that is there already is not fitted again: after a change of what is scored, not of what is fitted
#     --eval-seeds   layouts of each family that are scored (default 60)
#     --families     left out, one after the other (default all)
#     --parts        so many fits, each without as many of the families: 3 take minutes where one fit for each family takes half an hour
#     --tracks       scores labels over time, by the boat's tracks, in place of single scans: 20 s of 4 layouts of each family
# All else goes to lookout-fit: its seeds (of 1 to 100), its length of a scene, its trees. Families that are not left out are always fitted on.
# The captures of the second world, which nothing is fitted on, lie beside the project, or where LOOKOUT_CAPTURES says.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=build/leave-out keep='' jobs=$(nproc) seeds='' families='' parts='' tracks='' fit_options=()
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$2; shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    --keep) keep=1; shift ;;
    --eval-seeds) seeds=$2; shift 2 ;;
    --families) families=$2; shift 2 ;;
    --parts) parts=$2; shift 2 ;;
    --tracks) tracks=1; shift ;;
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
# Families that are left out of one fit, separated by commas; nothing: all are fitted on.
groups=('')
IFS=, read -r -a left_out <<<"$families"
for i in "${!left_out[@]}"; do
  group=$((1 + i % ${parts:-${#left_out[@]}}))
  groups[group]+="${groups[group]:+,}${left_out[$i]}"
done
fits=()
trap 'kill "${fits[@]}" 2>/dev/null || true' EXIT
for group in "${groups[@]}"; do
  while [ "$(jobs -pr | wc -l)" -ge "$jobs" ]; do sleep 1; done
  if [ -z "$group" ]; then
    if [ -n "$tracks" ]; then continue; fi  # only families that are left out are run
    fit "$out/all.txtpb" &
  else
    fit "$out/without-${group%%,*}.txtpb" --without "$group" &
  fi
  fits+=($!)
done
for one in "${fits[@]}"; do wait "$one"; done
fits=()
for group in "${groups[@]}"; do
  IFS=, read -r -a others <<<"$group"
  for family in "${others[@]:1}"; do cp "$out/without-${others[0]}.txtpb" "$out/without-$family.txtpb"; done
done

score=("$bin/lookout-eval" --config config/catabot --scenes "$families" --leave-out "$families" --weights "$out" --csv "$out/tables" --force)
if [ -n "$tracks" ]; then
  "${score[@]}" --tracks --seeds "${seeds:-4}" --seconds 20 --blocks lab/eval/TRACKS.md | tee "$out/tables.txt"
else
  "${score[@]}" --methods ours,peers --blocks lab/learned/README.md --seeds "${seeds:-60}" --seconds 0.3 --captures "${LOOKOUT_CAPTURES:-../shared/data/second_world}" | tee "$out/tables.txt"
fi
