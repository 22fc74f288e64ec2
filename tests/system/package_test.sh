#!/usr/bin/env bash
# Builds the package and tries it in a Debian of its own.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
if [ "$(id -u)" -ne 0 ]; then
  echo "skipped: the package is tried as root only"
  exit 77
fi
for program in debootstrap systemd-nspawn; do
  command -v "$program" >/dev/null || { echo "skipped: $program is missing: apt-get install debootstrap systemd-container"; exit 77; }
done
./dev package
deploy/check_package.sh build/release/package/lookout_*.deb
