#!/usr/bin/env bash
# The same bytes whatever the locale, and all processes from folders whose names no shell likes. In a network namespace of its own.
#   locale_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
source_folder=$1
bin=$2/bin
work=$(mktemp -d -t lookout_locale.XXXXXX)
up_pid=''
tidy() {
  [ -z "$up_pid" ] || kill -TERM "$up_pid" 2>/dev/null || true
  [ -z "$up_pid" ] || wait "$up_pid" 2>/dev/null || true
  rm -rf "$work"
}
trap tidy EXIT
fail() { echo "FAILED: $*"; exit 1; }

# A minimal Debian has C and C.UTF-8 only. Those with a decimal comma, and with an i of their own, are made here where their sources are.
locales=(C C.UTF-8)
if command -v localedef >/dev/null && [ -e /usr/share/i18n/locales/tr_TR ]; then
  mkdir "$work/locales"
  for name in de_DE tr_TR; do
    localedef -i "$name" -f UTF-8 "$work/locales/$name.UTF-8"
    locales+=("$name.UTF-8")
  done
  export LOCPATH=$work/locales
  [ "$(LC_ALL=de_DE.UTF-8 locale decimal_point)" = , ] || fail "de_DE.UTF-8 is not taken"
else
  echo "skipped: de_DE.UTF-8 and tr_TR.UTF-8, whose sources are not here (package locales)"
fi
unset LANG LANGUAGE "${!LC_@}"

# Space, both quotes, a newline, a dollar, and bytes that are not ASCII and, the last one, not UTF-8.
odd=$work/$'B\303\266 o\'t "x"\n$y\377'
mkdir "$odd"

# Everything that writes a file or a text, into the folder.
outputs() {  # FOLDER
  local out=$1 config=$source_folder/config/demo table
  mkdir "$out"
  cd "$out"
  "$bin/lookout-sim" --config "$config" --scene lake --seed 1 --seconds 1 --pcap sim.pcap --truth truth >sim.txt
  "$bin/lookout-replay" --config "$config" --in sim.pcap --out replay.lcmlog >replay.txt 2>/dev/null
  for table in returns segments obstacles pose clock fixes attitude; do
    "$bin/lookout-export" --in replay.lcmlog --table "$table" --out "$table.csv"
  done
  "$bin/lookout-export" --in replay.lcmlog --table returns --format svg --out returns.svg
  "$bin/lookout-export" --in replay.lcmlog --table returns --format ply --out returns.ply
  for table in obstacles tracks pose; do
    for format in geojson kml gpx; do "$bin/lookout-export" --in replay.lcmlog --table $table --format $format --out "$table.$format"; done
  done
  "$bin/lookout-export" --in replay.lcmlog --table merges --config "$config" --out merges.csv
  "$bin/lookout-export" --in replay.lcmlog --table merges --config "$config" --format svg --out merges.svg
  "$bin/lookout-eval" --in replay.lcmlog --truth truth >eval.txt
  "$bin/lookout-log" info replay.lcmlog >info.txt
  "$bin/lookout-log" slice --in replay.lcmlog --channel POSE --out slice.lcmlog >slice.txt
  "$bin/lookout-diff" replay.lcmlog slice.lcmlog >diff.txt || [ $? -eq 1 ]
  "$bin/lookout-up" --config "$config" --check >check.txt
  cd - >/dev/null
}
for locale in "${locales[@]}"; do
  LC_ALL=$locale outputs "$work/$locale"
  # RUN_INFO has no clock in it: also the logs are the same, byte by byte.
  diff -r "$work/C" "$work/$locale" || fail "LC_ALL=$locale gives other bytes than LC_ALL=C"
done
for file in returns.csv eval.txt info.txt replay.txt check.txt; do [ -s "$work/C/$file" ] || fail "$file is empty"; done

# Live: programs, config and logs in the odd folder.
mkdir "$odd/bin" "$odd/libexec"
cp -r "$2/libexec/lookout" "$odd/libexec/"
for name in $("$bin/lookout-up" --list); do
  ln "$bin/lookout-$name" "$odd/bin/" 2>/dev/null || cp "$bin/lookout-$name" "$odd/bin/"
done
cp "$bin/lookout-up" "$odd/bin/"
cp -r "$source_folder/config/demo" "$odd/config"
for locale in C "${locales[-1]}"; do
  export LC_ALL=$locale
  rm -rf "$odd/logs"
  : >"$work/up.txt"  # what the one before printed must not stand for what this one will
  (cd "$odd" && exec bin/lookout-up --config config --log printed) >"$work/up.txt" 2>&1 &
  up_pid=$!
  for _ in $(seq 300); do
    grep -q 'all processes are up' "$work/up.txt" && break
    kill -0 "$up_pid" 2>/dev/null || break
    sleep 0.1
  done
  grep -q 'all processes are up' "$work/up.txt" || { code=0; kill -0 "$up_pid" 2>/dev/null || wait "$up_pid" || code=$?; cat "$work/up.txt"; fail "lookout-up does not start from such a folder, LC_ALL=$locale, code $code"; }
  "$bin/lookout-sim" --config "$odd/config" --scene lake --seed 1 --seconds 6 --udp 127.0.0.1 >/dev/null &
  sim_pid=$!
  "$bin/lookout-top" --once --seconds 3 >"$work/top.txt"
  "$bin/lookout-doctor" --config "$odd/config" --seconds 2 >"$work/doctor.txt" || [ $? -eq 1 ]
  wait "$sim_pid"
  grep -q '^LIDAR_PACKETS *[0-9]*\.[0-9] ' "$work/top.txt" || { cat "$work/top.txt"; fail "lookout-top, LC_ALL=$locale"; }
  LC_ALL=C grep -Eq '^(ok|warning|fault) +lidar ' "$work/doctor.txt" || { cat "$work/doctor.txt"; fail "lookout-doctor, LC_ALL=$locale"; }
  ! grep -E '[0-9],[0-9]' "$work/top.txt" "$work/doctor.txt" || fail "a decimal comma, LC_ALL=$locale"
  kill -TERM "$up_pid"
  code=0
  wait "$up_pid" || code=$?
  up_pid=''
  [ "$code" -eq 0 ] || { cat "$work/up.txt"; fail "lookout-up ends with $code, LC_ALL=$locale"; }
  compgen -G "$odd/logs/*.lcmlog" >/dev/null || fail "no recording in such a folder, LC_ALL=$locale"
  [ -s "$odd/printed/recorder/current" ] || fail "--log keeps nothing in such a folder, LC_ALL=$locale"
done
