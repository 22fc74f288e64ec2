#!/usr/bin/env bash
# Three days at one place make a map; the fourth begins with it: what stands is known, alerts are the same as without it, and its log is computed again
# without the file.
#   own_map_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -euo pipefail
config=$1/config/demo
bin=$2
work=$(mktemp -d -t own_map.XXXXXX)
trap 'rm -rf "$work"' EXIT
cd "$work"
fail() { echo "FAILED: $*" >&2; exit 1; }

day_us=86400000000
make_capture() {  # DAY; 25 s of them, 5 s of a new minute
  "$bin/lookout-sim" --config "$config" --scene marina --seed 101 --seconds 25 --start-utime-us $((1781532580000000 + $1 * day_us)) --pcap "day$1.pcap" \
    >said 2>&1 || fail "lookout-sim: $(cat said)"
}
replay() {  # CONFIG INPUT OUTPUT
  "$bin/lookout-replay" --config "$1" --in "$2" --out "$3" >"$3.digests" 2>said || fail "lookout-replay of $2: $(cat said)"
}
digest() { awk -v channel="$2" '$1 == channel { print $2, $3 }' "$1.digests"; }
merge() {  # OUTPUT LOG...
  local out=$1 inputs=() log
  shift
  for log; do inputs+=(--in "$log"); done
  "$bin/lookout-export" "${inputs[@]}" --table map --format geojson --out "$out" >said 2>&1 || fail "lookout-export: $(cat said)"
}
known_days() { "$bin/lookout-export" --in "$1" --table tracks | awk -F, 'NR > 1 && $NF > most { most = $NF } END { print most + 0 }'; }

for day in 1 2 3 4; do make_capture "$day"; done
for day in 1 2 3; do replay "$config" "day$day.pcap" "day$day.lcmlog"; done
merge map.geojson day1.lcmlog day2.lcmlog day3.lcmlog
merge again.geojson day3.lcmlog day1.lcmlog day2.lcmlog day1.lcmlog
cmp map.geojson again.geojson || fail "the map depends on the order of the logs"
merge two_days.geojson day1.lcmlog day2.lcmlog

cp -r "$config" with_map
echo 'map: "map.geojson"' >>with_map/tracker.txtpb
cp map.geojson with_map/
replay "$config" day4.pcap without.lcmlog
replay with_map day4.pcap with.lcmlog
[ "$(digest with.lcmlog ALERTS)" = "$(digest without.lcmlog ALERTS)" ] || fail "the map changes ALERTS"
[ "$(digest with.lcmlog TRACKS)" != "$(digest without.lcmlog TRACKS)" ] || fail "nothing is known"
[ "$(known_days with.lcmlog)" = 3 ] || fail "no track is known for three days: $(known_days with.lcmlog)"
[ "$(known_days without.lcmlog)" = 0 ] || fail "known without a map"

# No file is needed for that.
replay "$config" with.lcmlog computed_again.lcmlog
cmp with.lcmlog.digests computed_again.lcmlog.digests || fail "what the log was given does not give the same"

cp two_days.geojson with_map/map.geojson
replay with_map day4.pcap two.lcmlog
[ "$(known_days two.lcmlog)" = 0 ] || fail "two days are not enough"

# The fourth day counts once, with the log of its own or with what it was given.
merge four.geojson with.lcmlog
grep -q '"days":4' four.geojson || fail "the fourth day is not in the map that was made of it"
merge all.geojson with.lcmlog day1.lcmlog day2.lcmlog day3.lcmlog
if grep -q '"days":[5-9]' all.geojson; then fail "a day counts twice"; fi

# A wrong file is told at once.
echo '{' >with_map/map.geojson
code=0
"$bin/lookout-tracker" --config with_map --check >said 2>&1 || code=$?
[ "$code" = 2 ] || fail "a wrong map ends with exit code $code: $(cat said)"
grep -q "tracker.txtpb:.*: map: 'with_map/map.geojson' line 2: is no JSON" said || fail "what is wrong with the map is not said: $(cat said)"
