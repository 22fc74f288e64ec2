#!/usr/bin/env bash
# Tries the package in a bare Debian 12 of its own: installs, verifies, starts under systemd, upgrades, removes, purges. As root, some minutes.
#   deploy/check_package.sh build/release/package/lookout_*.deb [ROOT]      ROOT: a debootstrap of before, used again
# Needs debootstrap and systemd-container. Where the computer does not permit systemd-nspawn, every ExecStart line is run as its user instead.
set -euo pipefail

package=$(realpath "$1")
root=${2:-}
greatest_exposure=25  # of systemd-analyze security, in tenths
say() { printf '== %s\n' "$*"; }
fail() { echo "FAILED: $*" >&2; exit 1; }
[ "$(id -u)" -eq 0 ] || fail "must be root"
for program in debootstrap systemd-nspawn; do
  command -v "$program" >/dev/null || fail "$program is missing: apt-get install debootstrap systemd-container"
done

work=$(mktemp -d -t lookout-package.XXXXXX)
trap 'rm -rf "$work"' EXIT
if [ -z "$root" ]; then
  root=$work/debian
  say "debootstrap"
  debootstrap --variant=minbase --include=systemd,dbus bookworm "$root" >"$work/debootstrap.log" 2>&1 || { tail "$work/debootstrap.log" >&2; fail "debootstrap"; }
fi
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive HOME=/root TERM=dumb "$@"; }

# A package like it with the next version, and one line of its config another: what an upgrade meets.
say "an upgrade's package"
dpkg-deb -R "$package" "$work/next"
sed -i 's/^Version: .*/Version: 99.0/' "$work/next/DEBIAN/control"
echo '# the next version of this file' | tee -a "$work/next/etc/lookout/boat/lidar.txtpb" "$work/next/etc/lookout/boat/boat.txtpb" >/dev/null
dpkg-deb --root-owner-group -b "$work/next" "$work/next.deb" >/dev/null
cp "$package" "$root/root/lookout.deb"
cp "$work/next.deb" "$root/root/next.deb"

# One of before, when the lidar's config and unit had the name vlp16.
say "a package of the old names"
dpkg-deb -R "$package" "$work/old"
sed -i 's/^Version: .*/Version: 0.0.9/' "$work/old/DEBIAN/control"
rm -f "$work/old/DEBIAN/preinst" "$work/old/DEBIAN/postinst" "$work/old/DEBIAN/postrm"
sed -i 's#/etc/lookout/boat/lidar.txtpb#/etc/lookout/boat/vlp16.txtpb#' "$work/old/DEBIAN/conffiles"
mv "$work/old/etc/lookout/boat/lidar.txtpb" "$work/old/etc/lookout/boat/vlp16.txtpb"
mv "$work/old/usr/lib/systemd/system/lookout-lidar.service" "$work/old/usr/lib/systemd/system/lookout-vlp16.service"
dpkg-deb --root-owner-group -b "$work/old" "$work/old.deb" >/dev/null

say "installs"
inside apt-get update -qq
inside apt-get purge -y -qq lookout >/dev/null 2>&1 || true
say "upgrades from the old names"
cp "$work/old.deb" "$root/root/old.deb"
inside apt-get install -y -qq --no-install-recommends /root/old.deb >"$work/old.log" 2>&1 || { tail "$work/old.log" >&2; fail "install of the old names"; }
echo '# mine' >>"$root/etc/lookout/boat/vlp16.txtpb"
mkdir -p "$root/etc/systemd/system/lookout-vlp16.service.d"
printf '[Service]\nNice=5\n' >"$root/etc/systemd/system/lookout-vlp16.service.d/mine.conf"
inside apt-get install -y -qq --no-install-recommends -o Dpkg::Options::=--force-confold /root/lookout.deb >"$work/renamed.log" 2>&1 ||
  { tail "$work/renamed.log" >&2; fail "upgrade from the old names"; }
grep -q '^# mine' "$root/etc/lookout/boat/lidar.txtpb" || fail "the changed vlp16.txtpb was lost"
[ ! -e "$root/etc/lookout/boat/vlp16.txtpb" ] || fail "vlp16.txtpb is still there"
[ -e "$root/etc/systemd/system/lookout-lidar.service.d/mine.conf" ] || fail "settings beside the old unit were lost"
[ ! -e "$root/lib/systemd/system/lookout-vlp16.service" ] || fail "the old unit is still there"
rm -r "$root/etc/systemd/system/lookout-lidar.service.d" "$root/root/old.deb"
inside apt-get purge -y -qq lookout >/dev/null 2>&1 || fail "purge behind the old names"
find "$root" -xdev -name '*lookout*' ! -path "$root/root/*" ! -path "$root/proc/*" | sort >"$work/before"
inside apt-get install -y -qq --no-install-recommends /root/lookout.deb >"$work/install.log" 2>&1 || { tail "$work/install.log" >&2; fail "install"; }
mapfile -t units < <(basename -a "$root"/lib/systemd/system/lookout-*.service | sed -n 's/^lookout-\(.*\)\.service$/\1/p' | grep -Ev '^(route|firewall)$')
echo "units: ${units[*]}"
inside id lookout || fail "no user"
# Scripts and archives are found by their names: were they not, nobody would miss them here.
for file in bin/lookout-up bin/lookout-spy share/lookout/lookout-spy.jar share/lookout/lookout-types.jar; do
  [ -s "$root/usr/$file" ] || fail "/usr/$file is not in the package"
done
# Pages link to each other and to config.
for link in $(sed -n 's/^.*Documentation=file:\(.*\)$/\1/p' "$root/lib/systemd/system/lookout.target") /usr/share/doc/lookout/{README.md,TROUBLESHOOTING.md,services/segmenter/README.md,config/catabot/boat.txtpb}; do
  inside test -s "$link" || fail "$link is not there"
done
for program in "$root"/usr/bin/lookout-*; do
  inside "/usr/bin/$(basename "$program")" --help >"$work/help.txt" 2>&1 || { cat "$work/help.txt" >&2; fail "$(basename "$program") --help"; }
done
inside lookout-up --config /etc/lookout/boat --check >/dev/null || fail "the config that is installed is wrong"

say "the rule of the firewall"
for settings in 'LOOKOUT_LCM_INTERFACE=lo' 'LOOKOUT_LCM_INTERFACE=eth1 LOOKOUT_BUS_FIREWALL=on'; do
  inside env $settings /usr/libexec/lookout/firewall rules >"$work/rules.nft" || fail "the rule with $settings"
  grep -q 'udp dport 7667 counter drop' "$work/rules.nft" || { cat "$work/rules.nft" >&2; fail "the rule with $settings"; }
  if command -v nft >/dev/null; then nft -c -f "$work/rules.nft" || fail "nft does not read the rule with $settings"; fi
done
command -v nft >/dev/null || echo "skipped: its syntax is not checked, there is no nft (package nftables)"

say "systemd-analyze verify"
names=("${units[@]/#/lookout-}")
inside systemd-analyze verify lookout.target lookout-route.service lookout-firewall.service "${names[@]/%/.service}" >"$work/verify.txt" 2>&1 || true
cat "$work/verify.txt"
[ ! -s "$work/verify.txt" ] || fail "verify is not clean"
say "systemd-analyze security"
for unit in "${units[@]}"; do
  inside systemd-analyze security --no-pager --offline=true --threshold=$greatest_exposure "lookout-$unit.service" >"$work/security.txt" 2>&1 ||
    { tail -n 1 "$work/security.txt"; fail "exposure of lookout-$unit"; }
  tail -n 1 "$work/security.txt"
done
mkdir -p "$root/etc/systemd/system/lookout-lidar.service.d"
cp "$root/usr/share/doc/lookout/examples/live-capture.conf" "$root/etc/systemd/system/lookout-lidar.service.d/"
inside systemd-analyze verify lookout-lidar.service || fail "verify with the drop-in"
inside systemd-analyze security --no-pager --offline=true --threshold=$greatest_exposure lookout-lidar.service >"$work/security.txt" || fail "exposure with the drop-in"
echo "with live-capture.conf: $(tail -n 1 "$work/security.txt")"
rm -r "$root/etc/systemd/system/lookout-lidar.service.d"
# The second lidar's waits for its config, which the package does not bring.
mapfile -t units < <(printf '%s\n' "${units[@]}" | grep -vx lidar_2)

nspawn=(systemd-nspawn -q -D "$root" --machine=lookout-check --private-network --register=no --keep-unit)
start_by_hand() {
  say "systemd-nspawn is not permitted here ($1): every ExecStart line by hand, as the user lookout"
  local unit line code
  for unit in "${units[@]}"; do
    line=$(sed -n 's/^ExecStart=//p' "$root/lib/systemd/system/lookout-$unit.service" | sed 's#\${LOOKOUT_CONFIG}#/etc/lookout/boat#')
    code=0
    # In a network of its own; SIGTERM after 3 s must end it cleanly.
    unshare -n bash -c "ip link set lo up && ip route add 239.255.76.0/24 dev lo &&
      exec chroot --userspec=lookout:lookout '$root' /bin/sh -c 'cd \$(mktemp -d) && exec timeout --preserve-status 3 $line'" \
      >"$work/by_hand.txt" 2>&1 || code=$?
    if [ "$code" -ne 0 ] || ! grep -q 'starts, version' "$work/by_hand.txt"; then
      cat "$work/by_hand.txt" >&2
      fail "$line: exit code $code"
    fi
    echo "$line: started, ended cleanly"
  done
}
say "starts under systemd"
# A unit of the check's own starts all in the machine, kills each, and leaves what it saw.
cat >"$root/root/look.sh" <<'LOOK'
#!/bin/bash
exec >/root/look.txt 2>&1
set -u
code=0
expect() { echo "$1"; shift; "$@" || { echo "  FAILED: $*"; code=1; }; }
ip link set lo up
systemctl start lookout.target
for unit in UNITS; do
  expect "$unit is active" systemctl -q is-active "lookout-$unit"
done
expect "firewall" systemctl -q is-active lookout-firewall
expect "route" sh -c 'ip route | grep -q "239.255.76.0/24 dev lo"'
sleep 3
systemctl status --no-pager 'lookout-*' | grep -E 'Loaded|Active|Status|Main PID'
# A lake round the boat while all that follows happens.
lookout-sim --config /usr/share/lookout/config/demo --scene lake --seed 1 --seconds 25 --udp 127.0.0.1 >/root/sim.txt 2>&1 &
sim=$!
sleep 2
for unit in UNITS; do
  old=$(systemctl show -P MainPID "lookout-$unit")
  from=$(date +%s%3N)
  kill -9 "$old"
  for _ in $(seq 400); do
    new=$(systemctl show -P MainPID "lookout-$unit")
    [ "$new" != 0 ] && [ "$new" != "$old" ] && systemctl -q is-active "lookout-$unit" && break
    sleep 0.02
  done
  echo "$unit killed with SIGKILL: active again after $(($(date +%s%3N) - from)) ms"
  expect "$unit is active again" systemctl -q is-active "lookout-$unit"
done
# A main loop that hangs: the watchdog.
stopped=$(systemctl show -P MainPID lookout-segmenter)
kill -STOP "$stopped"
for _ in $(seq 300); do
  new=$(systemctl show -P MainPID lookout-segmenter)
  [ "$new" != 0 ] && [ "$new" != "$stopped" ] && break
  sleep 0.1
done
expect "the watchdog restarts a process that hangs" [ "$new" != "$stopped" ]
journalctl --no-pager -u lookout-segmenter | tail -n 8
expect "the simulator" wait "$sim"
log=$(ls -t /var/lib/lookout/logs/*.lcmlog | head -n 1)
rows=$(lookout-export --in "$log" --table obstacles | wc -l)
expect "$rows obstacles recorded after the last end of the recorder" [ "$rows" -gt 1000 ]
# Reload where the unit has it: same process.
old=$(systemctl show -P MainPID lookout-lidar)
expect "reload of lidar" systemctl reload lookout-lidar
sleep 2
journalctl --no-pager -u lookout-lidar | tail -n 4
expect "lidar is active after its reload, the same process" [ "$(systemctl show -P MainPID lookout-lidar)" = "$old" ]
expect "reload of the recorder" systemctl reload lookout-recorder
sleep 1
expect "a new log for it" [ "$(ls -t /var/lib/lookout/logs/*.lcmlog | head -n 1)" != "$log" ]
# Capture on an interface: refused as delivered, fine with the drop-in.
cp /etc/lookout/boat/lidar.txtpb /root/lidar.txtpb
sed -i 's/^source: UDP/source: INTERFACE\ninterface: "lo"/; /^bind_address/d' /etc/lookout/boat/lidar.txtpb
systemctl restart lookout-lidar 2>/dev/null
expect "no capture without the capability" sh -c '! systemctl -q is-active lookout-lidar'
mkdir -p /etc/systemd/system/lookout-lidar.service.d
cp /usr/share/doc/lookout/examples/live-capture.conf /etc/systemd/system/lookout-lidar.service.d/
systemctl daemon-reload
systemctl restart lookout-lidar
expect "capture with the drop-in" systemctl -q is-active lookout-lidar
journalctl --no-pager -u lookout-lidar | grep -E 'captures on|critical' | tail -n 3
rm -r /etc/systemd/system/lookout-lidar.service.d
systemctl daemon-reload
cp /root/lidar.txtpb /etc/lookout/boat/lidar.txtpb
rm /root/lidar.txtpb
systemctl stop lookout.target
systemctl stop 'lookout-*.service'  # the same once more, but waits
for unit in UNITS; do
  expect "$unit is stopped" [ "$(systemctl is-active "lookout-$unit")" = inactive ]
done
echo "code $code"
LOOK
sed -i "s/UNITS/${units[*]}/" "$root/root/look.sh"
chmod +x "$root/root/look.sh"
cat >"$root/etc/systemd/system/check-look.service" <<'UNIT'
[Unit]
SuccessAction=exit
FailureAction=exit
[Service]
Type=oneshot
ExecStart=/root/look.sh
TimeoutStartSec=120s
UNIT
rm -f "$root/root/look.txt"
: >"$root/etc/machine-id"
if timeout 180 "${nspawn[@]}" -b systemd.unit=check-look.service >"$work/nspawn.txt" 2>&1 </dev/null; [ -s "$root/root/look.txt" ]; then
  cat "$root/root/look.txt"
  grep -q '^code 0$' "$root/root/look.txt" || fail "under systemd"
else
  start_by_hand "$(tail -n 1 "$work/nspawn.txt")"
fi
rm -f "$root/etc/systemd/system/check-look.service" "$root"/root/{look.sh,look.txt,sim.txt}

say "upgrades, a changed config is kept"
sed -i 's/^name: .*/name: "mine"/' "$root/etc/lookout/boat/boat.txtpb"
inside apt-get install -y -qq --no-install-recommends -o Dpkg::Options::=--force-confdef -o Dpkg::Options::=--force-confold /root/next.deb \
  >"$work/upgrade.log" 2>&1 || { tail "$work/upgrade.log" >&2; fail "upgrade"; }
grep -q '^name: "mine"' "$root/etc/lookout/boat/boat.txtpb" || fail "the changed boat.txtpb was lost"
grep -q 'the next version' "$root/etc/lookout/boat/lidar.txtpb" || fail "an unchanged file did not get its new version"
say "removes, config stays"
inside apt-get remove -y -qq lookout >"$work/remove.log" 2>&1 || { tail "$work/remove.log" >&2; fail "remove"; }
[ -e "$root/etc/lookout/boat/boat.txtpb" ] || fail "remove took the config"
[ ! -e "$root/usr/bin/lookout-lidar" ] || fail "remove left programs"
say "purges: nothing is left but recordings"
inside apt-get purge -y -qq lookout >"$work/purge.log" 2>&1 || { tail "$work/purge.log" >&2; fail "purge"; }
rm -f "$root/root/lookout.deb" "$root/root/next.deb"
find "$root" -xdev -name '*lookout*' ! -path "$root/root/*" ! -path "$root/proc/*" | sort >"$work/after"
comm -13 "$work/before" "$work/after" | sed "s#^$root##" | tee "$work/left.txt"
grep -Ev '^/var/lib/lookout$|^/var/lib/systemd/|^/var/log/|^/var/cache/' "$work/left.txt" && fail "purge left files"
say "the package is fine"
