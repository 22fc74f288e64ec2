// Any bytes as sentences of AIS, with a right checksum or as they are, beside tracks: no crash, no hang, nothing that is not a number but unknown, no
// track of two ships and no ship of two tracks.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>
#include <string_view>

#include "services/ais/core/watcher.hpp"

namespace {

using namespace lookout;
using namespace lookout::ais;

std::string WithChecksum(const std::string& line) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  unsigned checksum = 0;
  for (const char character : line.substr(1)) checksum ^= static_cast<unsigned char>(character);
  return line + '*' + kDigits[checksum >> 4] + kDigits[checksum & 15U];
}

TracksOfScan MakeScan(Utime time, const GeodeticPlace& place) {
  TracksOfScan scan;
  scan.time = time - std::chrono::milliseconds(100);
  scan.end_time = time;
  scan.datum = {place.latitude_deg, place.longitude_deg, 0.0};
  for (int i = 0; i < 3; ++i) {
    auto& track = scan.tracks.emplace_back();
    track.id = i + 1;
    track.center_map_m = {10.0 * i, 5.0};
    track.covariance_m2 = track.velocity_covariance = Eigen::Matrix2d::Identity() * 0.1;
    track.length_m = 8.0;
    track.width_m = 3.0;
    track.length_bearing_rad = 0.5;
    track.seen_share = 0.6;
    track.outline_map_m = {{10.0 * i - 1.0, 4.0}, {10.0 * i + 1.0, 4.0}, {10.0 * i, 8.0}};
  }
  return scan;
}

void Check(const Picture& picture) {
  std::set<std::int64_t> tracks;
  std::int32_t last_mmsi = 0;
  for (const auto& ship : picture.ships) {
    if (ship.ship.mmsi <= last_mmsi || ship.ship.mmsi > 999'999'999) std::abort();
    last_mmsi = ship.ship.mmsi;
    if (std::isinf(ship.place.latitude_deg) || std::isinf(ship.range_m) || !(ship.probability >= 0.0 && ship.probability <= 1.0)) std::abort();
    if (ship.predicted && !(ship.predicted->center_map_m.allFinite() && ship.predicted->covariance_m2.allFinite())) std::abort();
    if (ship.state == ShipState::kTracked && !tracks.insert(ship.track_id).second) std::abort();
    for (const char character : ship.ship.name) {
      if (character < ' ' || character > '~') std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  WatcherParams params;
  params.list_range_m = 3e7;
  Watcher watcher(params);
  Utime time = std::chrono::sys_days(std::chrono::year(2026) / 7 / 1);
  // Tracks stand about the place of the last line that tells one.
  GeodeticPlace place;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  while (!rest.empty()) {
    const auto end = std::min(rest.find('\n'), rest.size());
    const std::string line(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty()) continue;
    // The last character moves time.
    time += std::chrono::milliseconds(40 * static_cast<unsigned char>(line.back()));
    watcher.Consume({time, line == "start", "udp", line});
    watcher.Consume({time, false, "udp", WithChecksum(line)});
    Pose own;
    own.time = time;
    own.is_placed = true;
    auto scan = MakeScan(time, place);
    own.datum = scan.datum;
    const auto picture = watcher.Update(scan, own);
    Check(picture);
    if (!picture.ships.empty() && std::isfinite(picture.ships.front().place.latitude_deg)) {
      place = {picture.ships.front().place.latitude_deg, picture.ships.front().place.longitude_deg, 0.0};
    }
  }
  Check(watcher.Update(MakeScan(time, place), std::nullopt));
  return 0;
}
