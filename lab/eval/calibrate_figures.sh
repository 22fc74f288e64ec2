#!/usr/bin/env bash
# The figures of tools/calibrate/README.md, measured anew: lookout-calibrate on the simulator. Two minutes of one core a run.
#   lab/eval/calibrate_figures.sh [SEEDS [FIRST [SECONDS]]]   seeds of each scene (default 20), the first of them (default 101), length of a run (default 70)
# LOOKOUT_CALIBRATE_KEEP=FILE keeps the rows of each run; LOOKOUT_CALIBRATE_PARTS="mounting turned straight" runs some parts alone.
# The truth is config/demo. Each run is given a boat.txtpb whose roll, pitch and yaw are wrong by up to 10 deg each, and a lidar whose clock is up to 50 ms
# ahead, both drawn from the seed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seeds=${1:-20}
first=${2:-101}
seconds=${3:-70}
parts=${LOOKOUT_CALIBRATE_PARTS:-mounting turned straight}
bin=build/release/bin
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
rows=${LOOKOUT_CALIBRATE_KEEP:-$work/rows.csv}
: >"$rows"
true_roll=1.0
true_pitch=-0.5
true_yaw=5.0

# drawn SEED: three offsets in degrees, and seconds
drawn() { awk -v seed="$1" 'BEGIN { srand(seed); printf "%.2f %.2f %.2f %.3f\n", 20 * rand() - 10, 20 * rand() - 10, 20 * rand() - 10, 0.05 * rand() }'; }

# boat ROLL PITCH YAW: a config with these angles
boat() {
  rm -rf "$work/boat"
  cp -r config/demo "$work/boat"
  sed -i -E "s/^(lidar .*) roll_deg: .* \}/\1 roll_deg: $1 pitch_deg: $2 yaw_deg: $3 }/" "$work/boat/boat.txtpb"
}

# record SCENE SEED SECONDS SHIFT
record() {
  rm -f "$work/run.pcap"
  "$bin/lookout-sim" --config config/demo --scene "$1" --seed "$2" --seconds "$3" --pcap "$work/run.pcap" --fault "wrong_stamp:0:86400:$4" >"$work/sim" 2>&1 ||
    { cat "$work/sim" >&2; exit 1; }
}

# calibrate PART SCENE SEED SHIFT: a row; the report of a run that turned is looked at for its words
calibrate() {
  local code=0
  "$bin/lookout-calibrate" --config "$work/boat" --in "$work/run.pcap" --figures >"$work/figures" 2>"$work/said" || code=$?
  local named=0
  grep -q 'the lidar is not mounted as boat.txtpb says' "$work/said" && named=1
  [ "$code" -le 1 ] || { cat "$work/said" >&2; exit 1; }
  awk -v part="$1" -v scene="$(basename "$2" .txtpb)" -v seed="$3" -v shift_ms="$(awk -v s="$4" 'BEGIN { print 1000 * s }')" -v code="$code" -v named="$named" \
    -v roll="$true_roll" -v pitch="$true_pitch" -v yaw="$true_yaw" '
    { value[$1] = $2; sd[$1] = $3 }
    END {
      error = value["yaw_deg"] - yaw
      while (error > 180) error -= 360
      while (error < -180) error += 360
      printf "%s,%s,%d,%d,%d,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f,%.3f,%.3f,%.3f,%.4f,%.4f\n", part, scene, seed, code, named, error, sd["yaw_deg"],
        value["roll_deg"] - roll, sd["roll_deg"], value["pitch_deg"] - pitch, sd["pitch_deg"], value["latency_ms"] + shift_ms, sd["latency_ms"],
        value["tilt_latency_ms"] + shift_ms, sd["tilt_latency_ms"], value["height_m"], sd["height_m"]
    }' "$work/figures" >>"$rows"
}

for ((seed = first; seed < first + seeds; ++seed)); do
  read -r roll pitch yaw shift < <(drawn "$seed")
  if [[ $parts == *mounting* ]]; then
    boat "$(awk -v a=$true_roll -v b="$roll" 'BEGIN { print a + b }')" "$(awk -v a=$true_pitch -v b="$pitch" 'BEGIN { print a + b }')" \
      "$(awk -v a=$true_yaw -v b="$yaw" 'BEGIN { print a + b }')"
    for scene in lake marina islands config/scenes/calibration/shore_20m_turning.txtpb; do
      record "$scene" "$seed" "$seconds" "$shift"
      calibrate mounting "$scene" "$seed" "$shift"
    done
  fi
  if [[ $parts == *turned* ]]; then
    # Upside down, on a side, and turned about up, one after the other.
    case $((seed % 6)) in
      0) boat "$true_roll" "$true_pitch" $((5 + 90)) ;;
      1) boat "$true_roll" "$true_pitch" $((5 - 90)) ;;
      2) boat "$true_roll" "$true_pitch" $((5 + 180)) ;;
      3) boat 179 "$true_pitch" 5 ;;
      4) boat 91 "$true_pitch" 5 ;;
      5) boat "$true_roll" 89 5 ;;
    esac
    record marina "$seed" 40 0
    calibrate turned marina "$seed" 0
  fi
  if [[ $parts == *straight* ]]; then
    boat "$true_roll" "$true_pitch" "$true_yaw"
    record config/scenes/calibration/straight_open_water.txtpb "$seed" 60 0
    calibrate straight config/scenes/calibration/straight_open_water.txtpb "$seed" 0
  fi
done

awk -F, '
  function p95(list, num,   i, k, swap) {
    for (i = 2; i <= num; ++i) for (k = i; k > 1 && list[k] < list[k - 1]; --k) { swap = list[k]; list[k] = list[k - 1]; list[k - 1] = swap }
    k = int(0.95 * num + 0.999); return num ? list[k < 1 ? 1 : k] : 0
  }
  function abs(x) { return x < 0 ? -x : x }
  { part = $1; scene = $2 }
  part == "mounting" {
    if (!(scene in runs)) order[++num_scenes] = scene
    ++runs[scene]
    if ($4 != 0) { ++refused[scene]; next }
    n = ++found[scene]
    for (q = 0; q < 4; ++q) { e[scene, q, n] = abs($(6 + 2 * q)); if (abs($(6 + 2 * q)) <= 2 * $(7 + 2 * q)) ++within[scene, q] }
    if (e[scene, 0, n] <= 0.15 && e[scene, 1, n] <= 0.3 && e[scene, 2, n] <= 0.3 && e[scene, 3, n] <= 3) ++good[scene]
    if ($17 > 0) { ++heights[scene]; h[scene, heights[scene]] = abs($16 - 1.5) }
  }
  part == "turned" { ++turned; named += $5 && $4 == 0 }
  part == "straight" { ++straight; straight_refused += $4 == 1 }
  END {
    if (num_scenes) {
      print "| scene | runs, refused | all four within their limits | yaw p95 deg, in 2 sd | roll | pitch | latency p95 ms, in 2 sd | height p95 m, runs with one |"
      print "|---|---|---|---|---|---|---|---|"
    }
    for (i = 1; i <= num_scenes; ++i) {
      s = order[i]
      line = sprintf("| %s | %d, %d | %d |", s, runs[s], refused[s], good[s])
      for (q = 0; q < 4; ++q) {
        for (n = 1; n <= found[s]; ++n) list[n] = e[s, q, n]
        line = line sprintf(q == 3 ? " %.1f, %d |" : " %.3f, %d |", p95(list, found[s]), within[s, q])
      }
      for (n = 1; n <= heights[s]; ++n) list[n] = h[s, n]
      print line sprintf(" %.3f, %d |", p95(list, heights[s]), heights[s])
    }
    if (turned) printf "\nTurned by 90 or 180 deg, or upside down: %d of %d named and found.\n", named, turned
    if (straight) printf "\nStraight run in open water: %d of %d refused.\n", straight_refused, straight
  }' "$rows"
