#!/usr/bin/env bash
# The package's own scripts under dpkg: an installed package of the old names (vlp16) is upgraded, and neither the config that a user changed nor settings
# beside the unit are lost. In a mount namespace, with a dpkg database of its own: nothing of this computer is touched. As root.
#   rename_test.sh SOURCES
set -euo pipefail
sources=$(realpath "$1")
if [ "$(id -u)" -ne 0 ] || ! unshare --mount true 2>/dev/null; then
  echo "skipped: needs root and mount namespaces"
  exit 0
fi
if ! command -v dpkg-deb >/dev/null || [ ! -x /usr/bin/dpkg-maintscript-helper ]; then
  echo "skipped: there is no dpkg"
  exit 0
fi
work=$(mktemp -d)
made=
[ -d /etc/lookout ] || { mkdir /etc/lookout; made=/etc/lookout; }  # to be mounted on
trap 'rm -rf "$work"; [ -z "$made" ] || rmdir "$made"' EXIT

# A package of the config alone: VERSION NAME_OF_LIDAR_CONFIG, with the real scripts where SCRIPTS is given.
make_package() {
  local version=$1 name=$2 scripts=${3:-} tree=$work/tree-$1
  mkdir -p "$tree/DEBIAN" "$tree/etc/lookout/boat"
  echo 'cut_azimuth_deg: 180' >"$tree/etc/lookout/boat/$name"
  echo "name: \"boat\"" >"$tree/etc/lookout/boat/boat.txtpb"
  printf '/etc/lookout/boat/%s\n' "$name" boat.txtpb >"$tree/DEBIAN/conffiles"
  printf 'Package: lookout\nVersion: %s\nArchitecture: all\nMaintainer: none\nDescription: renaming\n' "$version" >"$tree/DEBIAN/control"
  if [ -n "$scripts" ]; then
    for script in preinst postinst postrm; do
      cp "$sources/deploy/debian/$script" "$tree/DEBIAN/"
      chmod 755 "$tree/DEBIAN/$script"
    done
  fi
  dpkg-deb --root-owner-group -b "$tree" "$work/$version.deb" >/dev/null
}
make_package 0.0.9 vlp16.txtpb
make_package 0.1.0 lidar.txtpb scripts

cat >"$work/inside.sh" <<'INSIDE'
set -euo pipefail
work=$1
mkdir -p "$work"/{admin/updates,admin/info,etc,units,bin}
: >"$work/admin/status"; : >"$work/admin/available"
mount --bind "$work/etc" /etc/lookout
mount --bind "$work/units" /etc/systemd/system
# What the postinst asks of systemd and the kernel is of no matter here.
for program in systemd-sysusers sysctl systemctl; do printf '#!/bin/sh\nexit 0\n' >"$work/bin/$program"; chmod 755 "$work/bin/$program"; done
export PATH=$work/bin:$PATH
run() { dpkg --admindir="$work/admin" --force-confold --force-depends -i "$1" >"$work/dpkg.txt" 2>&1 || { cat "$work/dpkg.txt"; exit 1; }; }
expect() { echo "$1"; shift; "$@" || { echo "FAILED: $*"; exit 1; }; }
begin() {
  rm -rf "$work"/etc/* "$work"/units/* "$work"/admin/info/*
  : >"$work/admin/status"
  run "$work/0.0.9.deb"
}
b=/etc/lookout/boat
u=/etc/systemd/system

begin
echo '# mine' >>$b/vlp16.txtpb
mkdir $u/lookout-vlp16.service.d
echo '[Service]' >$u/lookout-vlp16.service.d/mine.conf
run "$work/0.1.0.deb"
expect "a config that was changed has the new name" grep -q '# mine' $b/lidar.txtpb
expect "and not the old one" [ ! -e $b/vlp16.txtpb ]
expect "settings of the unit came along" [ -e $u/lookout-lidar.service.d/mine.conf ]
expect "their old folder is gone" [ ! -e $u/lookout-vlp16.service.d ]

begin
run "$work/0.1.0.deb"
expect "a config that was not changed has the new name" [ -e $b/lidar.txtpb ]
expect "and nothing is left of the old one" [ -z "$(ls $b | grep vlp16 || true)" ]

begin
mkdir $u/lookout-vlp16.service.d $u/lookout-lidar.service.d
echo old >$u/lookout-vlp16.service.d/mine.conf
echo new >$u/lookout-lidar.service.d/mine.conf
echo other >$u/lookout-vlp16.service.d/other.conf
run "$work/0.1.0.deb"
expect "of two folders of settings the new one holds" grep -q new $u/lookout-lidar.service.d/mine.conf
expect "and gets what it did not have" grep -q other $u/lookout-lidar.service.d/other.conf
expect "what is not used stays" grep -q old $u/lookout-vlp16.service.d/mine.conf
expect "and is told" grep -q 'mine.conf is not used any more' "$work/dpkg.txt"
INSIDE
unshare --mount --propagation private bash "$work/inside.sh" "$work"
