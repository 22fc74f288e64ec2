#!/usr/bin/env bash
# The figures of ALERTS.md, measured anew: a part of ./dev figures, alone ./dev alert-figures. Half an hour on one core; the tables are the same each time, but for the date.
#   lab/eval/alert_figures.sh [SEEDS [BERTH_SECONDS]]   seeds of each scene (default 3), seconds of each seed in a berth (default 400)
# The captures of the second world lie beside the project; where they do not, the figures say so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
recordings=../shared/data
berths=config/scenes/encounters
build/release/bin/lookout-eval --config config/catabot --alerts --scenes all families "$berths"/moored.txtpb "$berths"/moored_dense.txtpb \
  "$berths"/moored_fairway.txtpb --seeds "${1:-3}" --seconds 60 --berth-seconds "${2:-400}" --jobs "$(nproc)" \
  --captures "$recordings/second_world" "$recordings/second_world_long" --blocks lab/eval/ALERTS.md
