#include "services/tracker/handover.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/messages/checks.hpp"

namespace lookout::tracker {

namespace fs = std::filesystem;

std::optional<Legacy> ToLegacy(const alerts_t& alerts, const tracks_t& tracks) {
  const auto time = UtimeFromWire(alerts.end_utime_us);
  if (!time || !messages::IsWellFormed(tracks) || tracks.utime_us != alerts.utime_us || tracks.seq != alerts.seq) return std::nullopt;
  Legacy legacy;
  legacy.time = *time;
  legacy.datum = {tracks.datum_latitude_deg, tracks.datum_longitude_deg, tracks.datum_ellipsoid_height_m};
  for (const auto& message : alerts.alerts) {
    // Of no track: it may have been land, or what had no name yet; people are asked again.
    if (message.state != alert_t::STATE_ACKNOWLEDGED || message.track_id == 0) continue;
    Alert& alert = legacy.alerts.emplace_back();
    alert.id = message.id;
    alert.cause = static_cast<AlertCause>(message.cause);
    alert.level = static_cast<AlertLevel>(message.level);
    alert.state = AlertState::kAcknowledged;
    alert.track_id = message.track_id;
  }
  for (const auto& message : tracks.tracks) {
    Track& track = legacy.tracks.emplace_back();
    track.id = message.id;
    track.position_m = {message.position_map_m[0], message.position_map_m[1]};
    track.velocity_mps = {message.velocity_map_mps[0], message.velocity_map_mps[1]};
  }
  return legacy;
}

Handover Handover::FromEnvironment() {
  const char* folder = std::getenv("RUNTIME_DIRECTORY");
  // systemd joins several by colons; a unit of this process has one.
  if (folder == nullptr || std::string_view(folder).find(':') != std::string_view::npos) return Handover({});
  return Handover(folder);
}

std::optional<Legacy> Handover::Read() const {
  if (folder_.empty() || !fs::is_regular_file(File())) return std::nullopt;
  std::optional<alerts_t> alerts;
  std::optional<tracks_t> tracks;
  bus::LogReader reader(File());
  while (const auto event = reader.Next()) {
    if (event->channel == bus::kAlerts.name) alerts = bus::Decode<alerts_t>(event->bytes);
    if (event->channel == bus::kTracks.name) tracks = bus::Decode<tracks_t>(event->bytes);
  }
  return alerts && tracks ? ToLegacy(*alerts, *tracks) : std::nullopt;
}

void Handover::Write(const alerts_t& alerts, const tracks_t& tracks) {
  if (folder_.empty()) return;
  std::error_code failure;
  if (std::ranges::none_of(alerts.alerts, [](const alert_t& alert) { return alert.state == alert_t::STATE_ACKNOWLEDGED; })) {
    if (is_written_) fs::remove(File(), failure);
    is_written_ = false;
    return;
  }
  std::vector<std::uint8_t> log;
  const auto time = UtimeFromWire(alerts.end_utime_us).value_or(Utime{});
  bus::AppendLogEvent(log, 0, time, bus::kAlerts.name, bus::Encode(alerts));
  bus::AppendLogEvent(log, 1, time, bus::kTracks.name, bus::Encode(tracks));
  const auto partial = folder_ / "alerts.lcmlog.partial";
  std::ofstream out(partial, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(log.data()), static_cast<std::streamsize>(log.size()));
  out.close();
  if (out) fs::rename(partial, File(), failure);
  is_written_ = true;
}

}  // namespace lookout::tracker
