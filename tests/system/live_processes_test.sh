#!/usr/bin/env bash
# The live processes, started and ended as the demo does it (tools/live_processes.sh), leave a log that begins with a start mark, ends with an end
# mark, and equals its replay.
#   live_processes_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -euo pipefail
source_folder=$1
bin=$2
work=$(mktemp -d -t live_processes.XXXXXX)
# shellcheck source=tools/live_processes.sh
. "$source_folder/tools/live_processes.sh"
trap 'stop_all; rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; tail -n 30 "$work"/*.out >&2 || true; exit 1; }

cp -r "$source_folder/config/demo" "$work/config"
cd "$work"  # the recorder's logs/ is made here
for service in recorder georeferencer segmenter navigator vlp16; do start "$service" config "$service.out"; done
"$bin/lookout-sim" --config config --scene lake --seed 1 --seconds 3 --udp 127.0.0.1 >sim.out || fail "the simulator"
stop_all

logs=(logs/*.lcmlog)
[ "${#logs[@]}" -eq 1 ] || fail "one log was expected: ${logs[*]}"
"$bin/lookout-replay" --config config --in "${logs[0]}" --out again.lcmlog >replay.out 2>&1 || fail "the replay"
"$bin/lookout-log" info "${logs[0]}" >info.out
grep -q '^begins .*with a start mark' info.out || fail "no start mark: $(cat info.out)"
grep -q '^ends .*with an end mark' info.out || fail "no end mark: $(cat info.out)"
for channel in LIDAR_PACKETS LIDAR_SCAN SEGMENTS NAV_RAW POSE OBSTACLES; do
  grep -q "^$channel " info.out || fail "the log holds no $channel"
done
"$bin/lookout-diff" "${logs[0]}" again.lcmlog || fail "the log differs from its replay"
