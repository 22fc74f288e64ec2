#include "services/tracker/handover.hpp"

#include <chrono>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/io/output_file.hpp"
#include "common/io/runtime_folder.hpp"
#include "common/messages/checks.hpp"

namespace lookout::tracker {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr auto kKeptFor = 10s;  // as of KeptAcknowledgements
constexpr auto kRewriteAfter = 1s;

}  // namespace

std::optional<Legacy> ToLegacy(const alerts_t& alerts, const tracks_t& tracks) {
  const auto time = UtimeFromWire(alerts.end_utime_us);
  if (!time || !messages::IsWellFormed(tracks) || tracks.utime_us != alerts.utime_us || tracks.seq != alerts.seq) return std::nullopt;
  Legacy legacy;
  legacy.time = *time;
  legacy.datum = {tracks.datum_latitude_deg, tracks.datum_longitude_deg, tracks.datum_ellipsoid_height_m};
  for (const auto& message : alerts.alerts) {
    // Of no track: it may have been land, or a thing without a name yet; people are asked again.
    if (message.state != alert_t::STATE_ACKNOWLEDGED || message.track_id <= 0) continue;
    Alert& alert = legacy.alerts.emplace_back();
    alert.id = message.id;
    alert.cause = static_cast<AlertCause>(message.cause);
    alert.level = static_cast<AlertLevel>(message.level);
    alert.state = AlertState::kAcknowledged;
    alert.thing = alert.nearest_track = message.track_id;
  }
  for (std::size_t i = 0; i < alerts.given_name.size(); ++i) legacy.names.emplace_back(alerts.named_track_id[i], alerts.given_name[i]);
  for (const auto& message : tracks.tracks) {
    Track& track = legacy.tracks.emplace_back();
    track.id = message.id;
    track.position_m = {message.position_map_m[0], message.position_map_m[1]};
    track.velocity_mps = {message.velocity_map_mps[0], message.velocity_map_mps[1]};
  }
  return legacy;
}

Handover Handover::FromEnvironment() { return Handover(io::RuntimeFolder()); }

std::optional<Legacy> Handover::Read() try {
  if (folder_.empty() || !fs::is_regular_file(File())) return std::nullopt;
  std::optional<alerts_t> alerts;
  std::optional<tracks_t> tracks;
  bus::LogReader reader(File());
  while (const auto event = reader.Next()) {
    if (event->channel == bus::kAlerts.name) alerts = bus::Decode<alerts_t>(event->bytes);
    if (event->channel == bus::kTracks.name) tracks = bus::Decode<tracks_t>(event->bytes);
  }
  auto legacy = alerts && tracks ? ToLegacy(*alerts, *tracks) : std::nullopt;
  if (legacy) keep_until_ = legacy->time + kKeptFor;
  return legacy;
} catch (const std::runtime_error&) {
  return std::nullopt;  // it is a comfort, and no reason not to look out
}

void Handover::Write(const alerts_t& alerts, const tracks_t& tracks) {
  if (folder_.empty()) return;
  const auto time = UtimeFromWire(alerts.end_utime_us).value_or(Utime{});
  std::vector<std::int64_t> ids;
  for (const auto& alert : alerts.alerts) {
    if (alert.state == alert_t::STATE_ACKNOWLEDGED) ids.push_back(alert.id);
  }
  if (ids.empty() && alerts.given_name.empty()) {
    if (keep_until_ && time < *keep_until_) return;
    std::error_code failure;
    if (is_written_) fs::remove(File(), failure);
    is_written_ = false;
    written_.reset();
    return;
  }
  if (written_ && ids == written_ids_ && alerts.given_name == written_names_ && time >= *written_ && time < *written_ + kRewriteAfter) return;
  std::vector<std::uint8_t> log;
  bus::AppendLogEvent(log, 0, time, bus::kAlerts.name, bus::Encode(alerts));
  bus::AppendLogEvent(log, 1, time, bus::kTracks.name, bus::Encode(tracks));
  is_written_ = true;
  written_ = time;
  written_ids_ = std::move(ids);
  written_names_ = alerts.given_name;
  try {
    io::OutputFile out(File(), {.force = true, .inputs = {}, .tell = [](const std::string&) {}});
    out.Write(log);
    out.Commit();
  } catch (const std::runtime_error&) {
    return;  // nothing is left, then
  }
}

}  // namespace lookout::tracker
