#!/usr/bin/env bash
# The back-off that systemd and lookout-up share, lookout-up's command line, and how far the units are shut off.
#   deploy_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
export LC_ALL=C  # a range of letters is that of the locale: in Turkish, [a-z] has no w
source_folder=$1
build_folder=$2
greatest_exposure=25  # of systemd-analyze security, in tenths
work=$(mktemp -d -t lookout_deploy.XXXXXX)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }

# Neither waits nor the time of day: both are told.
mkdir "$work/bin" "$work/state"
printf '#!/bin/sh\necho "slept $1"\n' >"$work/bin/sleep"
printf '#!/bin/sh\necho "$NOW_MS"\n' >"$work/bin/date"
chmod +x "$work/bin/sleep" "$work/bin/date"
backoff() {  # NOW_MS [SERVICE_RESULT]
  env -u SERVICE_RESULT PATH="$work/bin:$PATH" NOW_MS="$1" RUNTIME_DIRECTORY="$work/state" ${2:+SERVICE_RESULT="$2"} "$source_folder/deploy/backoff" |
    sed -n 's/^slept //p'
}
expect() {  # WAIT_S NOW_MS WHAT [SERVICE_RESULT]
  local got
  got=$(backoff "$2" "${4:-}")
  [ "$got" = "$1" ] || fail "$3: waits '$got' s, not '$1'"
}
expect 0 1000000 "the first end"
expect 1 1000100 "an end at once after it"
expect 2 1001200 "a third"
expect 4 1003300 "a fourth"
expect 8 1007400 "a fifth"
expect 8 1015500 "a sixth"
expect 0 1026000 "after two seconds of life"
expect '' 1026100 "a stop that was asked for" success
expect 1 1026200 "an end at once again" signal
expect 2 26000 "the clock was set back"
expect 0 1999999000 "the clock was set forward"

# The rule that closes the port of the bus: on by itself where the bus is this computer's alone.
rules() { env -u LOOKOUT_BUS_FIREWALL -u LOOKOUT_LCM_INTERFACE -u LCM_DEFAULT_URL "$@" "$source_folder/deploy/firewall" rules; }
expect_rule() {  # WHAT_STANDS_THERE SETTING ...
  local wanted=$1 got
  shift
  got=$(rules "$@")
  if [ -z "$wanted" ]; then
    [ -z "$got" ] || fail "firewall with $*: not off"
    return
  fi
  grep -qF -- "$wanted" <<<"$got" || { echo "$got"; fail "firewall with $*: no '$wanted'"; }
  num_rules=$((num_rules + 1))
  echo "$got" >"$work/rules$num_rules.nft"
}
num_rules=0
expect_rule 'iifname != "lo" udp dport 7667 counter drop'
expect_rule 'iifname != "lo" udp dport 7667 counter drop' LOOKOUT_BUS_FIREWALL=on LOOKOUT_LCM_INTERFACE=lo
expect_rule 'iifname != { "lo", "eth1" } udp dport 7000 counter drop' LOOKOUT_BUS_FIREWALL=on LOOKOUT_LCM_INTERFACE=eth1 'LCM_DEFAULT_URL=udpm://239.1.2.3:7000?ttl=1'
expect_rule '' LOOKOUT_LCM_INTERFACE=eth1
expect_rule '' LOOKOUT_BUS_FIREWALL=off
expect_rule '' LCM_DEFAULT_URL=tcpq://localhost:7700
for wrong in LOOKOUT_BUS_FIREWALL=yes 'LOOKOUT_LCM_INTERFACE=lo" }; flush ruleset' LCM_DEFAULT_URL=udpm://239.1.2.3:x; do
  code=0; rules "$wrong" >/dev/null 2>&1 || code=$?; [ "$code" -eq 2 ] || fail "firewall with $wrong: exit code $code"
done
cp "$work/rules1.nft" "$work/installed.nft"
env -i sh -c '. "$1"; export LOOKOUT_BUS_FIREWALL LOOKOUT_LCM_INTERFACE LCM_DEFAULT_URL; exec "$2" rules' sh "$source_folder/deploy/default" "$source_folder/deploy/firewall" |
  cmp -s - "$work/installed.nft" || fail "as delivered the port is not closed"
PATH=$PATH:/usr/sbin:/sbin
if command -v nft >/dev/null && unshare -rn true 2>/dev/null; then
  for file in "$work"/rules?.nft; do
    unshare -rn nft -c -f "$file" || { cat "$file"; fail "nft does not read the rule"; }
  done
else
  echo "skipped: the syntax of the firewall's rule is not checked: there is no nft (package nftables), or it may not be run"
fi

# A row more in the service table is a unit more, started before what it reads from; a row that is none is refused.
cat >"$work/units.cmake" <<'TEXT'
include(${SOURCE}/deploy/ServiceTable.cmake)
lookout_make_units(${WORK}/services.hpp ${WORK}/units)
message("start order: ${start_order}")
TEXT
units() { cmake -DSOURCE="$source_folder" -DWORK="$work" -P "$work/units.cmake" 2>&1; }
sed 's/^    ServiceRow{"recorder"/    ServiceRow{"fuser", "fuser", "obstacles of two lidars", 12,\n               "network", "none", "none", {\&kObstacles}},\n&/' "$source_folder/common/bus/services.hpp" >"$work/services.hpp"
grep -qxF 'start order: recorder;fuser;page;plotter;ais;tracker;georeferencer;navigator;odometer;segmenter;lidar' <(units) || { units; fail "the start order with a row more"; }
grep -qxF 'Description=Lookout fuser: obstacles of two lidars' "$work/units/lookout-fuser.service" || fail "a row more has no unit"
grep -qxF 'WatchdogSec=12s' "$work/units/lookout-fuser.service" || fail "the watchdog of a row more"
grep -q 'After=.* lookout-fuser.service' "$work/units/lookout-georeferencer.service" || fail "a row more is not started before what it reads from"
grep -q 'Wants=.* lookout-fuser.service ' "$work/units/lookout.target" || fail "a row more is not in the target"
# A second lidar has a unit of its own, which starts nothing on a boat with one.
grep -q 'ExecStart=.*/lookout-lidar_2 --config' "$work/units/lookout-lidar_2.service" || fail "the second lidar's unit starts another program"
grep -q '^ConditionPathExists=.*/lookout/boat/lidar_2.txtpb$' "$work/units/lookout-lidar_2.service" || fail "the second lidar starts on every boat"
grep -q '^ConditionPathExists' "$work/units/lookout-lidar.service" && fail "the first lidar waits for a file"
grep -q 'Wants=.* lookout-lidar_2.service' "$work/units/lookout.target" || fail "the second lidar is not in the target"
grep -q 'After=.* lookout-segmenter.service' "$work/units/lookout-lidar_2.service" || fail "the second lidar starts before what reads it"
sed -i 's/"obstacles of two lidars", 12/"obstacles of two lidars", 12.5/' "$work/services.hpp"
if units >"$work/refused.txt"; then fail "a wrong row is accepted"; fi
grep -q '10 of 11 rows' "$work/refused.txt" || { cat "$work/refused.txt"; fail "a wrong row is not told"; }

up=$build_folder/bin/lookout-up
config=$work/config
cp -r "$source_folder/config/demo" "$config"
"$up" --help >/dev/null || fail "--help"
"$up" --version | grep -q '^lookout-up [0-9]' || fail "--version"
"$up" --config "$config" --check >"$work/check.txt" || fail "--check of the demo"
mapfile -t names < <("$up" --list)
[ "${names[*]}" = "recorder page plotter ais tracker georeferencer navigator odometer segmenter lidar" ] || fail "--list: ${names[*]}"
for name in "${names[@]}"; do
  grep -q "^$name: ok\$" "$work/check.txt" || fail "--check does not tell of $name"
done
# It had 420 lines, with boat.txtpb once for each process.
[ "$(wc -l <"$work/check.txt")" -le 40 ] || { cat "$work/check.txt"; fail "--check prints more than one can read"; }
[ -z "$(grep '^# boat.txtpb: ' "$work/check.txt" | sort | uniq -d)" ] || { cat "$work/check.txt"; fail "--check tells twice of boat.txtpb"; }
"$up" --config "$config" --check --values >"$work/values.txt" || fail "--check --values of the demo"
for file in "$config"/*.txtpb; do
  [ "$(grep -c "^# ${file##*/}\$" "$work/values.txt")" -eq 1 ] || fail "--check --values does not print ${file##*/} once"
done
grep -q '^name: "demo"' "$work/values.txt" || fail "--check --values has no values"
code=0; "$up" --config "$config" --values >/dev/null 2>&1 || code=$?; [ "$code" -eq 2 ] || fail "--values alone: exit code $code"
# A second lidar, where it has a config.
grep -q '^lidar_2: ' "$work/check.txt" && fail "--check tells of a second lidar where there is none"
cp -r "$config" "$work/two"
echo 'lidar_2 { x_m: -1.0 y_m: 0.2 z_m: 1.3 roll_deg: 0 pitch_deg: 0 yaw_deg: 180 }' >>"$work/two/boat.txtpb"
sed 's/^cut_azimuth_deg/data_port: 2370\nposition_port: 8310\ncut_azimuth_deg/' "$work/two/lidar.txtpb" >"$work/two/lidar_2.txtpb"
"$up" --config "$work/two" --check >"$work/two.txt" || fail "--check with two lidars"
grep -q '^lidar_2: ok$' "$work/two.txt" || { cat "$work/two.txt"; fail "--check does not tell of lidar_2"; }
# A folder of boats names them, in every program.
for program in up "${names[@]}" doctor replay; do
  code=0; "$build_folder/bin/lookout-$program" --config "$source_folder/config" --check >"$work/boats.txt" 2>&1 || code=$?
  [ "$code" -eq 2 ] || fail "lookout-$program with a folder of boats: exit code $code"
  grep -q "no boat's folder.* holds boats: .*config/catabot, .*config/demo" "$work/boats.txt" || { cat "$work/boats.txt"; fail "lookout-$program does not name the boats"; }
done
code=0; "$up" 2>/dev/null || code=$?; [ "$code" -eq 2 ] || fail "no --config: exit code $code"
code=0; "$up" --config "$work/nowhere" 2>/dev/null || code=$?; [ "$code" -eq 2 ] || fail "no such folder: exit code $code"
code=0; "$up" --config 2>/dev/null || code=$?; [ "$code" -eq 2 ] || fail "--config without a value: exit code $code"
code=0; "$up" --nonsense 2>/dev/null || code=$?; [ "$code" -eq 2 ] || fail "an unknown option: exit code $code"
echo 'nonsense: 1' >>"$config/segmenter.txtpb"
code=0; "$up" --config "$config" 2>"$work/wrong.txt" || code=$?
[ "$code" -eq 2 ] || fail "a wrong config: exit code $code"
grep -q 'segmenter.txtpb:.*"nonsense"' "$work/wrong.txt" || { cat "$work/wrong.txt"; fail "a wrong config is not named"; }

# Every fault of every process at once, each once, in an order of its own; lookout-doctor finds the same.
rm -r "$config"
cp -r "$source_folder/config/demo" "$config"
sed -i -e 's/^name:/nam:/' -e 's/min_x_m: [-0-9.]*/min_x_m: "aft"/' "$config/boat.txtpb"
printf 'max_range_m: -1\nbfs_angel_deg: 3\n' >>"$config/segmenter.txtpb"
printf 'max_sentence_latency_s: 0.9\nmax_attitude_age_s: 0.5\n' >>"$config/navigator.txtpb"
printf 'position_port: 2368\nallowed_source_address: "lidar"\n' >>"$config/lidar.txtpb"
echo 'pose_timeout_s: 0' >"$config/georeferencer.txtpb"
rm "$config/recorder.txtpb" "$config/page.txtpb"  # absent: no fault
code=0; "$up" --config "$config" --check >"$work/out.txt" 2>"$work/wrong.txt" || code=$?
[ "$code" -eq 2 ] || fail "--check with many faults: exit code $code"
sed -E "s|^$config/||; s/:[0-9]+: /: /" "$work/wrong.txt" >"$work/got.txt"
for fault in 'boat.txtpb: nam:' 'boat.txtpb: name: must be set' 'boat.txtpb: own_vessel.min_x_m: Expected double' 'segmenter.txtpb: max_range_m: ' \
  'segmenter.txtpb: bfs_angel_deg: ' 'navigator.txtpb: max_sentence_latency_s: must not be greater' 'lidar.txtpb: position_port: must differ' \
  'lidar.txtpb: allowed_source_address: ' 'georeferencer.txtpb: pose_timeout_s: must be at least'; do
  [ "$(grep -c -F "$fault" "$work/got.txt")" -eq 1 ] || { cat "$work/got.txt"; fail "--check does not tell once: $fault"; }
done
[ "$(wc -l <"$work/got.txt")" -eq 9 ] || { cat "$work/got.txt"; fail "--check tells other faults than those nine"; }
"$up" --config "$config" --check >/dev/null 2>"$work/again.txt" || true
cmp -s "$work/again.txt" "$work/wrong.txt" || fail "--check tells the same faults in another order"
code=0; "$build_folder/bin/lookout-doctor" --config "$config" --check >"$work/doctor.txt" 2>&1 || code=$?
[ "$code" -eq 2 ] || fail "lookout-doctor --check: exit code $code"
sed -E 's/^[-0-9T:.]+Z [a-z]+ doctor: //' "$work/doctor.txt" | sort | diff - <(sort "$work/wrong.txt") || fail "lookout-doctor finds other faults"
# A tool that runs all services tells them too, but for what is the recorder's and a source's alone.
code=0; "$build_folder/bin/lookout-replay" --config "$config" --check >"$work/replay.txt" 2>&1 || code=$?
[ "$code" -eq 2 ] || fail "lookout-replay --check: exit code $code"
sed -E 's/^[a-z]+ replay: //' "$work/replay.txt" | sort | diff - <(grep -v allowed_source_address "$work/wrong.txt" | sort) || fail "lookout-replay finds other faults"

if ! command -v systemd-analyze >/dev/null; then
  echo "skipped: the units are not looked at: there is no systemd-analyze (package systemd)"
  exit 0
fi
for unit in "$build_folder"/deploy/systemd/lookout-*.service; do
  case $unit in */lookout-route.service | */lookout-firewall.service) continue ;; esac
  systemd-analyze security --no-pager --offline=true --threshold=$greatest_exposure "$unit" >"$work/security.txt" 2>&1 ||
    { tail -n 1 "$work/security.txt"; fail "$unit is too open"; }
done
