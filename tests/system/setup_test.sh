#!/usr/bin/env bash
# A boat from nothing: lookout-setup hears a capture or the cables, takes its answers from a file or from somebody who types, and writes one file that all
# programs take. In a network namespace of its own.
#   setup_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -euo pipefail
source_folder=$1
bin=$2
work=$(mktemp -d -t lookout_setup.XXXXXX)
pid=''
tidy() {
  [ -z "$pid" ] || { kill -TERM "$pid" 2>/dev/null || true; wait "$pid" 2>/dev/null || true; }
  rm -rf "$work"
}
trap tidy EXIT
fail() { echo "FAILED: $*"; [ ! -e said.txt ] || sed 's/^/  | /' said.txt; exit 1; }
setup() { "$bin/lookout-setup" "$@" >said.txt 2>&1; }
cd "$work"

# The boat of the simulator, as a person measures it.
cat >answers.txtpb <<'TEXT'
name: "Ida"
hull_length_m: 2.4
hull_beam_m: 1.4
lidar { behind_bow_m: 0.7 to_port_m: -0.1 above_water_m: 1.5 }
lidar_faces_deg: 5
lidar_roll_deg: 1
lidar_pitch_deg: -0.5
gnss_antenna { behind_bow_m: 2.0 to_port_m: 0.4 above_water_m: 1.3 }
TEXT
"$bin/lookout-sim" --config "$source_folder/config/demo" --scene lake --seed 101 --seconds 6 --pcap lake.pcap >said.txt 2>&1 || fail "lookout-sim"

# --- From a recording and a file of answers ---
setup --in lake.pcap --answers answers.txtpb --out boat || fail "lookout-setup --in --answers"
for text in 'lidar: Velodyne VLP-16 at 192.168.1.201, port 2368, 754 packets/s' 'UDP port 10110: ' 'http://localhost:7668/' 'lookout-up --config boat'; do
  grep -qF "$text" said.txt || fail "it does not say: $text"
done
if grep -q 'lacking' said.txt; then fail "nothing lacks"; fi
[ "$(ls boat)" = boat.txtpb ] || fail "the boat has other files than one: $(ls boat)"
setup --in lake.pcap --answers answers.txtpb --out again || fail "a second time"
cmp boat/boat.txtpb again/boat.txtpb || fail "the same answers give another file"

"$bin/lookout-up" --config boat --check >said.txt 2>&1 || fail "lookout-up --check"
[ "$(grep -c ': ok$' said.txt)" -ge 9 ] || fail "lookout-up --check: not every process says ok"
if grep -q 'warning' said.txt; then fail "lookout-up --check warns"; fi
"$bin/lookout-doctor" --config boat --check >doctor.txt 2>said.txt || fail "lookout-doctor --check"
"$bin/lookout-up" --config boat --check --values >values.txt 2>said.txt || fail "--values"
for file in boat lidar segmenter odometer navigator georeferencer tracker ais plotter page recorder; do
  [ "$(grep -cx "# $file.txtpb" values.txt)" -eq 1 ] || fail "--values does not tell once of $file.txtpb"
  [ "$(grep -cx "# $file.txtpb" doctor.txt)" -eq 1 ] || fail "the doctor does not tell once of $file.txtpb"
done

"$bin/lookout-replay" --config boat --in lake.pcap --out lake.lcmlog >digests.txt 2>said.txt || fail "lookout-replay"
rows() { "$bin/lookout-export" --in lake.lcmlog --table "$1" 2>/dev/null | tail -n +2 | wc -l; }
[ "$(rows obstacles)" -gt 100 ] || fail "$(rows obstacles) obstacles"
[ "$(rows tracks)" -gt 100 ] || fail "$(rows tracks) tracks"
"$bin/lookout-export" --in lake.lcmlog --table obstacles 2>/dev/null | grep -q ',ok' || fail "no obstacle has a place on the earth"
# Out of the log the same again: its RUN_INFO holds the values of the one file.
"$bin/lookout-replay" --config boat --in lake.lcmlog --out same.lcmlog >same.txt 2>said.txt || fail "the replay of the log"
diff digests.txt same.txt || fail "the replay of the log differs"
if grep -qi 'config' said.txt; then fail "the config is not that of the log"; fi
# The same values in files of their own, as boats had them: the same bytes.
mkdir files
grep -vE '^(lidar_input|navigator|tracker) |^ |^\}' boat/boat.txtpb >files/boat.txtpb
sed -n '/^lidar_input {/,/^}/p' boat/boat.txtpb | sed '1d;$d' >files/lidar.txtpb
sed -n '/^navigator {/,/^}/p' boat/boat.txtpb | sed '1d;$d' >files/navigator.txtpb
sed -n 's/^tracker { \(.*\) }$/\1/p' boat/boat.txtpb >files/tracker.txtpb
for file in georeferencer segmenter recorder; do echo '# nothing but defaults' >"files/$file.txtpb"; done
"$bin/lookout-replay" --config files --in lake.pcap --out files.lcmlog >files.txt 2>said.txt || fail "the replay with files"
diff digests.txt files.txt || fail "sections and files differ"
cp boat/boat.txtpb said.txt
cp -r boat both && echo 'cpa_limit_m: 7' >both/tracker.txtpb
code=0; "$bin/lookout-replay" --config both --in lake.pcap --out both.lcmlog >said.txt 2>&1 || code=$?
[ "$code" -eq 2 ] || fail "a section beside its file: exit code $code"
line=$(grep -n '^tracker' boat/boat.txtpb | cut -d: -f1)
grep -q "both/boat.txtpb:$line: tracker: stands beside tracker.txtpb" said.txt || fail "a section beside its file is not told"

# --- What is wrong, and what is there already ---
sed 's/behind_bow_m: 0.7/behind_bow_m: 70/' answers.txtpb >wrong.txtpb
code=0; setup --in lake.pcap --answers wrong.txtpb --out new || code=$?
[ "$code" -eq 2 ] || fail "wrong answers: exit code $code"
grep -q 'wrong.txtpb:4: lidar: behind_bow_m is more than 2 m outside' said.txt || fail "wrong answers have no line"
echo 'hull: 3' >wrong.txtpb
code=0; setup --in lake.pcap --answers wrong.txtpb --out new || code=$?
[ "$code" -eq 2 ] && grep -q 'wrong.txtpb:1: hull: ' said.txt || fail "an unknown answer: exit code $code"
[ ! -e new ] || fail "something was written"
code=0; setup --in lake.pcap --answers answers.txtpb --out boat || code=$?
[ "$code" -eq 1 ] && grep -q 'boat/boat.txtpb exists: --force' said.txt || fail "a boat was written over: exit code $code"
cp -r "$source_folder/config/catabot" old
setup --in lake.pcap --answers answers.txtpb --out old --force || fail "--force"
cmp old/boat.txtpb boat/boat.txtpb || fail "--force writes another boat"
for file in boat lidar navigator page tracker; do cmp "old/$file.txtpb.old" "$source_folder/config/catabot/$file.txtpb" || fail "$file.txtpb is not kept"; done
"$bin/lookout-up" --config old --check >said.txt 2>&1 || fail "the new boat beside files that stayed"

# --- By hand ---
printf '%s\n' Ida 2,4 '2.4 x 1.4' '0.7 -0.1 1.5' 5 '1 -0.5' '2.0 0.4 1.3' '' '' '' | "$bin/lookout-setup" --in lake.pcap --out typed >said.txt 2>&1 || fail "typed answers"
cmp typed/boat.txtpb boat/boat.txtpb || fail "typed answers give another file than the same ones in a file"
grep -q '^9 questions' said.txt || fail "not nine questions"
grep -q 'seen from starboard' said.txt || fail "no picture"
code=0; printf 'Ida\n2.4 x 1.4\n' | "$bin/lookout-setup" --in lake.pcap --out ended >said.txt 2>&1 || code=$?
[ "$code" -eq 1 ] && [ ! -e ended ] && grep -q 'nothing was written' said.txt || fail "the end of the input: exit code $code"

# --- Live, by this computer's own ports: the same boat ---
"$bin/lookout-sim" --config "$source_folder/config/demo" --scene lake --seed 101 --seconds 30 --udp 127.0.0.1 >sim.txt 2>&1 &
pid=$!
for _ in $(seq 50); do grep -q '[0-9a-f]*:0' /proc/net/udp && break; sleep 0.1; done
setup --seconds 4 --answers answers.txtpb --out live || fail "live"
sed 's/ at 127.0.0.1//' said.txt | grep -q '^lidar: Velodyne VLP-16, port 2368' || fail "no lidar is heard"
cmp live/boat.txtpb boat/boat.txtpb || { diff live/boat.txtpb boat/boat.txtpb; fail "live another boat is written"; }
setup --seconds 0 --answers answers.txtpb --out absent || fail "--seconds 0"
grep -q 'None was heard' absent/boat.txtpb || fail "it heard something in no time"
"$bin/lookout-up" --config absent --check >said.txt 2>&1 || fail "a boat that was not heard"
echo "a boat in one file, from a recording, typed, and live"
