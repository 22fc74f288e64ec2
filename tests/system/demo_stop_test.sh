#!/usr/bin/env bash
# tools/demo.sh, ended while the simulator sends: by Ctrl-C, which reaches the whole process group, and by SIGTERM to the script alone. It ends soon, says
# by its exit code which signal it was, and leaves no process. And it refuses a capture that it would remove.
#   demo_stop_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -euo pipefail
source_folder=$1
bin=$2
work=$(mktemp -d -t demo_stop.XXXXXX)
demo=''
cleanup() {
  [ -z "$demo" ] || kill -KILL -- "-$demo" 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
fail() { echo "FAILED: $*" >&2; tail -n 30 "$work"/*.out >&2 || true; exit 1; }

# A repository of its own: the demo removes what one before it left.
mkdir -p "$work/build/release" "$work/tools"
ln -s "$bin" "$work/build/release/bin"
cp -r "$source_folder/config" "$work/"
cp "$source_folder/tools/demo.sh" "$source_folder/tools/live_processes.sh" "$work/tools/"

set -m  # each demo is a process group, and SIGINT is not ignored as in the background of a script
end_by() {  # SIGNAL TARGET_PREFIX EXIT_CODE
  local signal=$1 prefix=$2 wanted=$3 code=0 i
  "$work/tools/demo.sh" >"$work/$signal.out" 2>&1 &
  demo=$!
  for ((i = 0; i < 600; ++i)); do
    grep -q '^the simulator sends' "$work/$signal.out" && break
    kill -0 "$demo" 2>/dev/null || fail "the demo ended before its time"
    sleep 0.1
  done
  sleep 1
  [ "$(pgrep -c -g "$demo" '^lookout-')" -ge 6 ] || fail "not all processes run: $(pgrep -l -g "$demo")"
  kill -"$signal" -- "$prefix$demo"
  wait "$demo" || code=$?
  [ "$code" -eq "$wanted" ] || fail "SIG$signal: exit code $code instead of $wanted"
  if grep -q 'what is left' "$work/$signal.out"; then fail "SIG$signal: the demo went on"; fi
  if pgrep -l -g "$demo" >"$work/left.out"; then fail "SIG$signal: processes are left"; fi
  demo=''
}
end_by INT - 130
end_by TERM '' 143

[ -s "$work/build/demo/sim.pcap" ] || fail "the demo left no capture"
code=0
"$work/tools/demo.sh" "$work/build/demo/sim.pcap" >"$work/own.out" 2>&1 || code=$?
[ "$code" -eq 2 ] || fail "a capture in its own folder: exit code $code"
[ -s "$work/build/demo/sim.pcap" ] || fail "the demo removed its own input"
