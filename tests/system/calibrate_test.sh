#!/usr/bin/env bash
# lookout-calibrate as a user runs it: a boat.txtpb that is wrong, a recording of turns in the marina, and a straight run in open water.
#   calibrate_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -uo pipefail
source_folder=$1
bin=$2
work=$(mktemp -d -t calibrate.XXXXXX)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
num_failed=0
fail() { echo "FAILED: $*" >&2; sed 's/^/  | /' said >&2; num_failed=$((num_failed + 1)); }
expect() {  # CODE ARGUMENT ...
  local wanted=$1 code=0
  shift
  "$bin/lookout-calibrate" "$@" >said 2>&1 || code=$?
  [ "$code" -eq "$wanted" ] || fail "lookout-calibrate $*: exit code $code, not $wanted"
}
says() { grep -qF -- "$1" said || fail "it does not say '$1'"; }

cp -r "$source_folder/config/demo" boat
# The truth is roll 1, pitch -0.5, yaw 5.
sed -i 's/roll_deg: 1.0 pitch_deg: -0.5 yaw_deg: 5.0/roll_deg: -5.0 pitch_deg: 6.0 yaw_deg: 101.0/' boat/boat.txtpb
cp boat/boat.txtpb wrong.txtpb
"$bin/lookout-sim" --config "$source_folder/config/demo" --scene marina --seed 1 --seconds 40 --pcap marina.pcap >said 2>&1 || fail sim
"$bin/lookout-replay" --config "$source_folder/config/demo" --in marina.pcap --out marina.lcmlog --only lidar --only navigator >said 2>&1 || fail replay

# Writes nothing unasked.
expect 0 --config boat --in marina.lcmlog --picture marina.svg --pairs pairs.csv
says 'the lidar is not mounted as boat.txtpb says: turned by 90 deg to starboard'
says 'for boat.txtpb:'
cmp -s boat/boat.txtpb wrong.txtpb || fail 'boat.txtpb was changed without --write'
grep -q '</svg>' marina.svg || fail 'no picture'
[ "$(grep -c 'd="M' marina.svg)" = 2 ] || fail 'a picture without what stands'
[ "$(wc -l <pairs.csv)" -gt 50 ] || fail 'no pairs'
cp said report

# Pictures are not replaced unasked; the angles are written, the old file stays, and a second one is refused.
expect 1 --config boat --in marina.lcmlog --picture marina.svg
says 'exists already'
expect 0 --config boat --in marina.pcap --write --figures
cmp -s boat/boat.txtpb.old wrong.txtpb || fail 'the old file is another one'
awk '/^lidar / { roll = $0; sub(/.*roll_deg: /, "", roll); pitch = $0; sub(/.*pitch_deg: /, "", pitch); yaw = $0; sub(/.*yaw_deg: /, "", yaw)
       exit !(roll + 0 > 0.7 && roll + 0 < 1.3 && pitch + 0 > -0.8 && pitch + 0 < -0.2 && yaw + 0 > 4.7 && yaw + 0 < 5.3) }' boat/boat.txtpb ||
  { cat boat/boat.txtpb >said; fail 'the angles are not those of the simulated boat'; }
cp boat/boat.txtpb written.txtpb
expect 1 --config boat --in marina.lcmlog --write
says 'boat.txtpb.old'
cmp -s boat/boat.txtpb written.txtpb || fail 'boat.txtpb was changed although the old file could not be kept'

# Nothing is to be seen on a straight run in open water.
"$bin/lookout-sim" --config "$source_folder/config/demo" --scene "$source_folder/config/scenes/calibration/straight_open_water.txtpb" --seed 1 --seconds 20 \
  --pcap straight.pcap >said 2>&1 || fail sim
rm boat/boat.txtpb.old
expect 1 --config boat --in straight.pcap --write
says 'refused: '
says 'missing: go near what stands'
cmp -s boat/boat.txtpb written.txtpb || fail 'boat.txtpb was changed by a refused calibration'

expect 2 --config boat
expect 2 --config nowhere --in marina.lcmlog
expect 1 --config boat --in boat/boat.txtpb
[ "$num_failed" -eq 0 ] && echo 'lookout-calibrate: finds, names, writes and refuses as it should'
exit "$num_failed"
