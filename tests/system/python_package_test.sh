#!/usr/bin/env bash
# The Python package out of the sources, its page's example as it stands there, and the package as pip installs it.
#   python_package_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
source_folder=$1
bin=$2/bin
work=$(mktemp -d -t lookout_package.XXXXXX)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }
python=/usr/bin/python3  # Debian's, which has Debian's numpy
[ -x $python ] || python=python3
$python -c 'import numpy' 2>/dev/null || { echo "skipped: python3-numpy is not installed"; exit 77; }
export PYTHONDONTWRITEBYTECODE=1
"$bin/lookout-sim" --config "$source_folder/config/demo" --scene lake --seed 1 --seconds 2 --pcap "$work/sim.pcap" >/dev/null
"$bin/lookout-replay" --config "$source_folder/config/demo" --in "$work/sim.pcap" --out "$work/day.lcmlog" >/dev/null 2>&1
mkdir "$work/from_sources" "$work/installed"
PYTHONPATH=$source_folder/python $python "$source_folder/tests/system/python_package_test.py" "$bin" "$work/day.lcmlog" \
  "$source_folder/tests/golden/fingerprints.txt" "$work/from_sources"

# The examples of the page, each as it stands there: example_1.py is of logs, 2 live, 3 a picture.
awk -v folder="$work" '/^```python$/ { file = folder "/example_" ++number ".py"; next } /^```$/ { file = "" } file { print > file }' "$source_folder/python/README.md"
for number in 1 2 3; do [ "$(wc -l <"$work/example_$number.py")" -ge 9 ] || fail "python/README.md lacks its example $number"; done
PYTHONPATH=$source_folder/python $python "$work/example_1.py" "$work/day.lcmlog" >"$work/example.txt"
grep -q ' obstacles, [0-9]* sure ones within 30 m' "$work/example.txt" && grep -q ' returns, the nearest at ' "$work/example.txt" || fail "the example"
if $python -c 'import matplotlib' 2>/dev/null; then
  PYTHONPATH=$source_folder/python $python "$work/example_3.py" "$work/day.lcmlog" "$work/scan.png" >/dev/null
  [ "$(head -c 4 "$work/scan.png" | tail -c 3)" = PNG ] || fail "the picture"
else
  echo "skipped: the picture of a scan: python3-matplotlib is not installed"
fi
# Live: a log is played on the bus by LCM's own player, with messages that are cut into fragments.
if command -v lcm-logplayer >/dev/null; then
  PYTHONPATH=$source_folder/python $python "$source_folder/tests/system/python_live_test.py" "$work/day.lcmlog" "$work/example_2.py" "$work"
else
  echo "skipped: live messages: lcm-logplayer is not installed"
fi

$python -W ignore -c 'import ensurepip, setuptools, venv' 2>/dev/null ||
  { echo "skipped: the package as pip installs it: python3-pip, python3-setuptools or python3-venv is not installed"; exit 0; }
cp -r "$source_folder/python" "$source_folder/lcmtypes" "$work"  # pip builds in the folder
$python -m venv --system-site-packages "$work/venv"
"$work/venv/bin/pip" install --quiet --no-build-isolation --no-deps --no-index "$work/python" >"$work/pip.log" 2>&1 || { cat "$work/pip.log"; fail "pip"; }
rm -r "$work/python" "$work/lcmtypes"
(cd "$work" && venv/bin/python "$source_folder/tests/system/python_package_test.py" "$bin" "$work/day.lcmlog" "$source_folder/tests/golden/fingerprints.txt" \
  "$work/installed")
