#!/usr/bin/env bash
# The Python example of lcmtypes/README.md, as it stands there, on a log of our own: as many obstacles as lookout-export finds, at the same places.
#   python_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
source_folder=$1
bin=$2/bin
work=$(mktemp -d -t lookout_python.XXXXXX)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }
python=/usr/bin/python3  # Debian's, which has Debian's pandas
[ -x $python ] || python=python3
for program in $python lcm-gen; do
  command -v "$program" >/dev/null || { echo "skipped: there is no $program here"; exit 77; }
done

sed -n '/^```python$/,/^```$/p' "$source_folder/lcmtypes/README.md" | sed '/^```/d' >"$work/obstacles.py"
[ "$(wc -l <"$work/obstacles.py")" -gt 10 ] || fail "lcmtypes/README.md holds no Python example"
lcm-gen -p --ppath "$work/python" "$source_folder"/lcmtypes/*.lcm
export PYTHONPATH=$work/python PYTHONDONTWRITEBYTECODE=1
"$bin/lookout-sim" --config "$source_folder/config/demo" --scene lake --seed 1 --seconds 1 --pcap "$work/sim.pcap" >/dev/null
"$bin/lookout-replay" --config "$source_folder/config/demo" --in "$work/sim.pcap" --out "$work/day.lcmlog" >/dev/null 2>&1
"$bin/lookout-export" --in "$work/day.lcmlog" --table obstacles | tail -n +2 >"$work/table.csv"

# The part that needs no pandas, and what lookout-export says.
sed '/^import pandas/,$d' "$work/obstacles.py" >"$work/rows.py"
printf 'for row in rows:\n    print("%%d,%%d,%%.9f,%%.9f" %% (row[0], row[1], row[3], row[4]))\n' >>"$work/rows.py"
$python "$work/rows.py" "$work/day.lcmlog" | sed 's/nan//g' >"$work/rows.csv"
cut -d, -f1,3,4,5 "$work/table.csv" >"$work/expected.csv"
[ -s "$work/expected.csv" ] || fail "the log holds no obstacles"
cmp "$work/rows.csv" "$work/expected.csv" || { diff "$work/rows.csv" "$work/expected.csv" | head -n 5; fail "Python reads other obstacles"; }

if ! $python -c 'import pandas' 2>/dev/null; then
  echo "skipped: the example's lines with pandas, which is not installed (python3-pandas); all others were run"
  exit 0
fi
$python "$work/obstacles.py" "$work/day.lcmlog" | tail -n 1 | grep -q "^\[$(wc -l <"$work/table.csv") rows x 11 columns\]" || fail "pandas has another number of rows"
