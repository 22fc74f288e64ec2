#!/usr/bin/env bash
# lookout-archive from a folder of recordings to the comparison, on this computer alone, with what archives hold: damaged, foreign and older files, odd
# names, links in a circle; outputs that were changed, workers that were killed.
#   archive_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -uo pipefail
export LC_ALL=C
source_folder=$1
bin=$2
config=$source_folder/config/demo
work=$(mktemp -d -t archive.XXXXXX)
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
cd "$work" || exit 1

num_failed=0
fail() { echo "FAILED: $*" >&2; sed 's/^/  | /' said >&2; num_failed=$((num_failed + 1)); }
archive() { "$bin/lookout-archive" "$@" >said 2>&1; }
expect_code() {  # CODE ARGUMENTS
  local wanted=$1 code
  shift
  archive "$@"
  code=$?
  [ "$code" -eq "$wanted" ] || fail "lookout-archive $*: exit code $code, not $wanted"
}
says() { grep -qF -- "$1" said || fail "does not say: $1"; }
sim() {  # SCENE SEED SECONDS FILE MORE
  "$bin/lookout-sim" --config "$config" --scene "$1" --seed "$2" --seconds "$3" --pcap "$4" "${@:5}" >said 2>&1 || fail "lookout-sim $1"
}
replay() { "$bin/lookout-replay" --config "$config" --in "$1" --out "$2" >said 2>&1 || fail "lookout-replay $1"; }
# Of all results, names and bytes.
tree() { (cd "$1/results" && find . -type f -print0 | sort -z | xargs -0 sha256sum | sha256sum); }

mkdir logs
sim black_buoys 101 2 logs/black_buoys-101.pcap --truth logs/black_buoys-101.truth
sim dense 101 2 logs/dense-101.pcap
replay logs/dense-101.pcap logs/dense-102.lcmlog
odd="logs/$(printf 'a\nnew line $(x) %%dir')/$(printf 'n%.0s' {1..240})"
mkdir -p "$odd"
cp logs/dense-101.pcap "$odd/it's \"one\".pcap"
head -c 700000 logs/dense-102.lcmlog >logs/torn-1.lcmlog
echo 'notes' >logs/notes.txt
mkdir logs/many
for i in 1 2 3 4; do echo 'more notes' >"logs/many/$i.txt"; done
head -c 5000 /dev/urandom >logs/junk.bin
: >logs/empty.lcmlog
mkdir logs/loop
ln -s .. logs/loop/up
ln -s nowhere logs/dangling
# The fingerprints of the raw types, but for one bit: another version's.
python3 - logs/dense-102.lcmlog logs/older-1.lcmlog <<'PYTHON'
import struct, sys
data = bytearray(open(sys.argv[1], "rb").read())
place = 0
while place + 28 <= len(data):
    channel, size = struct.unpack(">ii", data[place + 20:place + 28])
    if data[place + 28:place + 28 + channel] in (b"LIDAR_PACKETS", b"NAV_RAW"):
        data[place + 28 + channel] ^= 1
    place += 28 + channel + size
open(sys.argv[2], "wb").write(data)
PYTHON
# A capture without a packet for this boat.
python3 - logs/nothing-1.pcap <<'PYTHON'
import struct, sys
open(sys.argv[1], "wb").write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1))
PYTHON
# Recordings that are not used are each told, however many they are.
mkdir logs/old
for i in 1 2 3 4; do cp logs/older-1.lcmlog "logs/old/older-$i.lcmlog"; done
chmod -R a-w logs

expect_code 1 plan --config "$config"
says 'no archive here'
expect_code 2 scan nowhere
expect_code 0 scan logs
for text in 'foreign    '"$work/logs/notes.txt" 'foreign    4 files of '"$work/logs/many/ (1.txt, 2.txt, ...): is text" 'junk.bin' 'empty.lcmlog' 'is of other wire types than this version' 'older      '"$work/logs/old/older-4.lcmlog" 'damaged    '"$work/logs/torn-1" ' 6 runs'; do
  [ "$text" = ' 6 runs' ] && { grep -q '^6 runs' said || fail 'not 6 runs'; continue; }
  says "$text"
done
expect_code 0 scan logs
says ': 0 read,'

# A wrong config stops before all work.
cp -r "$config" wrong
echo 'sure_probability: 7' >>wrong/segmenter.txtpb
expect_code 2 plan --config wrong
says 'sure_probability'
[ ! -e archive/configs ] || fail 'a wrong config was kept'

expect_code 0 plan --config "$config" --name A
says 'A: 6 units, 0 done, 0 failed, 6 to do'
expect_code 2 run --name none
expect_code 2 run --only 'no_column = 1'
expect_code 2 run --engine nowhere
expect_code 0 run --limit 1 --only "run.scene = 'dense'"
says '1 done, 0 failed, 0 not done'
expect_code 1 run --jobs 2
says '4 units to do'  # dense-101 is there twice, and is one
says 'nothing-1.pcap: failed: lookout-replay'
says '3 done, 1 failed, 0 not done'
first=$(tree archive)
expect_code 0 plan --config "$config" --name A
says 'A: 6 units, 5 done, 1 failed, 0 to do'
expect_code 0 run
says '0 units to do, 1 failed before'

# Outputs that were changed or cut, and sidecars that are torn or forged, are made again: the same bytes.
file=$(find archive/results -name tracks.csv | sort | head -1)
echo >>"$file"
expect_code 0 plan --config "$config" --name A
says 'does not hold, and is made again: tracks.csv has another size'
sidecar=$(dirname "$(find archive/results -name pose.csv | sort | tail -1)").json
head -c 100 "$sidecar" >torn && cat torn >"$sidecar"
other=$(find archive/results -name '*.json' | sort | sed -n 3p)
[ "$other" != "$sidecar" ] || other=$(find archive/results -name '*.json' | sort | sed -n 2p)
sed -i 's/"remarks": \[/"remarks": ["forged"/' "$other"
archive run
says 'the sidecar cannot be used'
[ "$(tree archive)" = "$first" ] || fail 'repaired results are other ones'

# A worker and the whole run are killed; the same tree, and nothing is left of them.
expect_code 0 --archive killed scan logs
expect_code 0 --archive killed plan --config "$config" --name A
for pause in 0.15 0.4 0.7; do
  "$bin/lookout-archive" --archive killed run --jobs 2 >said 2>&1 &
  pid=$!
  sleep "$pause"
  if [ "$pause" = 0.4 ]; then pkill -KILL -P "$pid"; else kill -KILL "$pid" 2>/dev/null; fi
  wait "$pid" 2>/dev/null
done
archive --archive killed run --jobs 2
[ "$(tree killed)" = "$first" ] || fail 'after kills the results are other ones'
[ -z "$(find killed/work -mindepth 1 ! -name '*.lock' ! -name 'batches-*' ! -path '*/batches-*')" ] || fail "left in work: $(find killed/work -mindepth 1)"

# One recording is changed: one unit.
chmod u+w logs logs/dense-101.pcap
sim dense 103 2 logs/dense-101.pcap --force
archive run
says '0 units to do'
expect_code 0 scan logs
expect_code 0 plan --config "$config" --name A
says '4 done, 1 failed, 1 to do'

# A second planner waits for the first.
exec 9>archive/index.lock
flock 9
"$bin/lookout-archive" plan --config "$config" --name A >said 2>&1 9>&- &
for _ in $(seq 200); do grep -qs waiting said && break; sleep 0.05; done
says 'another program changes the index: waiting'
grep -q '^A: ' said && fail 'planned while the index was locked'
exec 9>&-
wait
says 'A: 6 units, 4 done, 1 failed, 1 to do'
archive run

# Two versions.
cp -r "$config" other
echo 'sure_probability: 0.995' >>other/segmenter.txtpb
expect_code 0 plan --config other --name B
archive run --jobs 2
expect_code 0 compare A A
says 'units_different                    0'
expect_code 0 compare A B --csv compared.csv --html compared.html --fail-if 'miou_drop > 90'
says 'worst first'
grep -q 'data:image/svg+xml' compared.html || fail 'no picture on the page'
grep -qF "'it'\\''s" <(sed 's/&quot;/"/g' compared.html) || grep -q 'new line' compared.html || fail 'the odd name is not on the page'
grep -qF "$(realpath "$bin")/lookout-replay --config $work/archive/configs/" compared.html || fail 'the commands are not those of the unit'
[ "$(head -1 compared.csv | tr , '\n' | wc -l)" -eq 31 ] || fail 'columns of the CSV file'
expect_code 1 compare A B --html compared.html  # it exists
expect_code 1 compare A B --fail-if 'obstacles_lost > 0'
says 'fails: obstacles_lost > 0'
expect_code 2 compare A B --fail-if 'nonsense > 0'
expect_code 2 compare A C

expect_code 0 query "SELECT scene, count(DISTINCT track_id) > 3 FROM tracks WHERE version = 'A' AND status = 'confirmed' AND scene = 'dense' GROUP BY run"
says 'dense,1'
expect_code 0 query "SELECT 'miou', count(*) FROM truth WHERE version = 'A' AND figure = 'miou' AND value > 50"
says 'miou,1'
expect_code 2 query 'DELETE FROM run'
expect_code 2 query 'SELECT nothing FROM tracks'

# Files below the config's folder belong to it; those elsewhere are refused.
cp -r "$config" nested
mkdir nested/evidence
cp "$source_folder/config/evidence/lookout.txtpb" nested/evidence/mine.txtpb
echo 'evidence: "evidence/mine.txtpb"' >>nested/segmenter.txtpb
expect_code 0 plan --config nested --name nested
expect_code 0 run --name nested --limit 1 --only "run.scene = 'dense'"
says '1 done, 0 failed, 0 not done'
expect_code 0 plan --config nested --name nested
says ' 1 done, 0 failed,'
echo '# more' >>nested/evidence/mine.txtpb
expect_code 0 plan --config nested --name nested
says ' 0 done, 0 failed,'
for elsewhere in "$work/nested/evidence/mine.txtpb" ../nested/evidence/mine.txtpb; do
  rm -rf outside
  cp -r "$config" outside
  echo "evidence: \"$elsewhere\"" >>outside/segmenter.txtpb
  expect_code 2 plan --config outside
  says "is outside of the config's folder"
done

# A program that is asked to stop has not failed, and a retry takes no more units than the limit; programs that change meanwhile make no result.
mkdir programs
cp "$bin"/lookout-{replay,log,import,eval} programs
cat >programs/lookout-export <<SCRIPT
#!/bin/bash
echo call >>"$work/calls"
if [ "\$(cat "$work/mode")" = stop ] && [ "\$(wc -l <"$work/calls")" -gt 5 ]; then echo 'lookout-export: stopped by SIGTERM' >&2; exit 1; fi
[ "\$(cat "$work/mode")" != change ] || echo more >>"$work/programs/lookout-log"
exec "$bin/lookout-export" "\$@"
SCRIPT
chmod +x programs/lookout-export
echo stop >mode
expect_code 0 plan --config "$config" --programs programs --name scripts
expect_code 1 run --name scripts --limit 2 --retries 1
says 'not done: lookout-export was stopped by SIGTERM'
says '1 units were not finished: again'
says '1 done, 0 failed, 1 not done'
echo change >mode
expect_code 1 run --name scripts --limit 1 --retries 1
says 'not done: its truth or the programs were changed meanwhile'
says 'are others than those of the plan'

# What a program reads it does not write over.
cp logs/dense-102.lcmlog in.lcmlog
cp -r logs/black_buoys-101.truth truth
chmod -R u+w in.lcmlog truth
before=$(sha256sum in.lcmlog truth/*)
"$bin/lookout-replay" --config "$config" --in in.lcmlog --out out.lcmlog --hashes in.lcmlog --force >said 2>&1 && fail '--hashes wrote over its input'
says 'is an input'
replay logs/black_buoys-101.pcap eval.lcmlog
"$bin/lookout-eval" --in eval.lcmlog --truth truth --figures truth/objects.csv --force >said 2>&1 && fail '--figures wrote over its truth'
says 'is an input'
[ "$(sha256sum in.lcmlog truth/*)" = "$before" ] || fail 'an input was changed'

# A log of two runs, all of whose processes began anew: its parts give what the whole gives.
mkdir long
sim dense 104 2 long/1.pcap
sim dense 105 2 long/2.pcap --start-utime-us 1787997610250000
replay long/1.pcap long/1.log
replay long/2.pcap long/2.log
cat long/1.log long/2.log >long/both.lcmlog
rm long/[12].*
expect_code 0 --archive cut scan long
expect_code 0 --archive cut plan --config "$config" --name whole --cut-minutes 0
says 'whole: 1 units'
expect_code 0 --archive cut plan --config "$config" --name parts --cut-minutes 0.001
says 'parts: 2 units'
expect_code 0 --archive cut run --jobs 2
for table in tracks alerts pose obstacles; do
  for version in whole parts; do
    "$bin/lookout-archive" --archive cut query "SELECT * FROM $table WHERE version = '$version'" | cut -d, -f5- >"$version.csv"
  done
  [ "$(wc -l <whole.csv)" -gt 10 ] && cmp -s whole.csv parts.csv || fail "the parts give other $table than the whole"
done

[ "$num_failed" -eq 0 ] && echo 'lookout-archive: scan, plan, run, compare and query as they should'
exit "$((num_failed > 0))"
