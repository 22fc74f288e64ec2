#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "common/messages/words.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tools/export/map_sinks.hpp"
#include "tools/export/outlines.hpp"
#include "tools/export/waterline.hpp"

namespace lookout::exporter {

namespace {

// A sphere stands for the earth where only steps are measured.
constexpr double kMetresPerNanodeg = 111'195e-9;
constexpr double kShortestStepM = 0.5;
constexpr std::int64_t kLongestGapUs = 10'000'000;
constexpr std::int64_t kLongestPauseUs = 10'000'000;

double DistanceM(const MapPlace& a, const MapPlace& b) {
  const double north_m = kMetresPerNanodeg * static_cast<double>(b.latitude_ndeg - a.latitude_ndeg);
  const double turn_deg = std::remainder(1e-9 * static_cast<double>(b.longitude_ndeg - a.longitude_ndeg), 360.0);
  return Hypot(north_m, kMetresPerNanodeg * 1e9 * turn_deg * Cos(DegToRad(1e-9 * static_cast<double>(a.latitude_ndeg))));
}

// Where something was, thinned out: a place each 0.5 m or 10 s, and the last one.
class Trail {
 public:
  struct Piece {
    std::string status;
    std::vector<MapPlace> places;
    std::vector<std::int64_t> utimes_us;
  };

  // A piece of another status begins where the last one ends.
  void Add(const MapPlace& place, std::int64_t utime_us, std::string_view status = {}) {
    // Nobody knows the way through a gap, or from one log to the next.
    if (last_utime_us_ && (utime_us < *last_utime_us_ || utime_us - *last_utime_us_ > kLongestGapUs)) Break();
    last_utime_us_ = utime_us;
    if (pieces_.empty() || is_broken_) {
      Keep();
      pieces_.push_back({std::string(status), {}, {}});
    } else if (pieces_.back().status != status) {
      Keep();
      const auto& last = pieces_.back();
      pieces_.push_back({std::string(status), {last.places.back()}, {last.utimes_us.back()}});
    }
    is_broken_ = false;
    latest_ = {place, utime_us};
    const auto& piece = pieces_.back();
    if (piece.places.empty() || DistanceM(piece.places.back(), place) >= kShortestStepM || utime_us - piece.utimes_us.back() >= kLongestPauseUs) {
      Keep();
    }
  }

  void Break() { is_broken_ = true; }

  // No more places come.
  const std::vector<Piece>& Finish() {
    Keep();
    return pieces_;
  }

 private:
  void Keep() {
    if (!latest_) return;
    pieces_.back().places.push_back(latest_->first);
    pieces_.back().utimes_us.push_back(latest_->second);
    latest_.reset();
  }

  std::vector<Piece> pieces_;
  std::optional<std::pair<MapPlace, std::int64_t>> latest_;  // not in the piece yet
  std::optional<std::int64_t> last_utime_us_;                // of the last place that came
  bool is_broken_ = false;
};

// One track of the tracker, as long as it was confirmed.
struct Followed {
  track_t latest;
  GeodeticPlace datum;
  std::int64_t first_utime_us = 0;
  std::int64_t utime_us = 0;  // of `latest`
  Trail trail;
  bool has_moved = false;
};

// Where the boat was when an alert came up.
struct Warned {
  alert_t alert;
  MapPlace place;
  std::int64_t utime_us = 0;
};

class TrackMapSink final : public Sink {
 public:
  TrackMapSink(std::unique_ptr<MapWriter> writer, bool has_tracks, const std::optional<Circle>& circle, const Scans& scans)
      : writer_(std::move(writer)), has_tracks_(has_tracks), circle_(circle), scans_(scans) {
    if (circle) near_.emplace(circle->place, circle->radius_m);
  }

  std::vector<bus::Channel> Channels() const override {
    return has_tracks_ ? std::vector<bus::Channel>{bus::kTracks, bus::kPose, bus::kAlerts} : std::vector<bus::Channel>{bus::kPose};
  }

  Taken Take(std::string_view channel, Bytes bytes, std::string& /*text*/) override {
    if (channel == bus::kTracks.name) return TakeTracks(bytes);
    if (channel == bus::kAlerts.name) return TakeAlerts(bytes);
    return TakePose(bytes);
  }

  bool IsDone() const override { return is_done_; }

  void Finish(std::string& text) override {
    const auto& pieces = own_.Finish();
    // The reader of the log tells it.
    if (scans_.is_one && !scan_utime_us_) return;
    if (!has_tracks_ && pieces.empty() && !circle_) return;
    writer_->Begin(text);
    if (scans_.is_one) {
      WriteOwnPlace(text);
    } else {
      WriteTrail("own_track", "own track", pieces, {}, text);
    }
    WriteWaterline(text);
    for (auto& [key, followed] : followed_) Write(followed, text);
    for (const auto& warned : warned_) Write(warned, text);
    if (circle_ && num_written_ == 0) throw std::runtime_error("nothing lies " + TextOf(*circle_));
    writer_->End(text);
  }

  std::vector<std::string> Remarks() const override {
    if (num_alerts_without_place_ == 0) return {};
    return {std::to_string(num_alerts_without_place_) + " alerts came up where the place of the boat was not known, and are left out"};
  }

 private:
  bool IsNear(const MapPlace& place) const { return !near_ || near_->Holds(place); }

  Taken TakePose(Bytes bytes) {
    const auto pose = bus::Decode<pose_t>(bytes);
    if (!pose) return Taken::kUndecodable;
    if (!UtimeFromWire(pose->utime_us)) return Taken::kInconsistent;
    const bool has_place = pose->status == pose_t::STATUS_OK || pose->status == pose_t::STATUS_COASTING || pose->status == pose_t::STATUS_NO_HEADING;
    // A receiver without a heading has a place, also in a frame that is not on the earth.
    const auto place = PlaceOf(pose->latitude_deg, pose->longitude_deg);
    if (has_place && !place) return Taken::kInconsistent;
    if (!has_place && (pose->status < pose_t::STATUS_RELATIVE || !place)) {
      own_place_.reset();
      own_.Break();
      return Taken::kOk;
    }
    own_place_ = {*place, pose->utime_us};
    if (!IsNear(*place)) {
      own_.Break();
    } else if (!scans_.is_one) {
      own_.Add(*place, pose->utime_us, words::WordOf(words::kPoseStatus, pose->status));
    }
    return Taken::kOk;
  }

  // @return whether this message is wanted
  bool BeginScan(const tracks_t& tracks) {
    if (!scans_.is_one) return true;
    if (scans_.seq && scan_utime_us_ && tracks.utime_us != scan_utime_us_) is_done_ = true;
    if (is_done_ || (scans_.seq && tracks.seq != *scans_.seq)) return false;
    if (scan_utime_us_ != tracks.utime_us) {
      followed_.clear();
      warned_.clear();
      told_.clear();
      scan_place_ = own_place_;
    }
    scan_utime_us_ = tracks.utime_us;
    return true;
  }

  Taken TakeTracks(Bytes bytes) {
    const auto tracks = bus::Decode<tracks_t>(bytes);
    if (!tracks) return Taken::kUndecodable;
    if (!UtimeFromWire(tracks->utime_us) || !UtimeFromWire(tracks->end_utime_us)) return Taken::kInconsistent;
    const bool is_wanted = BeginScan(*tracks);
    if (is_done_) return Taken::kOk;
    if (!MapOf(*tracks)) return tracks->tracks.empty() ? Taken::kOk : Taken::kInconsistent;
    const double height_m = std::isfinite(tracks->datum_ellipsoid_height_m) ? tracks->datum_ellipsoid_height_m : 0.0;  // as MapOf
    const GeodeticPlace datum{tracks->datum_latitude_deg, tracks->datum_longitude_deg, height_m};
    if (tracks->num_waterline > 0) {
      if (scans_.is_one) waterline_.Clear();
      waterline_.Add(datum, CornersOf(tracks->waterline_east_m, tracks->waterline_north_m));
      waterline_utime_us_ = {waterline_utime_us_ && !scans_.is_one ? waterline_utime_us_->first : tracks->end_utime_us, tracks->end_utime_us};
    }
    if (!is_wanted) return Taken::kOk;
    for (const auto& track : tracks->tracks) {
      const auto place = PlaceOf(track.latitude_deg, track.longitude_deg);
      if (!place || !UtimeFromWire(track.first_utime_us) || !UtimeFromWire(track.seen_utime_us)) return Taken::kInconsistent;
      const std::pair key(tracks->begin_utime_us, track.id);
      const auto known = followed_.find(key);
      if (track.status == track_t::STATUS_LOST && known != followed_.end()) known->second.latest.status = track.status;
      if (track.status != track_t::STATUS_CONFIRMED && track.status != track_t::STATUS_COASTING) continue;
      if (!IsNear(*place)) {
        if (known != followed_.end()) known->second.trail.Break();
        continue;
      }
      auto& followed = known != followed_.end() ? known->second : followed_[key];
      if (known == followed_.end()) followed.first_utime_us = tracks->end_utime_us;
      followed.latest = track;
      followed.datum = datum;
      followed.utime_us = tracks->end_utime_us;
      followed.has_moved |= track.speed_mps > 0.0F;
      followed.trail.Add(*place, tracks->end_utime_us);
    }
    return Taken::kOk;
  }

  Taken TakeAlerts(Bytes bytes) {
    const auto alerts = bus::Decode<alerts_t>(bytes);
    if (!alerts) return Taken::kUndecodable;
    if (!UtimeFromWire(alerts->end_utime_us)) return Taken::kInconsistent;
    if (scans_.is_one && (!scan_utime_us_ || is_done_ || alerts->utime_us != *scan_utime_us_)) return Taken::kOk;
    for (const auto& alert : alerts->alerts) {
      const bool holds = alert.state == alert_t::STATE_ACTIVE || (scans_.is_one && alert.state == alert_t::STATE_ACKNOWLEDGED);
      if (!holds || !told_.emplace(alert.id, alert.raised_utime_us).second) continue;
      if (!own_place_) {
        ++num_alerts_without_place_;
      } else if (IsNear(own_place_->first)) {
        warned_.push_back({alert, own_place_->first, alerts->end_utime_us});
      }
    }
    return Taken::kOk;
  }

  void Write(const Feature& feature, std::string& text) {
    ++num_written_;
    writer_->Append(feature, text);
  }

  void WriteTrail(const std::string& what, const std::string& name, const std::vector<Trail::Piece>& pieces, const std::vector<Property>& properties,
                  std::string& text) {
    for (const auto& piece : pieces) {
      auto all = properties;
      if (!piece.status.empty()) all.push_back({"status", piece.status});
      Write({.what = what,
             .name = name,
             .geometry = LineAlong(piece.places, piece.utimes_us),
             .utime_us = piece.utimes_us.front(),
             .end_utime_us = piece.utimes_us.back(),
             .properties = std::move(all)},
            text);
    }
  }

  void WriteOwnPlace(std::string& text) {
    if (!scan_place_ || !IsNear(scan_place_->first)) return;
    Write({.what = "own_place", .name = "own place", .geometry = PointAt(scan_place_->first), .utime_us = scan_place_->second}, text);
  }

  void WriteWaterline(std::string& text) {
    auto lines = LinesAlong(waterline_.Lines(near_ ? &*near_ : nullptr));
    if (lines.parts.empty()) return;
    Write({.what = "waterline",
           .name = "waterline",
           .geometry = std::move(lines),
           .utime_us = waterline_utime_us_->first,
           .end_utime_us = waterline_utime_us_->second},
          text);
  }

  void Write(Followed& followed, std::string& text) {
    const auto& track = followed.latest;
    const auto name = fmt::format("{} {}", words::WordOf(words::kTrackKind, track.kind), track.id);
    const MapOfDatum map(followed.datum);
    const auto write = [&](std::string what, Geometry geometry, std::vector<Property> properties) {
      Write({.what = std::move(what),
             .name = name,
             .geometry = std::move(geometry),
             .utime_us = followed.first_utime_us,
             .end_utime_us = followed.utime_us,
             .properties = std::move(properties)},
            text);
    };
    write("track", PointAt(*PlaceOf(track.latitude_deg, track.longitude_deg)), Properties(track));
    const std::vector<Property> few{{"track_id", track.id},
                                    {"status", std::string(words::WordOf(words::kTrackStatus, track.status))},
                                    {"kind", std::string(words::WordOf(words::kTrackKind, track.kind))}};
    auto outline = OutlineOf(track, map);
    if (outline && outline->kind != Geometry::Kind::kPoint) write("outline", std::move(*outline), few);
    if (auto ellipse = EllipseOf(track, map)) write("ellipse", std::move(*ellipse), few);
    if (followed.has_moved && !scans_.is_one) WriteTrail("way", name, followed.trail.Finish(), few, text);
  }

  static std::vector<Property> Properties(const track_t& track) {
    return {{"track_id", track.id},
            {"status", std::string(words::WordOf(words::kTrackStatus, track.status))},
            {"kind", std::string(words::WordOf(words::kTrackKind, track.kind))},
            {"first_utime_us", track.first_utime_us},
            {"seen_utime_us", track.seen_utime_us},
            {"existence_probability", Fixed{track.existence_probability, 4}},
            {"moving_probability", Fixed{track.moving_probability, 4}},
            {"speed_mps", Fixed{track.speed_mps, 2}},
            {"course_deg", Direction{track.course_rad}},
            {"length_m", Fixed{track.length_m, 2}},
            {"width_m", Fixed{track.width_m, 2}},
            {"top_above_water_m", Fixed{track.top_above_water_m, 2}},
            {"seen_share", Fixed{track.seen_share, 4}},
            {"range_m", Fixed{track.range_m, 2}},
            {"bearing_deg", Direction{track.bearing_rad}},
            {"cpa_m", Fixed{track.cpa_m, 2}},
            {"tcpa_s", Fixed{track.tcpa_s, 1}},
            {"cov_ee_m2", Shortest{track.covariance[0][0]}},
            {"cov_en_m2", Shortest{track.covariance[0][1]}},
            {"cov_nn_m2", Shortest{track.covariance[1][1]}}};
  }

  void Write(const Warned& warned, std::string& text) {
    const auto& alert = warned.alert;
    Write({.what = "alert",
           .name = alert.text,
           .geometry = PointAt(warned.place),
           .utime_us = warned.utime_us,
           .properties = {{"alert_id", alert.id},
                          {"cause", std::string(words::WordOf(words::kAlertCause, alert.cause))},
                          {"level", std::string(words::WordOf(words::kAlertLevel, alert.level))},
                          {"track_id", alert.track_id},
                          {"distance_m", Fixed{alert.distance_m, 2}},
                          {"bearing_deg", Direction{alert.bearing_rad}},
                          {"cpa_m", Fixed{alert.cpa_m, 2}},
                          {"tcpa_s", Fixed{alert.tcpa_s, 1}}}},
          text);
  }

  using PlaceAndTime = std::pair<MapPlace, std::int64_t>;

  std::unique_ptr<MapWriter> writer_;
  bool has_tracks_;
  std::optional<Circle> circle_;
  Scans scans_;
  std::optional<Near> near_;
  Trail own_;
  std::optional<PlaceAndTime> own_place_;                               // now
  std::optional<PlaceAndTime> scan_place_;                              // when TRACKS of the one scan came
  std::optional<std::int64_t> scan_utime_us_;                           // of the one scan
  std::map<std::pair<std::int64_t, std::int64_t>, Followed> followed_;  // by the begin of the tracker's process, and id of the track
  std::set<std::pair<std::int64_t, std::int64_t>> told_;                // id of an alert, and when it was raised
  std::vector<Warned> warned_;
  Waterline waterline_;
  std::optional<std::pair<std::int64_t, std::int64_t>> waterline_utime_us_;  // told first and last
  std::int64_t num_alerts_without_place_ = 0;
  std::int64_t num_written_ = 0;
  bool is_done_ = false;
};

}  // namespace

std::unique_ptr<Sink> MakeTrackMapSink(std::unique_ptr<MapWriter> writer, bool has_tracks, const std::optional<Circle>& near, const Scans& scans) {
  return std::make_unique<TrackMapSink>(std::move(writer), has_tracks, near, scans);
}

}  // namespace lookout::exporter
