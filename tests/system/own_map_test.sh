#!/usr/bin/env bash
# The logs of three days at one place make a map: what stands there is known, each day counts once, and the order of the logs is all the same.
#   own_map_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -euo pipefail
config=$1/config/demo
bin=$2
work=$(mktemp -d -t own_map.XXXXXX)
trap 'rm -rf "$work"' EXIT
cd "$work"
fail() { echo "FAILED: $*" >&2; exit 1; }

day_us=86400000000
for day in 1 2 3; do
  "$bin/lookout-sim" --config "$config" --scene marina --seed 101 --seconds 25 --start-utime-us $((1781532580000000 + day * day_us)) --pcap "day$day.pcap" \
    >said 2>&1 || fail "lookout-sim: $(cat said)"
  "$bin/lookout-replay" --config "$config" --in "day$day.pcap" --out "day$day.lcmlog" >said 2>&1 || fail "lookout-replay: $(cat said)"
done
merge() {  # OUTPUT LOG...
  local out=$1 inputs=() log
  shift
  for log; do inputs+=(--in "$log"); done
  "$bin/lookout-export" "${inputs[@]}" --table map --format geojson --out "$out" >said 2>&1 || fail "lookout-export: $(cat said)"
}

merge map.geojson day1.lcmlog day2.lcmlog day3.lcmlog
[ ! -s said ] || fail "something is amiss: $(cat said)"
grep -q '"type":"thing".*"days":3,"known":true' map.geojson || fail "nothing is known after three days"
grep -q '"type":"land"' map.geojson || fail "there is no land"
if grep -q '"days":[4-9]' map.geojson; then fail "a day counts twice"; fi
merge again.geojson day3.lcmlog day1.lcmlog day2.lcmlog day1.lcmlog
cmp map.geojson again.geojson || fail "the map depends on the order of the logs, or on one that is there twice"
merge two.geojson day1.lcmlog day2.lcmlog
if grep -q '"known":true' two.geojson; then fail "two days are not enough"; fi

# Who takes the map for a part of the config is told where it is made.
cp -r "$config" with_map
echo 'map: "map.geojson"' >>with_map/tracker.txtpb
code=0
"$bin/lookout-tracker" --config with_map --check >said 2>&1 || code=$?
[ "$code" = 2 ] || fail "a config with a map ends with exit code $code: $(cat said)"
grep -q "tracker.txtpb:.*: map: is gone: the tracker reads no map" said || fail "what becomes of the map is not said: $(cat said)"
