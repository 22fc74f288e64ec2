#!/usr/bin/env bash
# The figures of own motion by the lidar (services/odometer/README.md, services/navigator/README.md, NAVIGATION.md): with GNSS and heading, through a gap
# of both, and tracks with and without a place on the earth.
#   lab/eval/navigation_figures.sh [SEEDS [SECONDS_OF_TRACKS]]   seeds of each scene from 101 on (default 20: three hours on one core), and the length of
#                                                                each run whose tracks are scored (default 20)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
evaluate() { build/release/bin/lookout-eval --config config/demo --seeds "${seeds}" --first-seed 101 "$@"; }
seeds=${1:-20}
seconds=${2:-20}

evaluate --navigation --scenes lake,marina,canal,islands,open_water,crossing
echo "== own motion beside KISS-ICP"
evaluate --navigation --kiss-icp --scenes lake,marina,canal,islands,open_water
echo "== tracks, with GNSS and heading"
evaluate --tracks --scenes lake,marina,canal,islands --seconds "$seconds"
echo "== tracks, without"
evaluate --tracks --without-earth --scenes lake,marina,canal,islands --seconds "$seconds"
