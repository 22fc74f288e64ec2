#!/usr/bin/env bash
# Replay against real time: a simulated minute, from a log of everything, of which the raw channels are read, to a log of everything. Called by
# ./dev bench. "Times real time" is without the digests, as lookout-replay prints it; pinned to one core.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bin=build/release/bin
work=build/bench
seconds=60
mkdir -p "$work"
for scene in lake dense; do
  echo "== replay of $seconds simulated seconds of the scene '$scene', five runs"
  "$bin/lookout-sim" --config config/demo --scene "$scene" --seed 1 --seconds "$seconds" --pcap "$work/sim.pcap" --force >/dev/null
  "$bin/lookout-replay" --config config/demo --in "$work/sim.pcap" --out "$work/day.lcmlog" --force >/dev/null 2>&1
  for _ in 1 2 3 4 5; do
    rm -f "$work/replay.lcmlog"
    taskset -c 0 "$bin/lookout-replay" --config config/demo --in "$work/day.lcmlog" --out "$work/replay.lcmlog" >/dev/null 2>"$work/replay.err"
    grep 'times real time' "$work/replay.err"
  done
  grep 'a scan' "$work/replay.err"
done
rm -f "$work/sim.pcap" "$work/day.lcmlog" "$work/replay.lcmlog"
