#!/usr/bin/env bash
# The demo: simulate (or take a capture), replay, run all processes live and record them, replay the recording and compare. Called by
# ./dev demo [CAPTURE].
set -euo pipefail
stay=''
if [ "${1:-}" = --stay ]; then stay=1; shift; fi
if [ -n "$stay" ] && [ $# -gt 0 ]; then echo "--stay is for the simulated boat, without a capture" >&2; exit 2; fi
capture=${1:+$(realpath -m -- "$1")}
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bin=build/release/bin
config=config/demo
work=build/demo
scene=lake
seed=1
seconds=10
# --stay: the simulated boat and the page go on until Ctrl-C.

# shellcheck source=tools/live_processes.sh
. tools/live_processes.sh

say() { printf '\n== %s\n' "$*"; }

if [ -n "$capture" ]; then
  [ -f "$capture" ] || { echo "$capture: no such file" >&2; exit 2; }
  # What a demo of before left is removed.
  [[ $capture != "$(realpath -m "$work")"/* ]] || { echo "$capture lies in $work, which each demo makes anew: copy it elsewhere first" >&2; exit 2; }
fi

# Live processes need a multicast route. Where there is none, the whole demo goes into a network namespace of its own; root needs no user namespace
# for that, which a chroot would not permit.
if [ -z "${LOOKOUT_DEMO_NAMESPACE:-}" ] && ! ip route get 239.255.76.67 >/dev/null 2>&1; then
  isolated=(unshare -rn)
  [ "$(id -u)" -ne 0 ] || isolated=(unshare -n)
  if "${isolated[@]}" true 2>/dev/null; then
    export LOOKOUT_DEMO_NAMESPACE=1
    exec "${isolated[@]}" bash -c 'ip link set lo up && ip link set lo multicast on && ip route add 239.255.76.0/24 dev lo && exec "$0" "$@"' \
      "$PWD/tools/demo.sh" ${stay:+--stay} ${capture:+"$capture"}
  fi
  echo "LCM needs a multicast route and there is none. As root: ip route add 239.255.76.0/24 dev lo" >&2
  exit 1
fi

# How many obstacles a log holds, as lookout-export gives them.
count_obstacles() {  # LOG
  "$bin/lookout-export" --in "$1" --table obstacles | LC_ALL=C awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    { ++num; turns[$column["scan_utime_us"]] = 1; if ($column["status"] == "ok") ++num_placed; if ($column["confidence"] == "sure") ++num_sure }
    END {
      for (turn in turns) ++num_turns
      printf "%d obstacles in %d scans, %d of them sure, %d placed on the earth\n", num, num_turns, num_sure, num_placed
    }'
}

# What the tracker made of a log: tracks (confirmed ones), the nearest approach that was foretold, and alerts.
describe_tracks() {  # LOG
  "$bin/lookout-export" --in "$1" --table tracks | LC_ALL=C awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    $column["status"] != "confirmed" && $column["status"] != "coasting" { next }
    {
      id = $column["track_id"]
      tracks[id] = 1
      if ($column["utime_us"] != last) { last = $column["utime_us"]; num_now = 0 }
      ++num_now
      if ($column["speed_mps"] > 0) moving[id] = 1
      if ($column["tcpa_s"] > 0 && (least_id == "" || $column["cpa_m"] < least)) {
        least = $column["cpa_m"] + 0; least_id = id; kind = $column["kind"]; tcpa = $column["tcpa_s"]
      }
    }
    END {
      for (id in tracks) ++num_tracks
      for (id in moving) ++num_moving
      printf "%d tracks (%d in the last scan), %d of them moving", num_tracks, num_now, num_moving
      if (least_id != "") printf "; least closest approach foretold: %.1f m in %.0f s, of %s %s", least, tcpa, kind, least_id
      print ""
    }'
  "$bin/lookout-export" --in "$1" --table alerts | LC_ALL=C awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    { id = $column["alert_id"]; if (id > 0) { level[id] = $column["level"] == "warning" || level[id] == "warning" ? "warning" : "caution"; cause[id] = $column["cause"] } }
    END {
      for (id in level) { ++num; ++of[level[id]]; if (cause[id] == "guard_zone") ++num_zone }
      printf "alerts: %d (warnings: %d, cautions: %d; %d of the guard zone)\n", num, of["warning"], of["caution"], num_zone
    }'
}

rm -rf "$work"
mkdir -p "$work" logs

if [ -n "$capture" ]; then
  input=$capture
else
  say "simulating $seconds s of the scene '$scene' to $work/sim.pcap"
  "$bin/lookout-sim" --config "$config" --scene "$scene" --seed "$seed" --seconds "$seconds" --pcap "$work/sim.pcap" --truth "$work/truth"
  input=$work/sim.pcap
fi

say "replaying $input: one process, as fast as it goes (channel, messages, SHA-256 of the payloads)"
"$bin/lookout-replay" --config "$config" --in "$input" --out "$work/replay.lcmlog"
count_obstacles "$work/replay.lcmlog"

say "all processes live on LCM"
live_config=$work/config
cp -r "$config" "$live_config"
# A busy computer may hold POSE up. What is sent without waiting for it is outside what a replay gives again, and here that is looked at.
sed -i 's/^pose_timeout_s: .*/pose_timeout_s: 10/' "$live_config/georeferencer.txtpb"
echo 'wait_timeout_s: 10' >>"$live_config/tracker.txtpb"
# A port that nobody has, for a chart plotter.
plotter_port=''
for port in $(seq 10111 10130); do
  (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null && continue
  plotter_port=$port
  printf 'output { name: "demo" format: NMEA0183 tcp_server { bind_address: "127.0.0.1" port: %s } }\n' "$port" >>"$live_config/plotter.txtpb"
  break
done
# And one for the page; its secret and its last minutes lie in the demo's folder.
for port in $(seq 7668 7690); do
  (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null && continue
  printf 'port: %s\ntoken_file: "../page-token"\nlook_back_folder: "../look-back"\n' "$port" >>"$live_config/page.txtpb"
  break
done
if [ -n "$capture" ]; then
  # The lidar's process reads the capture at the speed at which it was recorded.
  sed -i 's/^source: UDP/source: CAPTURE/' "$live_config/lidar.txtpb"
  escaped=${capture//\\/\\\\}
  printf 'capture_file: "%s"\n' "${escaped//\"/\\\"}" >>"$live_config/lidar.txtpb"
  # Its position belongs to another day than this computer's clock: live, obstacles stay in the vessel's frame. The replay has both.
  sed -i 's/^use_lidar_nmea: true/use_lidar_nmea: false/' "$live_config/navigator.txtpb"
fi

# Ctrl-C reaches the simulator too, which ends with 0: the demo must not go on as if it had sent all.
simulator='' watcher=''
cleanup() {
  trap '' INT TERM
  [ -z "$simulator" ] || kill -TERM "$simulator" 2>/dev/null || true
  [ -z "$watcher" ] || kill -TERM "$watcher" 2>/dev/null || true
  stop_all
  wait
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
start_all "$live_config" "$work"
lidar=${live_pids[lidar]}
if [ -n "$capture" ]; then
  echo "lidar plays $capture (at most 60 s of it)"
else
  kill -0 "$lidar" 2>/dev/null || { cat "$work/lidar.out" >&2; exit 1; }
  echo "the simulator sends datagrams to 127.0.0.1 for $seconds s"
  rm -rf "$work/truth-live"
  # In the background: bash heeds a signal while it waits, but not while it runs a program.
  "$bin/lookout-sim" --config "$live_config" --scene "$scene" --seed "$seed" --seconds "$seconds" --udp 127.0.0.1 --truth "$work/truth-live" &
  simulator=$!
fi
# What the bus carries, seen in the middle of the run.
sleep 2
"$bin/lookout-top" --once --seconds 3 >"$work/top.out" 2>&1 &
watcher=$!
# And what a chart plotter is sent then; it ends with the plotter's process.
[ -z "$plotter_port" ] || (exec 3<>"/dev/tcp/127.0.0.1/$plotter_port" && cat <&3 >"$work/plotter.nmea") 2>/dev/null &
if [ -n "$capture" ]; then
  for _ in $(seq 600); do kill -0 "$lidar" 2>/dev/null || break; sleep 0.1; done
  grep -q 'critical' "$work/lidar.out" && { cat "$work/lidar.out" >&2; exit 1; }
else
  wait "$simulator"
fi
sleep 1.5  # the last HEALTH
wait "$watcher" || { cat "$work/top.out" >&2; exit 1; }
stop_all
trap - EXIT INT TERM

log=$(sed -n 's/.*writing \(.*\.lcmlog\).*/\1/p' "$work/recorder.out" | head -n 1)
if [ -z "$log" ] || [ ! -s "$log" ]; then
  echo "the recorder wrote no log:" >&2
  cat "$work"/*.out >&2
  exit 1
fi
say "the live run as lookout-top saw it, in the middle"
cat "$work/top.out"
if [ -s "$work/plotter.nmea" ]; then
  say "what a chart plotter on TCP port $plotter_port was sent ($(wc -l <"$work/plotter.nmea") sentences; services/plotter/README.md), the last of each kind"
  awk -F, '{ last[substr($1, 4)] = $0 } END { for (kind in last) print last[kind] }' "$work/plotter.nmea" | sort
fi
say "what was recorded (missing: messages lost on their way)"
"$bin/lookout-log" info "$log"
count_obstacles "$log"
describe_tracks "$log"

say "the recording computed again from its raw channels, and compared, byte by byte"
"$bin/lookout-replay" --config "$live_config" --in "$log" --out "$work/again.lcmlog" >/dev/null 2>"$work/again.out" || { cat "$work/again.out" >&2; exit 1; }
is_equal=1
"$bin/lookout-diff" "$log" "$work/again.lcmlog" || is_equal=''

picture=${log%.lcmlog}.svg
"$bin/lookout-export" --in "$log" --table returns --format svg --out "$picture"
# A capture of another day has no place on the earth, live.
voyage=${log%.lcmlog}_tracks.svg
"$bin/lookout-export" --in "$log" --table tracks --format svg --out "$voyage" 2>"$work/voyage.out" || voyage=''

route_hint=''
[ -z "${LOOKOUT_DEMO_NAMESPACE:-}" ] || route_hint=$'\n          first, as root, for what plays or watches: ip route add 239.255.76.0/24 dev lo'
say "what is left"
cat <<TEXT
log       $log
          play it:      lcm-logplayer $log
          again:        $bin/lookout-replay --config $config --in $log --out again.lcmlog
          tables:       $bin/lookout-export --in $log --table obstacles (tracks, alerts, ...)
          in a browser: $bin/lookout-page --log $log
          watch it:     $bin/lookout-top in a terminal, then lcm-logplayer in another$route_hint
picture   $picture${voyage:+ (one scan), $voyage (the whole log: tracks, land, alerts)}
          open it in a browser, or: xdg-open $picture
more      ./dev build makes the rest: lookout-eval (obstacles against the simulator's truth), lookout-spy (the bus on a display), lookout-doctor
TEXT
if [ -z "$is_equal" ]; then
  echo "the recording and its replay differ: see above" >&2
  exit 1
fi
[ -n "$stay" ] || exit 0

say "the boat goes on, live: open the page in a browser; Ctrl-C ends it"
trap cleanup EXIT
trap 'exit 0' INT TERM
start_all "$live_config" "$work"
"$bin/lookout-page" --link --config "$live_config"
[ -z "${LOOKOUT_DEMO_NAMESPACE:-}" ] || echo "But this demo runs in a network of its own, which no browser reaches. As root: ip route add 239.255.76.0/24 dev lo; then again." >&2
while :; do
  "$bin/lookout-sim" --config "$live_config" --scene "$scene" --seed "$seed" --seconds 600 --udp 127.0.0.1 &
  simulator=$!
  wait "$simulator"
  seed=$((seed + 1))
done
