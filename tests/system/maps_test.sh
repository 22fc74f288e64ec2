#!/usr/bin/env bash
# Maps of lookout-export as other programs read them: GDAL (ogrinfo), GPSBabel and check-geojson accept each file and find in it what the tables hold;
# then GDAL draws them. Once on the lake of the demo, once with the boat on the 180th meridian.
#   maps_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
export LC_ALL=C
source_folder=$1
build=$2
bin=$build/bin
for program in ogrinfo gdal_rasterize gpsbabel; do
  command -v "$program" >/dev/null || { echo "skipped: $program is missing: apt-get install gdal-bin gpsbabel"; exit 77; }
done
work=$(mktemp -d -t lookout_maps.XXXXXX)
trap 'rm -rf "$work"' EXIT
num_failed=0
fail() { echo "FAILED: $*"; num_failed=$((num_failed + 1)); }
expect() {  # WHAT FOUND WANTED
  [ "$2" = "$3" ] || fail "$1: $2 instead of $3"
}
expect_some() {  # WHAT NUMBER
  [ "$2" -gt 0 ] || fail "there is no $1"
}

export_as() {  # LOG TABLE FORMAT [OPTION ...]
  local log=$1 table=$2 format=$3
  shift 3
  timeout 120 "$bin/lookout-export" --in "$log.lcmlog" --table "$table" --format "$format" --out "$log.$table.$format" --force "$@" 2>>"$log.said" ||
    fail "$log: $table as $format: $(tail -n 1 "$log.said")"
}
# How many features of a sort a file has; FILTER is SQL.
count() {  # FILE [FILTER]
  local layer
  layer=$(ogrinfo -ro -q "$1" | sed -nE 's/^1: (.*) \([^()]*\)$/\1/p;s/^1: ([^()]*)$/\1/p')
  ogrinfo -ro -q "$1" -sql "SELECT COUNT(*) AS number FROM \"$layer\" ${2:+WHERE $2}" | sed -nE 's/.*number \(Integer[0-9]*\) = ([0-9]+)$/\1/p'
}
# Lines of what GPSBabel makes of a GPX file, without the header.
gpsbabel_lines() {  # OPTIONS FILE
  gpsbabel $1 -i gpx -f "$2" -o unicsv -F /dev/stdout | tail -n +2 | wc -l
}

make_log() {  # LOG CONFIG SCENE SECONDS
  timeout 300 "$bin/lookout-sim" --config "$2" --scene "$3" --seed 1 --seconds "$4" --pcap "$1.pcap" >/dev/null
  timeout 300 "$bin/lookout-replay" --config "$2" --in "$1.pcap" --out "$1.lcmlog" >/dev/null 2>&1
}

check_log() {  # LOG
  local log=$1 table format placed tracks moved alerts
  for table in obstacles tracks pose; do
    for format in csv geojson kml gpx; do export_as "$log" "$table" "$format"; done
  done
  export_as "$log" alerts csv

  placed=$(awk -F, '$15 == "ok"' "$log.obstacles.csv" | wc -l)
  tracks=$(awk -F, '$9 == "confirmed" || $9 == "coasting" { print $2 }' "$log.tracks.csv" | sort -u | wc -l)
  moved=$(awk -F, '($9 == "confirmed" || $9 == "coasting") && $5 > 0 { print $2 }' "$log.tracks.csv" | sort -u | wc -l)
  alerts=$(awk -F, '$5 == "active" { print $2, $7 }' "$log.alerts.csv" | sort -u | wc -l)
  expect_some "placed obstacle" "$placed"
  expect_some "track" "$tracks"
  expect_some "moving track" "$moved"
  echo "$log: $placed obstacles, $tracks tracks, $moved of them moved, $alerts alerts"

  for format in geojson kml; do
    expect "$log: obstacles as $format" "$(count "$log.obstacles.$format" "what='obstacle'")" "$placed"
    expect "$log: ellipses of obstacles as $format" "$(count "$log.obstacles.$format" "what='ellipse'")" "$placed"
    expect_some "outline as $format" "$(count "$log.obstacles.$format" "what='outline'")"
    expect "$log: tracks as $format" "$(count "$log.tracks.$format" "what='track'")" "$tracks"
    expect "$log: ways as $format" "$(count "$log.tracks.$format" "what='way'")" "$moved"
    expect "$log: alerts as $format" "$(count "$log.tracks.$format" "what='alert'")" "$alerts"
    expect_some "own track as $format" "$(count "$log.tracks.$format" "what='own_track'")"
    expect "$log: own track in both tables as $format" "$(count "$log.pose.$format")" "$(count "$log.tracks.$format" "what='own_track'")"
  done
  expect "$log: waypoints of obstacles" "$(gpsbabel_lines '' "$log.obstacles.gpx")" "$placed"
  expect "$log: waypoints of tracks and alerts" "$(gpsbabel_lines '' "$log.tracks.gpx")" $((tracks + alerts))
  expect "$log: tracks of the boat and of what moved" "$(ogrinfo -ro -q "$log.tracks.gpx" tracks | grep -c '^OGRFeature')" $((moved + 1))
  expect "$log: places of the boat's track" "$(gpsbabel_lines -t "$log.pose.gpx")" "$(grep -o '<trkpt' "$log.pose.gpx" | wc -l)"
  ogrinfo -ro -al -so "$log.obstacles.csv" -oo GEOM_POSSIBLE_NAMES=outline_wkt >wkt 2>&1
  grep -q '^Geometry: ' wkt && ! grep -q 'Geometry: None' wkt || fail "$log: GDAL reads no outlines out of the table of obstacles"

  # The same bytes once more; parts of a log.
  cp "$log.tracks.geojson" before
  export_as "$log" tracks geojson
  cmp -s before "$log.tracks.geojson" || fail "$log: the second map differs from the first"
  export_as "$log" obstacles geojson --scan last
  expect "$log: obstacles of the last scan" "$(count "$log.obstacles.geojson" "what='obstacle'")" \
    "$(awk -F, -v seq_time="$(sed -nE '2s/.*"scan_utime_us":([0-9]+).*/\1/p' "$log.obstacles.geojson")" '$1 == seq_time && $15 == "ok"' "$log.obstacles.csv" | wc -l)"
  export_as "$log" obstacles geojson
}

# Each sort of feature alone must colour some of a picture; all together are kept beside the tests.
draw() {  # LOG
  local file=$1.tracks.geojson extent what colour red green blue
  extent=$(ogrinfo -ro -al -so "$file" | sed -nE 's/^Extent: \(([-0-9.]+), ([-0-9.]+)\) - \(([-0-9.]+), ([-0-9.]+)\)$/\1 \2 \3 \4/p')
  for colour in waterline:90:90:90 outline:213:94:0 ellipse:150:150:150 way:0:158:115 own_track:0:114:178; do
    IFS=: read -r what red green blue <<<"$colour"
    gdal_rasterize -q -ot Byte -burn 255 -at -ts 800 800 -te $extent -where "what='$what'" "$file" one.tif
    gdalinfo -stats one.tif 2>/dev/null | grep -q 'STATISTICS_MAXIMUM=255' || fail "$1: nothing is drawn of $what"
    rm -f one.tif one.tif.aux.xml
    if [ "$what" = waterline ]; then
      gdal_rasterize -q -ot Byte -init 255 -burn "$red" -burn "$green" -burn "$blue" -at -ts 800 800 -te $extent -where "what='$what'" "$file" all.tif
    else
      gdal_rasterize -q -b 1 -b 2 -b 3 -burn "$red" -burn "$green" -burn "$blue" -at -where "what='$what'" "$file" all.tif
    fi
  done
  gdal_translate -q -of PNG all.tif maps.png
  cp maps.png "$build/tests/maps.png"
  echo "drawn: $build/tests/maps.png"
}

cd "$work"
make_log lake "$source_folder/config/demo" lake 30
cp -R "$source_folder/config/demo" fiji_config
printf 'datum { latitude_deg: -17.0 longitude_deg: 180.0 ellipsoid_height_m: 55.0 }\n' >>fiji_config/boat.txtpb
make_log fiji fiji_config crossing 10
check_log lake
check_log fiji
grep -q '"MultiPolygon"' fiji.obstacles.geojson || fail "no outline is cut at the 180th meridian"
grep -q '"MultiLineString"' fiji.pose.geojson || fail "the boat's track is not cut at the 180th meridian"
draw lake

if ! command -v npm >/dev/null; then
  echo "skipped: GeoJSON is not checked against RFC 7946: there is no npm here"
else
  cp "$source_folder"/tests/system/maps/* .
  if npm ci --no-audit --no-fund >npm.log 2>&1; then
    node check.cjs lake.*.geojson fiji.*.geojson || fail "GeoJSON is not what RFC 7946 wants"
  elif grep -Eq 'ENOTFOUND|ECONNREFUSED|ETIMEDOUT|EAI_AGAIN' npm.log; then
    echo "skipped: GeoJSON is not checked against RFC 7946: no network for npm"
  else
    cat npm.log
    fail "npm ci"
  fi
fi
[ "$num_failed" -eq 0 ]
