#!/usr/bin/env bash
# The live processes, started and ended as the demo (tools/live_processes.sh) or lookout-up does it, leave a log that begins with a start mark, ends with
# an end mark, and equals its replay.
#   live_processes_test.sh SOURCE_FOLDER PROGRAM_FOLDER demo|lookout-up
set -euo pipefail
source_folder=$1
bin=$2
by=$3
work=$(mktemp -d -t live_processes.XXXXXX)
# shellcheck source=tools/live_processes.sh
. "$source_folder/tools/live_processes.sh"
supervisor=''
cleanup() {
  stop_all
  if [ -n "$supervisor" ]; then
    kill -TERM "$supervisor" 2>/dev/null || true
    wait "$supervisor" 2>/dev/null || true
  fi
  rm -rf "$work"
}
trap cleanup EXIT
fail() { echo "FAILED: $*" >&2; tail -n 30 "$work"/*.out >&2 || true; exit 1; }

cp -r "$source_folder/config/demo" "$work/config"
# What is given up for lack of POSE on a busy computer stands outside of what a replay equals.
sed -i 's/^pose_timeout_s: .*/pose_timeout_s: 20/' "$work/config/georeferencer.txtpb"
echo 'wait_timeout_s: 20' >>"$work/config/tracker.txtpb"
grep -q '^pose_timeout_s: 20$' "$work/config/georeferencer.txtpb" || fail "the config has no pose_timeout_s"
cd "$work"  # the recorder's logs/ is made here
simulate() { "$bin/lookout-sim" --config config --scene lake --seed 1 --seconds 3 --udp 127.0.0.1 >sim.out || fail "the simulator"; }

case $by in
  demo)
    start_all config .
    simulate
    stop_all
    ;;
  lookout-up)
    command -v runsvdir >/dev/null || { echo "skipped: runit is missing"; exit 77; }
    : >up.out
    "$bin/lookout-up" --config config >up.out 2>&1 &
    supervisor=$!
    for ((i = 0; i < 600; ++i)); do
      grep -q 'all processes are up' up.out && break
      kill -0 "$supervisor" 2>/dev/null || fail "lookout-up has ended"
      sleep 0.1
    done
    grep -q 'all processes are up' up.out || fail "not all processes are up"
    simulate
    kill -TERM "$supervisor"
    wait "$supervisor" || fail "lookout-up: exit code $?"
    supervisor=''
    ;;
esac

logs=(logs/*.lcmlog)
[ "${#logs[@]}" -eq 1 ] || fail "one log was expected: ${logs[*]}"
"$bin/lookout-replay" --config config --in "${logs[0]}" --out again.lcmlog >replay.out 2>&1 || fail "the replay"
"$bin/lookout-log" info "${logs[0]}" >info.out
grep -q '^begins .*with a start mark: LIDAR_PACKETS, NAV_RAW$' info.out || fail "no start mark: $(cat info.out)"
grep -q '^ends .*with an end mark: LIDAR_PACKETS, NAV_RAW$' info.out || fail "no end mark: $(cat info.out)"
for channel in LIDAR_PACKETS LIDAR_SCAN SEGMENTS NAV_RAW POSE OBSTACLES TRACKS ALERTS; do
  grep -q "^$channel " info.out || fail "the log holds no $channel"
done
"$bin/lookout-diff" "${logs[0]}" again.lcmlog || fail "the log differs from its replay"
