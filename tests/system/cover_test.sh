#!/usr/bin/env bash
# A lidar that turns, sends, and sees nothing: all lasers off, a covered sector, a cover from the start. Made from the packets of a simulated boat.
#   cover_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
config=$1/config/demo
bin=$2/bin
work=$(mktemp -d -t lookout_cover.XXXXXX)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }
cd "$work"

# Lake, 30 s: the lidar of config/demo sees the own outboard at 170 to 205 deg from the bow, the shore and boats.
"$bin/lookout-sim" --config "$config" --scene lake --seed 11 --seconds 30 --pcap open.pcap >sim.txt 2>&1 || { cat sim.txt; fail "lookout-sim"; }
cat >cover.py <<'PYTHON'
# IN OUT LENGTH_S BEGIN_S END_S FROM_DEG WIDTH_DEG RANGE_M: every return of the data packets in this time and these azimuths is at RANGE_M; 0 = none.
import struct, sys
source, target = sys.argv[1:3]
length_s, begin_s, end_s, from_deg, width_deg, range_m = map(float, sys.argv[3:])
data = bytearray(open(source, "rb").read())
at, first_s = 24, None
while at < len(data) and (first_s is None or now_s - first_s < length_s):
    seconds, micros, length = struct.unpack_from("<III", data, at)
    at += 16
    now_s = seconds + micros * 1e-6
    first_s = first_s or now_s
    if length == 42 + 1206 and begin_s <= now_s - first_s < end_s:
        struct.pack_into("<H", data, at + 40, 0)  # no checksum of UDP
        for block in range(at + 42, at + 42 + 1200, 100):
            azimuth_deg = struct.unpack_from("<H", data, block + 2)[0] / 100
            if (azimuth_deg - from_deg) % 360 < width_deg:
                for channel in range(32):
                    struct.pack_into("<H", data, block + 4 + 3 * channel, round(range_m / 0.002))
    at += length
open(target, "wb").write(data[:at])
PYTHON
python3 cover.py open.pcap dark.pcap 24 10 16 0 360 0
python3 cover.py open.pcap stern.pcap 30 25 99 150 60 0
python3 cover.py open.pcap bag.pcap 5 0 99 0 360 0.45

for name in open dark stern bag; do
  "$bin/lookout-replay" --config "$config" --in $name.pcap --out $name.lcmlog >$name.txt 2>$name.err || { cat $name.err; fail "replay of $name"; }
  "$bin/lookout-export" --in $name.lcmlog --table alerts >$name.csv
  "$bin/lookout-export" --in $name.lcmlog --table tracks >$name.tracks.csv
done
has() { grep -q -- "$2" "$1.csv" || { cut -d, -f 3,4,5,14- "$1.csv" | sort | uniq -c | sort -rn | head -20; fail "$1: no alert '$2'"; }; }
grep -q "covers the lidar\|sees nothing\|seen nothing" open.csv && fail "a lidar that looks is told as covered"
has dark ",watch,warning,active,.*no look-out: all round (the lidar sees nothing any more: lasers off, or window covered)"
has dark ",watch,warning,active,.*no look-out in the whole guard zone: 300 to 60 deg"
has dark ",watch,warning,rectified,.*nothing covers the lidar any more"
has stern ",watch,caution,active,.*no look-out: 170 to 205 deg (the lidar saw the own boat there, and sees nothing any more"
has bag ",watch,warning,active,.*no look-out: all round (something nearer than 1 m covers the lidar)"

# Nobody looks: no thing is told as gone, and its tracks stay.
first_us=$(awk -F, 'NR == 2 { print $1 }' dark.tracks.csv)
confirmed() {  # FILE SECONDS: ids of tracks that are confirmed or coasting in this second
  awk -F, -v from="$2" -v first="$first_us" '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    { s = ($1 - first) / 1e6 } s >= from && s < from + 0.3 && ($at["status"] == "confirmed" || $at["status"] == "coasting") { print $at["track_id"] }' "$1" | sort -u
}
before=$(confirmed dark.tracks.csv 9 | wc -l)
kept=$(comm -12 <(confirmed dark.tracks.csv 9) <(confirmed dark.tracks.csv 13) | wc -l)
echo "of $before tracks $kept are kept while the lidar is dark for 3 s"
[ "$before" -ge 5 ] || fail "too few tracks to tell"
[ $((10 * kept)) -ge $((8 * before)) ] || fail "tracks end while the lidar is dark"

# From the log: the same bytes.
"$bin/lookout-replay" --config "$config" --in dark.lcmlog --out again.lcmlog >again.txt 2>/dev/null
diff dark.txt again.txt || fail "a replay of the log differs"
echo "covers are told"
