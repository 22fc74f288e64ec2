#!/usr/bin/env bash
# lookout-archive with the real engines: the same 200 simulated and damaged logs by each of them give the same bytes; also where workers, engine, planner
# and run are killed at drawn moments, the disk is full, a node is drained, a slow mount goes away. Slurm's daemons run in namespaces of this test.
#   archive_engines_test.sh SOURCE_FOLDER PROGRAM_FOLDER
# LOOKOUT_ARCHIVE_LOGS, LOOKOUT_ARCHIVE_KILLS, LOOKOUT_SEED: how many logs (200) and kills (20), and the seed of the draw (1).
set -uo pipefail
export LC_ALL=C
source_folder=$1
bin=$2
if [ -z "${LOOKOUT_ARCHIVE_INSIDE:-}" ]; then
  for program in slurmctld slurmd munged sbatch snakemake parallel bindfs; do
    command -v "$program" >/dev/null || { echo "skipped: $program is not installed (./dev setup slow)"; exit 77; }
  done
  [ "$(id -u)" -eq 0 ] || { echo 'skipped: Slurm in namespaces needs root'; exit 77; }
  export LOOKOUT_ARCHIVE_INSIDE=yes
  exec unshare --net --uts --mount --pid --fork --kill-child --mount-proc "$0" "$@"
fi

config=$source_folder/config/demo
num_logs=${LOOKOUT_ARCHIVE_LOGS:-200}
num_kills=${LOOKOUT_ARCHIVE_KILLS:-20}
RANDOM=${LOOKOUT_SEED:-1}
work=$(mktemp -d -t archive_engines.XXXXXX)
trap 'umount "$work/full" 2>/dev/null; umount -l "$work/mounted" 2>/dev/null; rm -rf "$work"' EXIT
cd "$work" || exit 1
num_failed=0
fail() { echo "FAILED: $*" >&2; [ ! -e said ] || tail -20 said | sed 's/^/  | /' >&2; num_failed=$((num_failed + 1)); }
archive() { "$bin/lookout-archive" "$@"; }
tree() { (cd "$1/results" && find . -type f -print0 | sort -z | xargs -0 sha256sum | sha256sum); }
descendants() { local child; for child in $(pgrep -P "$1"); do echo "$child"; descendants "$child"; done; }
# Kills what PROCESS has started, and what that has, where the command line holds WORDS.
kill_below() {  # PROCESS WORDS
  local process
  for process in $(descendants "$1"); do
    if tr '\0' ' ' 2>/dev/null <"/proc/$process/cmdline" | grep -qE -- "$2"; then kill -KILL "$process" 2>/dev/null; fi
  done
}
begin_s=$SECONDS
step() { echo "$((SECONDS - begin_s)) s: $*"; }

step "simulating $num_logs logs"
mkdir logs
scenes=(black_buoys dense crossing canal)
make_log() {  # NUMBER: each tenth is torn, each tenth has wrong bytes in its midst, each twentieth is nothing
  local file
  file=logs/${scenes[$(($1 % 4))]}-$1.pcap
  truth=()
  [ $(($1 % 5)) -ne 0 ] || truth=(--truth "${file%.pcap}.truth")
  "$bin/lookout-sim" --config "$config" --scene "${scenes[$(($1 % 4))]}" --seed "$((100 + $1))" --seconds 1 --pcap "$file" "${truth[@]}" >/dev/null 2>&1 || exit 1
  case $(($1 % 20)) in
    3 | 13) truncate -s 400000 "$file" ;;
    7 | 17) printf 'wrong bytes in the midst of a file' | dd of="$file" bs=1 seek=300000 conv=notrunc status=none ;;
    19) head -c 24 "$file" >"$file.head" && mv "$file.head" "$file" ;;
  esac
}
export -f make_log
for ((i = 0; i < num_logs; ++i)); do make_log "$i" || fail "log $i"; done

prepare() { archive --archive "$1" scan logs >said 2>&1 && archive --archive "$1" plan --config "$config" --name A >said 2>&1 || fail "scan and plan of $1"; }
finish() {  # ARCHIVE ENGINE: failed units make the exit code 1
  archive --archive "$1" run --engine "$2" --jobs 2 >said 2>&1
  grep -q ' 0 not done' said || fail "run of $1 by $2"
}

step 'local, with nothing else on its path'
prepare local
env -i PATH=/nowhere "$bin/lookout-archive" --archive local run --jobs 2 >said 2>&1
grep -q ' 0 not done' said || fail 'local run'
tail -1 said
wanted=$(tree local)

step 'GNU parallel'
prepare parallel
finish parallel parallel
[ "$(tree parallel)" = "$wanted" ] || fail 'GNU parallel gives another tree'

step 'Snakemake'
prepare snakemake
HOME=$work finish snakemake snakemake
[ "$(tree snakemake)" = "$wanted" ] || fail 'Snakemake gives another tree'

step 'Slurm'
# Slurm asks for a name with an address; the loopback device alone has none for it.
hostname archive-node
ip link set lo up
ip link add node0 type veth peer name node1
ip addr add 10.99.0.1/24 dev node0
ip link set node0 up
ip link set node1 up
printf '127.0.0.1 localhost\n10.99.0.1 archive-node\n' >hosts
mount --bind hosts /etc/hosts
mkdir slurm
dd if=/dev/urandom of=slurm/munge.key bs=1024 count=1 status=none
chmod 600 slurm/munge.key
chmod 755 . slurm
munged --force --key-file="$work/slurm/munge.key" --socket="$work/slurm/munge.socket" --pid-file="$work/slurm/munge.pid" --log-file="$work/slurm/munge.log" \
  --seed-file="$work/slurm/munge.seed" >slurm/munged.said 2>&1 || fail "munged: $(cat slurm/munged.said)"
export SLURM_CONF=$work/slurm/slurm.conf
cat >slurm/slurm.conf <<CONF
ClusterName=archive
SlurmctldHost=archive-node(10.99.0.1)
AuthType=auth/munge
AuthInfo=socket=$work/slurm/munge.socket
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$work/slurm/state
SlurmdSpoolDir=$work/slurm/spool
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd.pid
SlurmctldLogFile=$work/slurm/slurmctld.log
SlurmdLogFile=$work/slurm/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=0
NodeName=archive-node NodeAddr=10.99.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
printf 'CgroupPlugin=cgroup/v1\nCgroupAutomount=no\n' >slurm/cgroup.conf
mkdir slurm/state slurm/spool
start_slurmctld() { slurmctld -i >slurm/slurmctld.said 2>&1; }
start_slurmctld
slurmd >slurm/slurmd.said 2>&1
for _ in $(seq 60); do sinfo -h -o %T 2>/dev/null | grep -q idle && break; sleep 0.5; done
if ! sinfo -h -o %T 2>/dev/null | grep -q idle; then
  tail -5 slurm/*.log slurm/*.said >&2
  fail 'Slurm does not start here'
else
  prepare slurm
  "$bin/lookout-archive" --archive slurm run --engine slurm --jobs 2 >said 2>&1 &
  pid=$!
  sleep 6
  step 'Slurm: the node is drained for 5 s'
  scontrol update nodename=archive-node state=drain reason=test
  sleep 5
  scontrol update nodename=archive-node state=resume
  step 'Slurm: a worker, then the controller, then the run are killed'
  sleep 2
  kill_below "$(cat slurm/slurmd.pid)" 'lookout-archive work'
  sleep 2
  kill -KILL "$(cat slurm/slurmctld.pid)"
  sleep 1
  start_slurmctld
  sleep 3
  kill -KILL "$pid"
  wait "$pid" 2>/dev/null
  # A controller that was killed has lost its last steps: it drains the node, which has jobs that it does not know, and holds them. That is the
  # administrator's: the queue is emptied, and the node goes on.
  scancel --user root
  for _ in $(seq 20); do
    sleep 1
    scontrol update nodename=archive-node state=resume 2>/dev/null
    sinfo -h -o %T | grep -q idle && break
  done
  # A step of before that still ran may drain it once more: the administrator stays awake.
  while sleep 2; do
    ! sinfo -h -o %T 2>/dev/null | grep -q drain || scontrol update nodename=archive-node state=resume 2>/dev/null
  done &
  administrator=$!
  finish slurm slurm
  kill "$administrator"
  [ "$(tree slurm)" = "$wanted" ] || fail 'Slurm gives another tree'
  scancel --user root
fi

step "$num_kills kills at drawn moments"
prepare killed
: >finished
remember() {  # results that are there must stay as they are
  find killed/results -name '*.json' -printf '%f %i %C@\n' 2>/dev/null | sort >now
  comm -23 finished now | grep -q . && fail "results were made again: $(comm -23 finished now | head -3)"
  cp now finished
}
for ((i = 0; i < num_kills; ++i)); do
  engine=local
  [ $((RANDOM % 3)) -ne 0 ] || engine=parallel
  setsid "$bin/lookout-archive" --archive killed run --engine "$engine" --jobs 2 >said 2>&1 &
  pid=$!
  "$bin/lookout-archive" --archive killed plan --config "$config" --name A >/dev/null 2>&1 &
  planner=$!
  sleep "$((RANDOM % 4)).$((RANDOM % 10))"
  case $((RANDOM % 4)) in
    0) kill_below "$pid" 'lookout-archive work' ;;
    1) kill_below "$pid" 'lookout-(replay|export)' ;;
    2) kill -KILL "$pid" ;;
    3) kill -KILL "$planner"; kill_below "$pid" 'perl.*parallel' ;;
  esac 2>/dev/null
  sleep 0.2
  kill -KILL "$pid" 2>/dev/null
  wait "$pid" "$planner" 2>/dev/null
  remember
done
finish killed local
remember
[ "$(tree killed)" = "$wanted" ] || fail 'after kills the tree is another one'
[ -z "$(find killed/work -mindepth 1 -maxdepth 1 -type d ! -name 'batches-*')" ] || fail 'a unit under way is left'

step 'a full disk'
mkdir full
mount -t tmpfs -o size=5m none full
prepare full
archive --archive full run --jobs 2 --retries 0 >said 2>&1 && fail 'a full disk is not told by the exit code'
grep -qi 'no space left' said || fail 'a full disk is not told'
mount -o remount,size=2g full
finish full local
[ "$(tree full)" = "$wanted" ] || fail 'after a full disk the tree is another one'

step 'a slow mount, which holds logs and archive and goes away in mid-run'
mkdir -p behind/logs mounted
cp -a logs/. behind/logs/
mount_slowly() { bindfs --read-rate=20M --write-rate=20M "$work/behind" "$work/mounted" || fail 'bindfs'; }
mount_slowly
archive --archive mounted/archive scan mounted/logs >said 2>&1 && archive --archive mounted/archive plan --config "$config" --name A >said 2>&1 || fail 'scan and plan'
step 'scanned and planned'
"$bin/lookout-archive" --archive mounted/archive run --jobs 2 --retries 0 >said 2>&1 &
pid=$!
sleep 10
pkill -KILL --parent 1,$$ -f 'bindfs --read-rate=20M'  # the server of the mount dies: all that is open there fails from now on
wait "$pid" && fail 'a mount that went away is not told by the exit code'
umount -l mounted
num_done=$(find behind/archive/results -name '*.json' | wc -l)
[ "$num_done" -gt 0 ] || fail 'nothing was done before the mount went away'
step "$num_done units were done before the mount went away"
mount_slowly
finish mounted/archive local
[ "$(tree mounted/archive)" = "$wanted" ] || fail 'after a mount that went away the tree is another one'
umount mounted

step 'done'
exit "$((num_failed > 0))"
