#!/usr/bin/env bash
# Trains SqueezeSeg anew: the set of scans, one training on all families and one without each third of them. Some hours of one core.
#   lab/learned/train.sh [--out DIR] [--set DIR] [--jobs N] [OPTION of train.py ...]
#     --out    folder of the weights (default lab/learned/weights: those of lookout-eval)
#     --set    folder of the scans (default build/learned/set; made where it is not there)
#     --jobs   trainings at a time (default: as many as there are cores); each takes one core
# All else goes to train.py. It needs python3-torch and python3-numpy of Debian, which nothing else needs: installed (apt-get install --no-install-recommends), or as ./dev test slow unpacks them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=lab/learned/weights scans=build/learned/set jobs=$(nproc) options=()
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$2; shift 2 ;;
    --set) scans=$2; shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    *) options+=("$1"); shift ;;
  esac
done
. lab/learned/find_torch.sh
find_torch . || { echo "train.sh: python3-torch is missing: apt-get install --no-install-recommends python3-torch python3-numpy" >&2; exit 1; }
mkdir -p "$scans" "$out"
if [ ! -e "$scans/returns.bin" ]; then
  build/release/bin/lookout-learned --config config/catabot --scenes families --seeds 100 --seconds 0.2 --out "$scans"
fi

# The thirds are those of ./dev leave-out --parts 3: every third family in alphabetical order.
thirds=('' '' '')
i=0
for family in config/scenes/families/*.txtpb; do
  name=$(basename "$family" .txtpb)
  thirds[i % 3]+="${thirds[i % 3]:+,}$name"
  i=$((i + 1))
done

train() {  # NAME [OPTION ...]
  local name=$1
  shift
  echo "== $name" >&2
  OMP_NUM_THREADS=1 $python -B lab/learned/train.py --set "$scans" --out "$out/$name.json" "${options[@]}" "$@"
}
running=()
trap 'kill "${running[@]}" 2>/dev/null || true' EXIT
for part in 0 1 2 3; do
  while [ "$(jobs -pr | wc -l)" -ge "$jobs" ]; do sleep 1; done
  if [ "$part" -eq 0 ]; then
    train all &
  else
    train "without_$part" --without "${thirds[part - 1]}" &
  fi
  running+=($!)
done
for one in "${running[@]}"; do wait "$one"; done
running=()
