# Sourced: starts and ends the live processes of Lookout in the order that leaves a log equal to its replay.
#   start NAME CONFIG OUTPUT    starts build/.../lookout-NAME, waits until its inputs and its bus are open; what it prints goes to OUTPUT
#   start_all CONFIG FOLDER     starts the processes of a boat, readers before publishers: nobody misses a first message; output: FOLDER/NAME.out
#   stop_all                    ends what was started; kills, and says so, what goes on for 12 s
# Expects $bin, the folder of the programs.

declare -A live_pids=()
mapfile -t processes < <("$bin/lookout-up" --list)  # in the order of their start
[ "${#processes[@]}" -gt 0 ] || { echo "$bin/lookout-up names no process" >&2; exit 1; }

# @return 1 when it ended at its start, or is not up within 20 s
start() {
  local name=$1 config=$2 output=$3 i
  "$bin/lookout-$name" --config "$config" >"$output" 2>&1 &
  live_pids[$name]=$!
  for ((i = 0; i < 400; ++i)); do
    grep -q ': starts, version ' "$output" && return 0
    kill -0 "${live_pids[$name]}" 2>/dev/null || break
    sleep 0.05
  done
  # A source that has already come to its end (a short capture) was up as well.
  grep -q ': starts, version ' "$output" && return 0
  echo "lookout-$name did not start:" >&2
  cat "$output" >&2
  return 1
}

start_all() {
  local name
  for name in "${processes[@]}"; do start "$name" "$1" "$2/$name.out"; done
}

# Sources first, each waited for: what one sends at its end (the end mark, the last scan, the last poses) is still taken by those behind it, and the
# recorder, which ends last, has it all.
stop_all() {
  local name i place
  for ((place = ${#processes[@]} - 1; place >= 0; --place)); do
    name=${processes[place]}
    [ -n "${live_pids[$name]:-}" ] || continue
    kill -TERM "${live_pids[$name]}" 2>/dev/null || true
    for ((i = 0; i < 240; ++i)); do
      kill -0 "${live_pids[$name]}" 2>/dev/null || break
      sleep 0.05
    done
    if kill -KILL "${live_pids[$name]}" 2>/dev/null; then echo "lookout-$name did not end within 12 s of SIGTERM: killed" >&2; fi
    wait "${live_pids[$name]}" 2>/dev/null || true
    unset "live_pids[$name]"
  done
}
