#!/usr/bin/env bash
# Runs a test program in a network namespace of its own: loopback up, with (or with "no-route" without) the route that LCM needs.
# Exit code 77 tells ctest that the test is skipped, where namespaces are not permitted.
set -euo pipefail
mode=$1
shift
if ! unshare -rn true 2>/dev/null; then
  echo "skipped: this computer does not permit network namespaces (unshare -rn)"
  exit 77
fi
if [ "$mode" = no-route ]; then
  exec unshare -rn bash -c 'ip link set lo up && exec "$@"' bash "$@"
fi
exec unshare -rn bash -c 'ip link set lo up && ip link set lo multicast on && ip route add 239.255.76.0/24 dev lo && exec "$@"' bash "$@"
