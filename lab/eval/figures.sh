#!/usr/bin/env bash
# The figures of the README files, measured anew: ./dev figures. An hour on one core; the tables are the same each time, but for times and date.
#   lab/eval/figures.sh [SEEDS]   seeds of each scene (default 20)
# The captures of the second world lie beside the project, or where LOOKOUT_CAPTURES says; where they do not, the figures say so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mapfile -t readmes < <(git grep -l '^<!-- figures: ' -- '*.md')
evaluate() { build/release/bin/lookout-eval --config config/catabot --scenes all --blocks "${readmes[@]}" "$@"; }

evaluate --captures "${LOOKOUT_CAPTURES:-../shared/data/second_world}" --methods all --seeds "${1:-20}" --seconds 1 --test 1,2,3
evaluate --seeds 4 --seconds 0.6 \
  --sweep link_m=0.2:0.4:0.1 --sweep merge_log_odds=-2:2:1

recordings=../shared/data
tracks() {
  build/release/bin/lookout-eval --config config/catabot --tracks --scenes all --captures "${LOOKOUT_CAPTURES:-$recordings/second_world}" \
    "$recordings/second_world_long" --blocks "${readmes[@]}" "$@"
}
tracks --seeds "${1:-20}"
tracks --seeds 4 --ablation
if [ -d "$recordings/autoferry" ]; then
  build/release/bin/lookout-eval --autoferry "$recordings/autoferry" --blocks "${readmes[@]}"
fi
lab/eval/alert_figures.sh
