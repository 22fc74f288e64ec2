#!/usr/bin/env bash
# One trial of the plotter, or of the decoder of AIS, with programs of others, in a network namespace of its own.
#   peers_test.sh TRIAL SOURCE_FOLDER BUILD_FOLDER     (sentences, n2k, mavlink, signalk, gpsd or gpsdecode)
# Packages of npm are installed into the build folder, as package-lock.json has them: without the network the trial is skipped.
set -euo pipefail
trial=$1
source_folder=$2
build=$3
here=$source_folder/tests/peers
skip() { echo "skipped: $*"; exit 77; }
python=/usr/bin/python3  # Debian's, which has Debian's packages
[ -x $python ] || skip "there is no $python"

install_npm_packages() {
  command -v npm >/dev/null || skip "npm is not installed"
  cmp -s "$here/package-lock.json" "$1/installed" && return
  rm -rf "$1"
  mkdir -p "$1"
  cp "$here/package.json" "$here/package-lock.json" "$1"
  if ! (cd "$1" && npm ci --ignore-scripts --omit=optional --no-audit --no-fund >npm.log 2>&1); then
    grep -Eq 'ENOTFOUND|ECONNREFUSED|ETIMEDOUT|EAI_AGAIN' "$1/npm.log" && skip "no network for npm"
    cat "$1/npm.log"
    exit 1
  fi
  cp "$here/package-lock.json" "$1/installed"
}

case $trial in
  sentences)
    $python -c 'import pynmea2' 2>/dev/null || skip "python3-nmea2 is not installed"
    command -v go >/dev/null || skip "golang-go is not installed"
    [ -d /usr/share/gocode/src/github.com/adrianmo/go-nmea ] || skip "golang-github-adrianmo-go-nmea-dev is not installed"
    mkdir -p "$build/peers"
    GO111MODULE=off GOPATH=/usr/share/gocode GOCACHE=$build/peers/go_cache go build -o "$build/peers/sentences" "$here/sentences.go"
    ;;
  n2k | mavlink | signalk) install_npm_packages "$build/peers/npm" ;;
  gpsd)
    gpsd=/usr/sbin/gpsd
    [ -x $gpsd ] || gpsd=$source_folder/build/gpsd/usr/sbin/gpsd
    [ -x "$gpsd" ] || skip "there is no gpsd"
    export LOOKOUT_GPSD=$gpsd
    ;;
  gpsdecode)
    gpsdecode=/usr/bin/gpsdecode
    [ -x $gpsdecode ] || gpsdecode=$source_folder/build/gpsd/usr/bin/gpsdecode
    [ -x "$gpsdecode" ] || skip "there is no gpsdecode"
    export LOOKOUT_GPSDECODE=$gpsdecode
    ;;
  *) echo "unknown trial: $trial" >&2; exit 2 ;;
esac
exec "$source_folder/tests/system/in_namespace.sh" route $python -B "$here/${trial}_test.py" "$source_folder" "$build"
