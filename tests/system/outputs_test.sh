#!/usr/bin/env bash
# Each program that writes a file: its output exists, is a link, a folder, an input, in no folder; it is ended half way; the disk is full. Nothing is
# overwritten unasked, nothing half written stands under the name of the output.
#   outputs_test.sh SOURCE_FOLDER PROGRAM_FOLDER
set -uo pipefail
source_folder=$1
bin=$2
config=$source_folder/config/demo

# A small disk of its own needs a mount namespace, datagrams a network of their own. Where that is forbidden, a limit on the size of files stands in for the full disk.
if [ -z "${LOOKOUT_SMALL_DISK:-}" ]; then
  own=(unshare -mn)
  [ "$(id -u)" -eq 0 ] || own=(unshare -rmn)
  if "${own[@]}" sh -c 'ip link set lo up && mount -t tmpfs -o size=64k none /mnt' 2>/dev/null; then
    export LOOKOUT_SMALL_DISK=yes
    exec "${own[@]}" "$0" "$@"
  fi
  export LOOKOUT_SMALL_DISK=no
fi

work=$(mktemp -d -t outputs.XXXXXX)
cd "$work" || exit 1
mkdir disk
pid=''
cleanup() {
  [ -z "$pid" ] || kill -KILL "$pid" 2>/dev/null
  cd / && umount "$work/disk" 2>/dev/null
  rm -rf "$work"
}
trap cleanup EXIT
[ "$LOOKOUT_SMALL_DISK" = no ] || { ip link set lo up && mount -t tmpfs -o size=64k none disk; } || exit 1

num_failed=0
fail() { echo "FAILED: $name: $*" >&2; sed 's/^/  | /' said >&2; num_failed=$((num_failed + 1)); }

"$bin/lookout-sim" --config "$config" --scene canal --seed 1 --seconds 2 --pcap in.pcap >said 2>&1 || { cat said; exit 1; }
"$bin/lookout-replay" --config "$config" --in in.pcap --out in.lcmlog >said 2>&1 || { cat said; exit 1; }
sync_time=$(date +%s)

# Programs by name, with their output and more options. exec=exec: in the place of this shell, for a subshell whose number is then that of the program.
run() {
  local out=$1
  shift
  case $name in
    replay) ${exec:-} "$bin/lookout-replay" --config "$config" --in "$input" --out "$out" "$@" ;;
    sim) ${exec:-} "$bin/lookout-sim" --config "$config" --scene canal --seed 1 --seconds "$seconds" --pcap "$out" "$@" ;;
    csv) ${exec:-} "$bin/lookout-export" --in "$input" --table returns --out "$out" "$@" ;;
    svg) ${exec:-} "$bin/lookout-export" --in "$input" --table returns --format svg --out "$out" "$@" ;;
    map) ${exec:-} "$bin/lookout-export" --in "$input" --table obstacles --format geojson --out "$out" "$@" ;;
    ply) ${exec:-} "$bin/lookout-export" --in "$input" --table returns --format ply --out "$out" "$@" ;;
    mcap) ${exec:-} "$bin/lookout-export" --in "$input" --format mcap --out "$out" "$@" ;;
    slice) ${exec:-} "$bin/lookout-log" slice --in "$input" --out "$out" "$@" ;;
    repair) ${exec:-} "$bin/lookout-log" repair "$input" "$out" "$@" ;;
  esac
}
expect_code() {  # CODE OUT ...
  local wanted=$1 code
  shift
  run "$@" >said 2>&1
  code=$?
  [ "$code" -eq "$wanted" ] || fail "exit code $code instead of $wanted: $*"
}
expect_said() { grep -q -- "$1" said || fail "does not say: $1"; }
expect_old() { [ "$(cat "$1")" = "an old file" ] || fail "$1 was changed"; }
expect_nothing() {
  local file
  for file in "$@"; do [ ! -e "$file" ] && [ ! -L "$file" ] || fail "$file is there"; done
}

for name in replay sim csv svg map ply mcap slice repair; do
  input=in.lcmlog
  seconds=2
  rm -rf out out.partial target

  echo "an old file" >out
  expect_code 1 out
  expect_said "out: exists already; --force replaces it"
  expect_old out
  expect_nothing out.partial
  expect_code 0 out --force
  [ "$(wc -c <out)" -gt 100 ] || fail "--force wrote nothing"
  expect_nothing out.partial

  rm -f out
  echo "an old file" >target
  ln -s target out
  expect_code 1 out
  expect_said "symbolic link"
  expect_old target
  rm -f out
  ln -s target out.partial
  expect_code 1 out
  expect_said "out.partial: is a symbolic link"
  expect_old target
  expect_nothing out
  rm -f out.partial
  expect_code 0 out
  rm -f out

  mkdir out
  expect_code 1 out --force
  expect_said "is a folder"
  rmdir out
  expect_code 1 missing/out
  expect_said "folder does not exist"

  # Its input: by its name and by another.
  if [ "$name" != sim ]; then
    before=$(sha256sum <in.lcmlog)
    ln -sf in.lcmlog out
    for output in in.lcmlog out; do
      run "$output" --force >said 2>&1 && fail "wrote over its input by the name $output"
    done
    [ "$(sha256sum <in.lcmlog)" = "$before" ] || fail "its input was changed"
    rm -f out
  fi

  # Devices and pipes are written directly.
  expect_code 0 /dev/null
  expect_nothing /dev/null.partial
  expect_code 0 named
  run /dev/stdout 2>said | cat >piped
  cmp named piped >>said 2>&1 || fail "what came out of /dev/stdout is not the same as the file"
  rm -f named piped
  # A standard stream that is closed is no output.
  run out >said 2>&-
  run named 2>said >/dev/null
  cmp out named >>said 2>&1 || fail "the output is another one with standard error closed"
  rm -f out named
  if [ -e /dev/full ]; then
    expect_code 1 /dev/full
    expect_said "No space left on device"
  fi

  # A full disk.
  if [ "$LOOKOUT_SMALL_DISK" = yes ]; then
    expect_code 1 disk/out
    expect_said "disk/out: .*No space left on device"
    expect_said "disk/out: not written, nothing of it is left"
    expect_nothing disk/out disk/out.partial
  fi
  (
    ulimit -f 16  # KiB
    run out
  ) 2>&1 | cat >said
  [ "${PIPESTATUS[0]}" -eq 1 ] || fail "exit code ${PIPESTATUS[0]} instead of 1 with a limit on the size of files"
  expect_said "out: .*File too large"
  expect_nothing out out.partial

  # A second one that writes the same.
  exec 9>out.partial
  flock 9
  expect_code 1 out --force
  expect_said "is being written by another program"
  exec 9>&-
  # The rest of a run that was killed.
  echo "half" >out.partial
  expect_code 1 out
  expect_said "left by a run that did not come to its end"
  [ "$(cat out.partial)" = half ] || fail "out.partial was removed unasked"
  expect_code 0 out --force
  expect_said "out.partial: was there"
  expect_nothing out.partial
  rm -f out
done

# SIGINT half way: an input so large that the work lasts.
cat in.lcmlog in.lcmlog in.lcmlog in.lcmlog >four
cat four four four four four four four four >large.lcmlog
for name in replay sim csv svg map ply mcap slice repair; do
  input=large.lcmlog
  seconds=3000
  for signal in INT TERM; do
    rm -f out out.partial
    exec=exec run out >said 2>&1 &
    pid=$!
    for ((i = 0; i < 500; ++i)); do
      [ -s out.partial ] && break
      # A picture is written at once, at the end.
        case $name in svg | ply) [ -e out.partial ] && break ;; esac
      [ -e out ] && break
      sleep 0.01
    done
    kill -"$signal" "$pid"
    wait "$pid"
    code=$?
    pid=''
    if [ -e out ]; then
      echo "note: $name was quicker than SIG$signal"
      [ "$code" -eq 0 ] || fail "exit code $code and an output"
    else
      [ "$code" -eq 1 ] || fail "exit code $code instead of 1 after SIG$signal"
      expect_said "stopped by SIG$signal"
      expect_said "out: not written, nothing of it is left"
    fi
    expect_nothing out.partial
  done
done

# The truth: a folder of files.
name=truth
sim_truth() { "$bin/lookout-sim" --config "$config" --scene lake --seed 1 --seconds 1 --pcap b.pcap --truth truth "$@" >said 2>&1; }
rm -rf truth b.pcap
sim_truth || fail "exit code $?"
echo "an old file" >truth/returns.csv
rm b.pcap
sim_truth && fail "replaced its files unasked"
expect_old truth/returns.csv
expect_nothing b.pcap b.pcap.partial truth/returns.csv.partial
sim_truth --force || fail "exit code $? with --force"
[ "$(wc -l <truth/returns.csv)" -gt 100 ] || fail "--force wrote nothing"
rm -rf truth
sim_truth && fail "replaced the capture unasked"
expect_nothing truth

# A whole set or nothing of it.
if [ "$LOOKOUT_SMALL_DISK" = yes ]; then
  rm -rf b.pcap
  "$bin/lookout-sim" --config "$config" --scene lake --seed 1 --seconds 1 --pcap b.pcap --truth disk/truth >said 2>&1 && fail "wrote to a full disk"
  expect_said "No space left on device"
  expect_nothing b.pcap b.pcap.partial disk/truth
fi

# The output is there although nobody takes the lines.
name=replay
if [ -e /dev/full ]; then
  rm -f out
  "$bin/lookout-replay" --config "$config" --in in.pcap --out out >/dev/full 2>said && fail "does not tell that standard output is full"
  cmp out in.lcmlog >>said 2>&1 || fail "the output is gone since standard output is full"
  rm -f out
fi
# A file of the config that is read is an input as well.
cp -r "$config" own_config
for name in replay sim; do
  before=$(sha256sum <own_config/boat.txtpb)
  config=own_config input=in.lcmlog run own_config/boat.txtpb --force >said 2>&1 && fail "wrote over its config"
  expect_said "is an input"
  [ "$(sha256sum <own_config/boat.txtpb)" = "$before" ] || fail "its config was changed"
done

# A simulation on the network that is ended early keeps the truth, by whichever signal.
name=truth
signals=(INT TERM HUP)
[ "$LOOKOUT_SMALL_DISK" = yes ] || signals=()
for signal in "${signals[@]}"; do
  rm -rf truth
  (trap - HUP; exec "$bin/lookout-sim" --config "$config" --scene lake --seed 1 --seconds 60 --udp 127.0.0.1 --truth truth >said 2>&1) &
  pid=$!
  sleep 0.7
  kill -"$signal" "$pid"
  wait "$pid" || fail "exit code is not 0 after SIG$signal"
  pid=''
  [ -s truth/pose.csv ] || fail "the truth is gone after SIG$signal"
done

# In damage without end the signal is noticed too.
in_damage=(slice repair csv replay)
truncate -s 30G zeros 2>said || in_damage=()  # a file system without sparse files
for name in "${in_damage[@]}"; do
  input=zeros
  exec=exec run out >said 2>&1 &
  pid=$!
  sleep 0.3
  kill -INT "$pid"
  for ((i = 0; i < 300; ++i)); do
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.01
  done
  kill -KILL "$pid" 2>/dev/null && fail "goes on 3 s after SIGINT"
  wait "$pid"
  pid=''
  expect_said "stopped by SIGINT"
  expect_nothing out out.partial
done
rm -f zeros

# Pages and tables of lookout-eval.
name=eval
compare() { "$bin/lookout-eval" --config "$config" --scenes sparse --methods ours --seeds 1 --first-seed 101 --seconds 0.3 "$@" >said 2>&1; }
echo "an old file" >page.html
compare --html page.html && fail "replaced its page unasked"
expect_said "page.html: exists already"
expect_old page.html
compare --html page.html --csv tables --force || fail "exit code $? with --force"
[ "$(wc -c <page.html)" -gt 1000 ] || fail "--force wrote nothing"
expect_nothing page.html.partial
compare --csv tables && fail "replaced its tables unasked"
rm page.html
(
  ulimit -f 4
  compare --html page.html
)
[ $? -eq 1 ] || fail "exit code is not 1 with a limit on the size of files"
expect_nothing page.html page.html.partial
"$bin/lookout-eval" --config "$config" --scenes all --methods ours --seeds 1000 --first-seed 101 --seconds 1 --html page.html >said 2>&1 &
pid=$!
for ((i = 0; i < 500; ++i)); do
  [ -e page.html.partial ] && break
  sleep 0.01
done
kill -INT "$pid"
wait "$pid"
code=$?
pid=''
[ "$code" -eq 1 ] || fail "exit code $code instead of 1 after SIGINT"
expect_said "page.html: not written, nothing of it is left"
expect_nothing page.html page.html.partial

# Evidence.
name=fit
echo "an old file" >evidence.txtpb
"$bin/lookout-fit" --config "$config" --scenes marina --seeds 1 --trees 1 --out evidence.txtpb >said 2>&1 && fail "replaced its evidence unasked"
expect_said "evidence.txtpb: exists already"
expect_old evidence.txtpb
"$bin/lookout-fit" --config "$config" --scenes marina --seeds 2 --trees 1 --out evidence.txtpb --force >said 2>&1 || fail "exit code $? with --force"
grep -q merge_2 evidence.txtpb || fail "--force wrote nothing"
"$bin/lookout-fit" --config "$config" --scenes marina --first-seed 101 --out other.txtpb >said 2>&1
[ $? -eq 2 ] || fail "seeds of tables are not refused"
expect_nothing other.txtpb other.txtpb.partial

# A log out of a recording of others.
name=import
echo '[{"ownshipPosition":[0,0],"time":1,"measurement":[5,5]},{"ownshipPosition":[1,0],"time":2,"measurement":[]}]' >ferry.json
import() { "$bin/lookout-import" --config "$config" --in ferry.json --out "$@" >said 2>&1; }
echo "an old file" >ferry.lcmlog
import ferry.lcmlog && fail "replaced its log unasked"
expect_said "ferry.lcmlog: exists already"
expect_old ferry.lcmlog
import ferry.lcmlog --force || fail "exit code $? with --force"
"$bin/lookout-log" info ferry.lcmlog >said 2>&1 || fail "its log cannot be read"
expect_said OBSTACLES
import ferry.json --force && fail "wrote over its input"
import disk/none/out.lcmlog && fail "wrote into a folder that is not there"
(
  ulimit -f 4
  import small.lcmlog
)
[ $? -eq 1 ] || fail "exit code is not 1 with a limit on the size of files"
expect_nothing small.lcmlog small.lcmlog.partial
echo '[{"ownshipPosition":[0,0],"time":1,"measurement":[5]}]' >ferry.json
import bad.lcmlog && fail "read a measurement of one number"
expect_said "ferry.json"
expect_nothing bad.lcmlog bad.lcmlog.partial

[ "$num_failed" -eq 0 ] || { echo "$num_failed expectations failed" >&2; exit 1; }
echo "all outputs: whole or none, in $(($(date +%s) - sync_time)) s; full disk: ${LOOKOUT_SMALL_DISK}"
