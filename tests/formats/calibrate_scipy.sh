#!/usr/bin/env bash
# The last fit of lookout-calibrate, repeated by scipy's least_squares on the same pairs of scans.
#   calibrate_scipy.sh SOURCE_FOLDER PROGRAM_FOLDER
set -euo pipefail
python=/usr/bin/python3  # Debian's, which has Debian's packages
[ -x $python ] && $python -c 'import scipy' 2>/dev/null || { echo 'skipped: python3-scipy is not installed'; exit 77; }
work=$(mktemp -d -t scipy.XXXXXX)
trap 'rm -rf "$work"' EXIT
for scene in marina islands; do
  "$2/lookout-sim" --config "$1/config/demo" --scene $scene --seed 1 --seconds 60 --pcap "$work/$scene.pcap" >/dev/null
  "$2/lookout-calibrate" --config "$1/config/demo" --in "$work/$scene.pcap" --pairs "$work/$scene.csv" >/dev/null
  $python "$1/tests/formats/calibrate_scipy.py" "$work/$scene.csv"
done
