#!/usr/bin/env bash
# Runs a test program in a network namespace of its own: loopback up, with (or with "no-route" without) the route that LCM needs.
# Where it may, in a process namespace too: when the test is ended in any way, so is all that it started.
# Exit code 77 tells ctest that the test is skipped, where namespaces are not permitted.
set -euo pipefail
mode=$1
shift
# Root needs no user namespace, which a chroot would not permit. Where a chroot's root is no mount point, its mounts stay as they are.
if [ "$(id -u)" -eq 0 ]; then user=(-n); else user=(-rn); fi
processes=(--pid --fork --kill-child --mount-proc)
isolated=(unshare "${user[@]}" "${processes[@]}")
if ! "${isolated[@]}" true 2>/dev/null; then
  isolated=(unshare "${user[@]}" --propagation unchanged "${processes[@]}")
  if ! "${isolated[@]}" true 2>/dev/null; then
    isolated=(unshare "${user[@]}")
    if ! "${isolated[@]}" true 2>/dev/null; then
      echo "skipped: this computer does not permit network namespaces (${isolated[*]})"
      exit 77
    fi
  fi
fi
prepare='ip link set lo up'
if [ "$mode" != no-route ]; then
  prepare+=' && ip link set lo multicast on && ip route add 239.255.76.0/24 dev lo'
fi
# Process ids begin anew in each process namespace: tests that name their files by them must not meet.
# A test that is killed leaves its folder to a later one: what is two days old is of no test that still runs.
find "${TMPDIR:-/tmp}" -maxdepth 1 -user "$(id -u)" -name 'lookout_test.*' -mtime +1 -exec rm -rf {} + 2>/dev/null || true
TMPDIR=$(mktemp -d -t lookout_test.XXXXXX)
# The state of processes (the page's token) is of this test too.
export TMPDIR XDG_STATE_HOME="$TMPDIR/state"
# No exec: the first process of a namespace gets no SIGINT and no SIGABRT, which a test must.
exec "${isolated[@]}" bash -c "$prepare"' && "$@"; code=$?; rm -rf "$XDG_STATE_HOME"; rmdir --ignore-fail-on-non-empty "$TMPDIR"; exit $code' bash "$@"
