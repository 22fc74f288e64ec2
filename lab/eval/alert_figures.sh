#!/usr/bin/env bash
# The figures of ALERTS.md, measured anew: a part of ./dev figures, alone ./dev alert-figures. Half an hour on one core; the tables are the same each time, but for the date.
#   lab/eval/alert_figures.sh [SEEDS [BERTH_SECONDS]]        seeds of each scene (default 3), seconds of each seed in a berth (default 400)
#   lab/eval/alert_figures.sh long [SEEDS [BERTH_SECONDS]]   the long runs (default 5 and 300): three berths and all families on the own simulator
# The captures of the second world lie beside the project; where they do not, the figures say so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
recordings=../shared/data
berths=config/scenes/encounters
judge=(build/release/bin/lookout-eval --config config/catabot --alerts --seconds 60 --jobs "$(nproc)" --blocks lab/eval/ALERTS.md)
if [ "${1:-}" = long ]; then
  exec "${judge[@]}" --long --scenes families "$berths"/moored.txtpb "$berths"/moored_dense.txtpb "$berths"/moored_fairway.txtpb \
    --seeds "${2:-5}" --berth-seconds "${3:-300}" "${@:4}"
fi
exec "${judge[@]}" --scenes all families "$berths"/moored.txtpb "$berths"/moored_dense.txtpb "$berths"/moored_fairway.txtpb \
  --seeds "${1:-3}" --berth-seconds "${2:-400}" --captures "$recordings/second_world" "$recordings/second_world_long" "${@:3}"
