#!/usr/bin/env bash
# Replay against real time: a simulated minute of the lake, from pcap to log. Called by ./dev bench.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bin=build/release/bin
work=build/bench
seconds=60
mkdir -p "$work"
echo "== replay of $seconds simulated seconds, three runs"
"$bin/lookout-sim" --config config/demo --scene lake --seed 1 --seconds "$seconds" --pcap "$work/sim.pcap" >/dev/null
for _ in 1 2 3; do
  start=$(date +%s%N)
  "$bin/lookout-replay" --config config/demo --in "$work/sim.pcap" --out "$work/replay.lcmlog" >/dev/null 2>"$work/replay.err"
  end=$(date +%s%N)
  awk -v s="$seconds" -v ns=$((end - start)) 'BEGIN { printf "replay: %.3f s, %.0f times real time\n", ns / 1e9, s * 1e9 / ns }'
done
grep 'a turn' "$work/replay.err"
rm -f "$work/sim.pcap" "$work/replay.lcmlog"
