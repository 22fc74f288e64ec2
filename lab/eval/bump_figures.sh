#!/usr/bin/env bash
# The figures of lookout-doctor --mounting (tools/doctor/README.md), measured anew on the simulator: 20 s of one core for each seed of a scene.
#   lab/eval/bump_figures.sh [SEEDS [FIRST [SECONDS]]]   seeds of each scene (default 20), the first of them (default 101), length of a run (default 60)
# LOOKOUT_BUMP_KEEP=FILE adds the rows of each run to FILE and makes the table of all rows in it. LOOKOUT_BUMP_ROWS="SCENE:NAVIGATION:KINDS ..." runs some
# rows alone; KINDS: "bump" (by 2 deg: yaw, roll and pitch, up and down, one after the other with the seed), "none", "compass" (3 deg off), joined by "+".
# The truth is config/demo. After a bump boat.txtpb says what was true before it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seeds=${1:-20}
first=${2:-101}
seconds=${3:-60}
made=config/scenes/calibration
table=${LOOKOUT_BUMP_ROWS:-marina:rtk:bump+none islands:rtk:bump+none lake:rtk:bump+none marina:standalone:bump+none $made/rough_marina.txtpb:rtk:bump+none
  $made/all_adrift.txtpb:rtk:none canal:rtk:none marina:rtk:compass}
bin=build/release/bin
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
rows=${LOOKOUT_BUMP_KEEP:-$work/rows.csv}
touch "$rows"

# boat ROLL PITCH YAW COMPASS: a config whose angles are so much off the truth, in degrees
boat() {
  rm -rf "$work/boat"
  cp -r config/demo "$work/boat"
  local pitch
  pitch=$(awk -v pitch="$2" 'BEGIN { print pitch - 0.5 }')
  sed -i -E "s/^(lidar .*) roll_deg: .* \}/\1 roll_deg: $((1 + $1)) pitch_deg: $pitch yaw_deg: $((5 + $3)) }/" "$work/boat/boat.txtpb"
  sed -i "s/^heading_offset_deg: 0/heading_offset_deg: $4/" "$work/boat/navigator.txtpb"
}

# ask SCENE NAVIGATION SEED KIND VERB DIRECTION: a row. "right": a bump in these words alone; "silent": none is told; "unknown"; else "wrong"
ask() {
  local code=0 verdict=wrong text
  "$bin/lookout-doctor" --config "$work/boat" --mounting --in "$work/run.pcap" >"$work/said" 2>&1 || code=$?
  [ "$code" -eq 0 ] || { cat "$work/said" >&2; exit 1; }
  text=$(tr -s ' \n' ' ' <"$work/said")
  case $text in
    *"is not known"*) verdict=unknown ;;
    *"points as boat.txtpb says"*) verdict=silent ;;
    *"the lidar $5 "?.?" deg (deviation "?.??") $6 than boat.txtpb says: was it bumped?"*) verdict=right ;;
  esac
  echo "$(basename "$1" .txtpb),$2,$3,$4,$verdict,$text" >>"$rows"
}

for row in $table; do
  IFS=: read -r scene navigation kinds <<<"$row"
  for ((seed = first; seed < first + seeds; ++seed)); do
    "$bin/lookout-sim" --config config/demo --scene "$scene" --seed "$seed" --seconds "$seconds" --navigation "$navigation" --pcap "$work/run.pcap" --force \
      >"$work/sim" 2>&1 || { cat "$work/sim" >&2; exit 1; }
    if [[ $kinds == *none* ]]; then
      boat 0 0 0 0
      ask "$scene" "$navigation" "$seed" none '' ''
    fi
    if [[ $kinds == *compass* ]]; then
      boat 0 0 0 3
      ask "$scene" "$navigation" "$seed" compass 'is turned' 'farther to port'
    fi
    if [[ $kinds == *bump* ]]; then
      # The lidar was turned by so much from what boat.txtpb says.
      case $((seed % 6)) in
        0) boat 0 0 -2 0; ask "$scene" "$navigation" "$seed" bump 'is turned' 'farther to port' ;;
        1) boat 0 0 2 0; ask "$scene" "$navigation" "$seed" bump 'is turned' 'farther to starboard' ;;
        2) boat -2 0 0 0; ask "$scene" "$navigation" "$seed" bump 'leans' 'farther to starboard' ;;
        3) boat 2 0 0 0; ask "$scene" "$navigation" "$seed" bump 'leans' 'farther to port' ;;
        4) boat 0 2 0 0; ask "$scene" "$navigation" "$seed" bump 'leans' 'farther aft' ;;
        5) boat 0 -2 0 0; ask "$scene" "$navigation" "$seed" bump 'leans' 'farther forward' ;;
      esac
    fi
  done
done

awk -F, '
  { key = $1 ", " $2 ", " $4; if (!(key in runs)) order[++num] = key; ++runs[key]; ++verdicts[key, $5] }
  END {
    print "| scene, GNSS and compass, kind | runs | the bump told, and nothing else | no bump told | not known | wrong |"
    print "|---|---|---|---|---|---|"
    for (i = 1; i <= num; ++i)
      printf "| %s | %d | %d | %d | %d | %d |\n", order[i], runs[order[i]], verdicts[order[i], "right"], verdicts[order[i], "silent"],
        verdicts[order[i], "unknown"], verdicts[order[i], "wrong"]
  }' "$rows"
