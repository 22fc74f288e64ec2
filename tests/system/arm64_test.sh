#!/usr/bin/env bash
# The same bytes on another processor: captures replayed natively and, built for arm64, under qemu; the digests of every channel must be equal.
#   arm64_test.sh tree FOLDER                           makes an arm64 tree of Debian there: libraries and headers, nothing of it is run. As root.
#   arm64_test.sh compare NATIVE_BIN ARM64_BIN TREE     exit code 0 equal, 1 different: the channels that differ are named
# Called by ./dev test-arm64, which builds what is compared.
set -euo pipefail
source_folder=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
recordings=$source_folder/../shared/data/vlp16
suite=bookworm
libraries=(libc6-dev liblcm-dev libpcap-dev libgps-dev libncurses-dev libsystemd-dev libeigen3-dev libgeographiclib-dev libprotobuf-dev libspdlog-dev
  libfmt-dev libcli11-dev libssl-dev nlohmann-json3-dev libboost-dev)

make_tree() {  # FOLDER
  local tree=$1 include package link target
  rm -rf "$tree"
  mkdir -p "$(dirname "$tree")"
  include=$(IFS=,; echo "${libraries[*]}")
  debootstrap --arch=arm64 --variant=minbase --download-only --include="$include" "$suite" "$tree" >"$tree.log" 2>&1 || {
    tail -n 5 "$tree.log" >&2
    rm -rf "$tree"
    return 1
  }
  # Nothing is installed, for that would need to run programs of the other processor: the packages are unpacked over each other.
  for package in "$tree"/var/cache/apt/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$package" | tar -x -C "$tree" --exclude='./usr/share/doc/*' --exclude='./usr/share/man/*' --exclude='./usr/share/locale/*'
  done
  rm -rf "$tree/var/cache/apt" "$tree/debootstrap"
  # Absolute links mean this tree, not the computer that it lies on.
  find "$tree" -xdev -type l -lname '/*' -printf '%p\t%l\n' | while IFS=$'\t' read -r link target; do
    ln -sfn "$(realpath -m --relative-to="$(dirname "$link")" "$tree$target")" "$link"
  done
  rm -f "$tree.log"
  printf '%s\n' "$suite" "${libraries[@]}" >"$tree/lookout-packages"
}

is_tree_there() {  # FOLDER
  [ "$(cat "$1/lookout-packages" 2>/dev/null)" = "$(printf '%s\n' "$suite" "${libraries[@]}")" ]
}

compare() {  # NATIVE_BIN ARM64_BIN TREE
  local native=$1 arm64=$2 tree=$3 work different=0 capture config name i
  work=$(mktemp -d -t lookout-arm64.XXXXXX)
  # shellcheck disable=SC2064
  trap "rm -rf '$work'" EXIT
  # The lake, waves (roll, pitch, foam) and two returns a shot, by both methods; recordings by the default one.
  local demo=$source_folder/config/demo paper=$work/paper scene captures=() configs=()
  cp -r "$demo" "$paper"
  printf '%s\n' '# proto-file: config/schema/segmenter.proto' '# proto-message: lookout.config.Segmenter' 'method: PAPER' >"$paper/segmenter.txtpb"
  for scene in lake waves dual; do
    "$native/lookout-sim" --config "$demo" --scene "$scene" --seed 1 --seconds 5 --pcap "$work/$scene.pcap" >/dev/null
    captures+=("$work/$scene.pcap" "$work/$scene.pcap")
    configs+=("$demo" "$paper")
  done
  if [ -d "$recordings" ]; then
    for capture in "$recordings"/*.pcap; do
      captures+=("$capture")
      configs+=("$demo")
    done
  else
    echo "skipped: recordings of a VLP-16, as there are none at $recordings"
  fi
  for i in "${!captures[@]}"; do
    capture=${captures[i]} config=${configs[i]}
    name=$(basename "$capture" .pcap)-$(basename "$config")
    echo "== $name: natively, then as arm64 under qemu"
    replay "$work/$name.native" "$native/lookout-replay" --config "$config" --in "$capture" --out "$work/native.lcmlog"
    replay "$work/$name.arm64" qemu-aarch64-static -L "$tree" "$arm64/lookout-replay" --config "$config" --in "$capture" \
      --out "$work/arm64.lcmlog"
    rm -f "$work/native.lcmlog" "$work/arm64.lcmlog"
    # Channel, messages, SHA-256 of the payloads.
    LC_ALL=C awk -v name="$name" '
      NR == FNR { native[$1] = $2 " " $3; next }
      { arm64[$1] = $2 " " $3 }
      END {
        for (channel in native) names[channel] = 1
        for (channel in arm64) names[channel] = 1
        for (channel in names) {
          is_equal = channel in native && channel in arm64 && native[channel] == arm64[channel]
          printf "%-14s %s\n", channel, is_equal ? "equal     " native[channel] : "DIFFERENT native " native[channel] "; arm64 " arm64[channel] | "LC_ALL=C sort"
          if (!is_equal) failed = 1
        }
        exit failed
      }' "$work/$name.native" "$work/$name.arm64" || different=1
  done
  return "$different"
}

replay() {  # DIGESTS_FILE COMMAND...
  local digests=$1
  shift
  "$@" >"$digests" 2>"$digests.err" || { cat "$digests.err" >&2; echo "FAILED: $*" >&2; exit 1; }
  [ -s "$digests" ] || { echo "FAILED: no digests: $*" >&2; exit 1; }
}

case ${1:-} in
  tree) is_tree_there "$2" || make_tree "$2" ;;
  compare) compare "$2" "$3" "$4" ;;
  *) sed -n '3,4s/^# //p' "$0" >&2; exit 2 ;;
esac
