#!/usr/bin/env bash
# One trial of the page in chromium, in a network namespace of its own: nothing outside of this computer can be reached.
#   page_test.sh film|live SOURCE_FOLDER BUILD_FOLDER
#   page_test.sh figures SOURCE_FOLDER BUILD_FOLDER [SECONDS]   (./dev bench page)
#   page_test.sh pictures SOURCE_FOLDER BUILD_FOLDER   those of services/page/README.md (./dev pictures)
# Packages of npm are installed into the build folder, as package-lock.json has them: without the network the trial is skipped.
set -euo pipefail
trial=$1
source_folder=$2
build=$3
shift 3
here=$source_folder/tests/page
skip() { echo "skipped: $*"; exit 77; }

command -v npm >/dev/null || skip "npm is not installed"
[ -x /usr/bin/chromium ] || skip "chromium is not installed"
folder=$build/page_tests
if ! cmp -s "$here/package-lock.json" "$folder/installed"; then
  rm -rf "$folder"
  mkdir -p "$folder"
  cp "$here/package.json" "$here/package-lock.json" "$here/.npmrc" "$folder"
  if ! (cd "$folder" && npm ci --no-audit --no-fund >npm.log 2>&1); then
    grep -Eq 'ENOTFOUND|ECONNREFUSED|ETIMEDOUT|EAI_AGAIN' "$folder/npm.log" && skip "no network for npm"
    cat "$folder/npm.log"
    exit 1
  fi
  cp "$here/package-lock.json" "$folder/installed"
fi
# Modules are looked for beside the file that asks for them.
cp "$here"/*.mjs "$folder"
export LOOKOUT_SOURCE=$source_folder LOOKOUT_BIN=$build/bin
# The same log each time: the same bytes out of the same seed; made anew by newer programs, and after a trial that was cut off.
lacks() { [ ! -f "$1" ] || [ "$build/bin/lookout-sim" -nt "$1" ] || [ "$build/bin/lookout-replay" -nt "$1" ]; }
log=$folder/crossing.lcmlog
if lacks "$log"; then
  rm -rf "$folder/truth"
  "$build/bin/lookout-sim" --config "$source_folder/config/demo" --scene crossing --seed 1 --seconds 30 --force --pcap "$folder/crossing.pcap" --truth "$folder/truth" >/dev/null
  "$build/bin/lookout-replay" --config "$source_folder/config/demo" --in "$folder/crossing.pcap" --out "$log" --force >/dev/null
fi
export LOOKOUT_LOG=$log
# The same journey under another config, of a boat without a compass, and of one without a position.
replayed() {  # NAME CONFIG CAPTURE
  ! lacks "$folder/$1.lcmlog" || "$build/bin/lookout-replay" --config "$2" --in "$3" --out "$folder/$1.lcmlog" --force >/dev/null
}
config_of() {  # NAME: a copy of the demo's
  rm -rf "$folder/config_$1"
  cp -r "$source_folder/config/demo" "$folder/config_$1"
}
if [ "$trial" = film ]; then
  config_of other
  echo 'max_range_m: 60' >>"$folder/config_other/segmenter.txtpb"
  sed -i 's/range_m: 10/range_m: 16/' "$folder/config_other/tracker.txtpb"
  replayed other "$folder/config_other" "$folder/crossing.pcap"
  ! lacks "$folder/course.pcap" || "$build/bin/lookout-sim" --force --config "$source_folder/config/demo" --scene crossing --seed 1 --seconds 8 --no-heading --pcap "$folder/course.pcap" >/dev/null
  replayed course "$source_folder/config/demo" "$folder/course.pcap"
  config_of nowhere
  sed -i 's/use_lidar_nmea: true/use_lidar_nmea: false nmea_port: 9999/' "$folder/config_nowhere/navigator.txtpb"
  replayed nowhere "$folder/config_nowhere" "$folder/crossing.pcap"
fi
case $trial in
  pictures) command=(node "$folder/pictures.mjs") ;;
  figures)
    export LOOKOUT_LOAD=$build/bench/load_page LOOKOUT_DUAL_LOG=$folder/dual.lcmlog
    if [ ! -f "$LOOKOUT_DUAL_LOG" ]; then
      "$build/bin/lookout-sim" --config "$source_folder/config/demo" --scene marina --seed 1 --seconds 12 --return-mode dual --pcap "$folder/dual.pcap" >/dev/null
      "$build/bin/lookout-replay" --config "$source_folder/config/demo" --in "$folder/dual.pcap" --out "$LOOKOUT_DUAL_LOG" >/dev/null
    fi
    command=(node "$folder/figures.mjs" "$@")
    ;;
  live) command=(node --test --test-concurrency=1 "$folder/live.test.mjs") ;;
  film) command=(node --test --test-concurrency=1 "$folder/film.test.mjs") ;;
  *) echo "unknown trial: $trial" >&2; exit 2 ;;
esac
exec "$source_folder/tests/system/in_namespace.sh" route "${command[@]}"
