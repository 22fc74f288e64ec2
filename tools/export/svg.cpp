#include "tools/export/svg.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/utime.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/segment_t.hpp"
#include "tools/export/bearings.hpp"
#include "tools/export/labelled_turn.hpp"
#include "tools/export/picture.hpp"
#include "tools/export/returns.hpp"
#include "tools/export/words.hpp"

namespace lookout::exporter {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

std::string Format(const char* format, auto... values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// "2026-11-21 12:18:05.250 UTC"
std::string UtcText(std::int64_t utime_us) {
  const auto time = UtimeFromWire(utime_us);
  if (!time) return "";
  const auto day = std::chrono::floor<std::chrono::days>(*time);
  const std::chrono::year_month_day date(day);
  const auto past_midnight = std::chrono::floor<std::chrono::milliseconds>(*time - day);
  const std::chrono::hh_mm_ss clock(past_midnight);
  return Format("%04d-%02u-%02u %02d:%02d:%02d.%03d UTC", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
}

// From a frame whose x axis is forward and y axis left to the picture; `heading_rad` turns it so that north is up.
class View {
 public:
  explicit View(double heading_rad) : sin_(std::sin(heading_rad)), cos_(std::cos(heading_rad)) {}
  Spot ToSpot(double x_m, double y_m) const { return {x_m * sin_ - y_m * cos_, x_m * cos_ + y_m * sin_}; }

 private:
  double sin_;
  double cos_;
};

BoatShape ShapeOf(const std::optional<BoatOfLog>& boat, double bow_rad) {
  if (!boat) return {.bow_rad = bow_rad};
  const auto& box = boat->own_vessel_box_m;
  return {.bow_rad = bow_rad,
          .min_right_m = -box.max().y(),
          .max_right_m = -box.min().y(),
          .min_up_m = box.min().x(),
          .max_up_m = box.max().x(),
          .has_size = true};
}

// What an outline is called in the legend, in place of a size that says little of it; nullopt for a sure obstacle.
std::optional<std::string_view> Remark(int confidence, int kind) {
  if (confidence == segment_t::CONFIDENCE_TENTATIVE) return words::WordOf(words::kConfidence, confidence);
  if (kind == segment_t::KIND_LAND) return words::WordOf(words::kKind, kind);
  return std::nullopt;
}

// Land is drawn as its waterline: the hull of a shore covers the water before it, and the boat.
bool HasWaterline(int kind, const std::vector<float>& waterline_x_m) { return kind == segment_t::KIND_LAND && !waterline_x_m.empty(); }

// "2 segments", "3 obstacles, 1 of them tentative"
std::string CountText(const Picture& picture, const char* things) {
  const auto num_tentative = std::ranges::count(picture.outlines, true, &Outline::is_tentative);
  return Format("%zu %s", picture.outlines.size(), things) +
         (num_tentative > 0 ? Format(", %d of them tentative", static_cast<int>(num_tentative)) : "");
}

// Both pictures need POSE and RUN_INFO beside their own channels.
class SvgSink : public Sink {
 public:
  Taken Take(std::string_view channel, Bytes bytes, std::string&) final {
    if (channel == bus::kPose.name) return bearings_.TakePose(bytes, TurnUtimeUs());
    if (channel == bus::kRunInfo.name) return bearings_.TakeRunInfo(bytes);
    return TakeOwn(channel, bytes);
  }

  void Finish(std::string& text) final {
    FinishOwn();
    if (HasTurn()) text += DrawSvg(MakePicture(bearings_));
  }

 protected:
  virtual Taken TakeOwn(std::string_view channel, Bytes bytes) = 0;
  virtual void FinishOwn() = 0;
  virtual bool HasTurn() const = 0;
  virtual std::int64_t TurnUtimeUs() const = 0;  // of the turn that is looked at; 0 = none yet
  virtual Picture MakePicture(const Bearings& bearings) const = 0;

 private:
  Bearings bearings_;
};

class ReturnsSvgSink final : public SvgSink {
 public:
  explicit ReturnsSvgSink(std::optional<std::int64_t> turn) : is_fixed_(turn), turn_(turn) {}
  std::vector<bus::Channel> Channels() const override { return {bus::kLidarScan, bus::kSegments, bus::kPose, bus::kRunInfo}; }

 protected:
  Taken TakeOwn(std::string_view channel, Bytes bytes) override { return turn_.Take(channel, bytes); }
  void FinishOwn() override { turn_.Finish(); }
  bool HasTurn() const override { return !turn_.parts().empty(); }
  std::int64_t TurnUtimeUs() const override { return is_fixed_ && HasTurn() ? turn_.place().utime_us : turn_.latest_utime_us(); }
  Picture MakePicture(const Bearings& bearings) const override;

 private:
  bool is_fixed_;
  LabelledTurn turn_;
};

Picture ReturnsSvgSink::MakePicture(const Bearings& bearings) const {
  const auto& place = turn_.place();
  const auto& boat = bearings.boat();
  const auto heading_rad = bearings.HeadingAt(place.utime_us);
  const bool is_north_up = boat && heading_rad;
  const double up_rad = is_north_up ? *heading_rad : 0.0;
  const View view(up_rad);
  const Isometry3d T_vessel_lidar = boat ? boat->T_vessel_lidar : Isometry3d::Identity();
  const auto to_spot = [&](const Vector3d& p_lidar_m) {
    const Vector3d p_vessel_m = T_vessel_lidar * p_lidar_m;
    return view.ToSpot(p_vessel_m.x(), p_vessel_m.y());
  };

  Picture picture;
  picture.up = is_north_up ? "N" : (boat ? "bow" : "lidar x");
  if (boat) picture.boat = ShapeOf(boat, up_rad);

  // Ordered by reason, then label: what is in no segment lies below.
  std::map<std::string_view, Dots> loose;
  std::map<int, Dots> labelled;
  int num_returns = 0;
  bool has_labels = false;
  for (const auto& part : turn_.parts()) {
    has_labels = has_labels || part.segments;
    ForEachReturn(part, [&](const Return& one) {
      ++num_returns;
      auto& dots = one.label > 0 ? labelled[one.label] : loose[one.reason];
      dots.colour = one.label > 0 ? ColourOfSegment(one.label) : ColourOfReason(one.reason);
      dots.spots.push_back(to_spot(one.p_lidar_m));
    });
  }
  for (auto& [reason, dots] : loose) {
    const std::string name = reason.empty() ? (has_labels ? "without label" : "not labelled: no SEGMENTS in the log") : std::string(reason);
    picture.legend.push_back({dots.colour, name + Format(" (%zu returns)", dots.spots.size())});
    picture.dots.push_back(std::move(dots));
  }
  for (auto& [label, dots] : labelled) picture.dots.push_back(std::move(dots));

  for (const auto& segment : turn_.Segments()) {
    Outline outline;
    outline.colour = ColourOfSegment(segment.id);
    outline.name = std::to_string(segment.id);
    outline.distance_m = std::hypot(static_cast<double>(segment.nearest_m[0]), static_cast<double>(segment.nearest_m[1]));
    outline.is_tentative = segment.confidence == segment_t::CONFIDENCE_TENTATIVE;
    outline.is_line = HasWaterline(segment.kind, segment.waterline_x_m);
    const auto remark = Remark(segment.confidence, segment.kind);
    const std::string size =
        remark ? std::string(*remark) : Format("%.1f x %.1f m", static_cast<double>(segment.length_m), static_cast<double>(segment.width_m));
    outline.facts = Format("%.1f m, %s, %d returns", outline.distance_m, size.c_str(), segment.num_points);
    const double height_m = static_cast<double>(segment.centroid_m[2]);
    const auto& x_m = outline.is_line ? segment.waterline_x_m : segment.hull_x_m;
    const auto& y_m = outline.is_line ? segment.waterline_y_m : segment.hull_y_m;
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      outline.corners.push_back(to_spot({static_cast<double>(x_m[i]), static_cast<double>(y_m[i]), height_m}));
    }
    picture.outlines.push_back(std::move(outline));
  }
  picture.title = Format("Turn %lld: %d returns, ", static_cast<long long>(place.seq), num_returns) + CountText(picture, "segments");
  picture.subtitles = {UtcText(place.utime_us), is_north_up ? Format("north up, heading %.1f deg", RadToDeg(up_rad))
                                                : boat      ? "bow up: no heading in the log"
                                                            : "lidar frame: no config of the boat in the log"};
  picture.outlines_title = "segments, nearest first, tentative last";
  return picture;
}

class ObstaclesSvgSink final : public SvgSink {
 public:
  explicit ObstaclesSvgSink(std::optional<std::int64_t> turn) : is_fixed_(turn), picker_(turn) {}
  std::vector<bus::Channel> Channels() const override { return {bus::kObstacles, bus::kPose, bus::kRunInfo}; }

 protected:
  Taken TakeOwn(std::string_view, Bytes bytes) override {
    auto message = bus::Decode<obstacles_t>(bytes);
    if (!message) return Taken::kUndecodable;
    if (!UtimeFromWire(message->utime_us)) return Taken::kInconsistent;
    latest_utime_us_ = message->utime_us;
    picker_.Add({message->utime_us, message->seq, message->part_index, message->num_parts, message->scan_flags}, std::move(*message));
    return Taken::kOk;
  }
  void FinishOwn() override { picker_.Finish(); }
  bool HasTurn() const override { return !picker_.parts().empty(); }
  std::int64_t TurnUtimeUs() const override { return is_fixed_ && HasTurn() ? picker_.place().utime_us : latest_utime_us_; }
  Picture MakePicture(const Bearings& bearings) const override;

 private:
  bool is_fixed_;
  TurnPicker<obstacles_t> picker_;
  std::int64_t latest_utime_us_ = 0;
};

Picture ObstaclesSvgSink::MakePicture(const Bearings& bearings) const {
  const auto& place = picker_.place();
  const auto heading_rad = bearings.HeadingAt(place.utime_us);
  const bool is_north_up = heading_rad.has_value();
  const double up_rad = is_north_up ? *heading_rad : 0.0;
  const View view(up_rad);
  Picture picture;
  picture.up = is_north_up ? "N" : "bow";
  picture.boat = ShapeOf(bearings.boat(), up_rad);
  std::map<int, int> num_by_status;
  for (const auto& part : picker_.parts()) {
    for (const auto& obstacle : part.obstacles) {
      ++num_by_status[obstacle.status];
      Outline outline;
      outline.colour = ColourOfSegment(obstacle.id);
      outline.name = std::to_string(obstacle.id);
      outline.distance_m = static_cast<double>(obstacle.range_m);
      outline.is_tentative = obstacle.confidence == obstacle_t::CONFIDENCE_TENTATIVE;
      outline.is_line = HasWaterline(obstacle.kind, obstacle.waterline_vessel_x_m);
      const auto remark = Remark(obstacle.confidence, obstacle.kind);
      const std::string size =
          remark ? std::string(*remark) : Format("%.1f x %.1f m", static_cast<double>(obstacle.length_m), static_cast<double>(obstacle.width_m));
      outline.facts = Format("%.1f m at %.0f deg, %s", outline.distance_m, RadToDeg(static_cast<double>(obstacle.bearing_rad)), size.c_str());
      const auto& x_m = outline.is_line ? obstacle.waterline_vessel_x_m : obstacle.footprint_vessel_x_m;
      const auto& y_m = outline.is_line ? obstacle.waterline_vessel_y_m : obstacle.footprint_vessel_y_m;
      for (std::size_t i = 0; i < x_m.size(); ++i) {
        outline.corners.push_back(view.ToSpot(static_cast<double>(x_m[i]), static_cast<double>(y_m[i])));
      }
      picture.outlines.push_back(std::move(outline));
    }
  }
  std::string statuses;
  for (const auto& [status, count] : num_by_status) {
    statuses += (statuses.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(words::WordOf(words::kObstacleStatus, status));
  }
  picture.title = Format("Turn %lld: ", static_cast<long long>(place.seq)) + CountText(picture, "obstacles");
  picture.subtitles = {UtcText(place.utime_us) + (statuses.empty() ? "" : ", status: " + statuses),
                       is_north_up ? Format("north up, heading %.1f deg", RadToDeg(up_rad)) : "bow up: no heading in the log"};
  picture.outlines_title = "nearest first, tentative last; bearing from the bow";
  return picture;
}

}  // namespace

std::unique_ptr<Sink> MakeReturnsSvgSink(std::optional<std::int64_t> turn) { return std::make_unique<ReturnsSvgSink>(turn); }
std::unique_ptr<Sink> MakeObstaclesSvgSink(std::optional<std::int64_t> turn) { return std::make_unique<ObstaclesSvgSink>(turn); }

}  // namespace lookout::exporter
