#!/usr/bin/env bash
# Formats of others, written and read by programs of others.
#   formats_test.sh TRIAL SOURCE_FOLDER BUILD_FOLDER     (ros, mcap, foxglove, las or pcd)
# Packages of npm are installed into the build folder, as package-lock.json has them: without the network the trial is skipped.
set -euo pipefail
trial=$1
source_folder=$2
build=$3
here=$source_folder/tests/formats
npm_folder=$build/formats/npm
skip() { echo "skipped: $*"; exit 77; }
python=/usr/bin/python3  # Debian's, which has Debian's packages
[ -x $python ] || skip "there is no $python"
$python -c 'import numpy, pandas' 2>/dev/null || skip "python3-pandas is not installed"
[ "$trial" != pcd ] || command -v pcl_convert_pcd_ascii_binary >/dev/null || skip "pcl-tools is not installed"
[ "$trial" != ros ] || $python -c 'import rosbag' 2>/dev/null || skip "python3-rosbag is not installed"
for program in npm node zstd lz4; do command -v $program >/dev/null || skip "$program is not installed"; done
if ! cmp -s "$here/package-lock.json" "$npm_folder/installed"; then
  rm -rf "$npm_folder"
  mkdir -p "$npm_folder"
  cp "$here/package.json" "$here/package-lock.json" "$npm_folder"
  if ! (cd "$npm_folder" && npm ci --ignore-scripts --omit=optional --no-audit --no-fund >npm.log 2>&1); then
    grep -Eq 'ENOTFOUND|ECONNREFUSED|ETIMEDOUT|EAI_AGAIN' "$npm_folder/npm.log" && skip "no network for npm"
    cat "$npm_folder/npm.log"
    exit 1
  fi
  cp "$here/package-lock.json" "$npm_folder/installed"
fi
command=("$python" -B "$here/${trial}_test.py" "$source_folder" "$build" "$npm_folder")
[ "$trial" = foxglove ] || exec "${command[@]}"
command -v lcm-logplayer >/dev/null || skip "lcm-logplayer is not installed"
exec "$source_folder/tests/system/in_namespace.sh" route "${command[@]}"
