#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/core/utime.hpp"
#include "common/messages/words.hpp"
#include "tools/export/map_sinks.hpp"
#include "tools/export/outlines.hpp"
#include "tools/export/scans.hpp"

namespace lookout::exporter {

namespace {

bool HasSoundTimes(const obstacles_t& message) {
  return UtimeFromWire(message.utime_us) && UtimeFromWire(message.end_utime_us) &&
         std::ranges::all_of(message.obstacles, [](const obstacle_t& one) { return UtimeFromWire(one.utime_us).has_value(); });
}

class ObstacleMapSink final : public Sink {
 public:
  ObstacleMapSink(std::unique_ptr<MapWriter> writer, const std::optional<Circle>& circle, const Scans& scans)
      : writer_(std::move(writer)), circle_(circle) {
    if (circle) near_.emplace(circle->place, circle->radius_m);
    if (scans.is_one) chosen_.emplace(ChosenScan::Of::kObstacles, scans.seq);
  }

  std::vector<bus::Channel> Channels() const override { return {bus::kObstacles}; }

  Taken Take(std::string_view channel, Bytes bytes, std::string& text) override {
    const auto message = bus::Decode<obstacles_t>(bytes);
    if (!message) return Taken::kUndecodable;
    if (!HasSoundTimes(*message)) return Taken::kInconsistent;
    if (chosen_) return chosen_->Take(channel, bytes);
    Append(*message, text);
    return Taken::kOk;
  }

  void Finish(std::string& text) override {
    if (chosen_) {
      chosen_->Finish();
      if (!chosen_->chosen()) return;
      for (const auto& [part_index, part] : chosen_->chosen()->obstacles) Append(part, text);
    }
    if (circle_ && num_written_ == 0) throw std::runtime_error("no obstacle lies " + TextOf(*circle_));
    BeginOnce(text);
    writer_->End(text);
  }

  bool IsDone() const override { return chosen_ && chosen_->IsDone(); }

  std::vector<std::string> Remarks() const override {
    if (num_unplaced_ == 0) return {};
    return {std::to_string(num_unplaced_) + " obstacles have no place on the earth and are left out"};
  }

 private:
  void BeginOnce(std::string& text) {
    if (!std::exchange(has_begun_, true)) writer_->Begin(text);
  }

  void Append(const obstacles_t& message, std::string& text) {
    BeginOnce(text);
    const auto map = MapOf(message);
    for (const auto& obstacle : message.obstacles) {
      const auto place = PlaceOf(obstacle.latitude_deg, obstacle.longitude_deg);
      if (obstacle.status != obstacle_t::STATUS_OK || !place || !map) {
        ++num_unplaced_;
        continue;
      }
      const auto outline = OutlineOf(obstacle, *map);
      if (near_ && !near_->Holds(*place) && !(outline && near_->Holds(*outline))) continue;
      ++num_written_;
      const auto name = fmt::format("{} {}", words::WordOf(words::kKind, obstacle.kind), obstacle.id);
      const auto append = [&](std::string what, Geometry geometry, std::vector<Property> properties) {
        writer_->Append({.what = std::move(what),
                         .name = name,
                         .geometry = std::move(geometry),
                         .utime_us = message.utime_us,
                         .end_utime_us = message.end_utime_us,
                         .properties = std::move(properties)},
                        text);
      };
      append("obstacle", PointAt(*place), Properties(message, obstacle));
      // Enough to colour them by, and to find the point.
      const std::vector<Property> few{{"scan_seq", message.seq},
                                      {"obstacle_id", std::int64_t{obstacle.id}},
                                      {"confidence", std::string(words::WordOf(words::kConfidence, obstacle.confidence))},
                                      {"kind", std::string(words::WordOf(words::kKind, obstacle.kind))}};
      // An outline of one return is the point.
      if (outline && outline->kind != Geometry::Kind::kPoint) append(obstacle.kind == obstacle_t::KIND_LAND ? "waterline" : "outline", *outline, few);
      if (auto ellipse = EllipseOf(obstacle, *map)) append("ellipse", std::move(*ellipse), few);
    }
  }

  static std::vector<Property> Properties(const obstacles_t& message, const obstacle_t& obstacle) {
    return {{"scan_seq", message.seq},
            {"scan_utime_us", message.utime_us},
            {"utime_us", obstacle.utime_us},
            {"obstacle_id", std::int64_t{obstacle.id}},
            {"confidence", std::string(words::WordOf(words::kConfidence, obstacle.confidence))},
            {"kind", std::string(words::WordOf(words::kKind, obstacle.kind))},
            {"thing_probability", Fixed{obstacle.thing_probability, 4}},
            {"range_m", Fixed{obstacle.range_m, 2}},
            {"bearing_deg", Direction{obstacle.bearing_rad}},
            {"length_m", Fixed{obstacle.length_m, 2}},
            {"width_m", Fixed{obstacle.width_m, 2}},
            {"height_m", Fixed{obstacle.height_m, 2}},
            {"top_above_water_m", Fixed{obstacle.top_above_water_m, 2}},
            {"num_points", std::int64_t{obstacle.num_points}},
            {"cov_ee_m2", Shortest{obstacle.covariance_m2[0]}},
            {"cov_en_m2", Shortest{obstacle.covariance_m2[1]}},
            {"cov_nn_m2", Shortest{obstacle.covariance_m2[2]}}};
  }

  std::unique_ptr<MapWriter> writer_;
  std::optional<Circle> circle_;
  std::optional<Near> near_;
  std::optional<ChosenScan> chosen_;
  bool has_begun_ = false;
  std::int64_t num_written_ = 0;
  std::int64_t num_unplaced_ = 0;
};

}  // namespace

std::unique_ptr<Sink> MakeObstacleMapSink(std::unique_ptr<MapWriter> writer, const std::optional<Circle>& near, const Scans& scans) {
  return std::make_unique<ObstacleMapSink>(std::move(writer), near, scans);
}

}  // namespace lookout::exporter
