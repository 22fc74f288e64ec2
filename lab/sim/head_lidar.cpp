#include "lab/sim/head_lidar.hpp"

#include <chrono>
#include <cmath>

#include "common/core/frames.hpp"

namespace lookout::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

nanoseconds ToNanoseconds(double time_s) { return nanoseconds(std::llround(time_s * 1e9)); }

}  // namespace

HeadLidar::HeadLidar(const Scene& scene, const config::BoatFacts& boat, const Head& head, double rotation_rpm, const Sector& field_of_view,
                     Utime start, std::uint64_t seed)
    : head_(head),
      effects_(scene.effects),
      field_of_view_(field_of_view),
      rotor_(rotation_rpm, seed),
      shots_(scene, boat, head.ranges, seed),
      start_(start) {
  next_turn_ = static_cast<std::int64_t>(std::ceil(rotor_.AzimuthAt(0.0) / kTwoPi));
  next_column_ = static_cast<std::int64_t>(std::ceil(TimeAt(kTwoPi * static_cast<double>(next_turn_)) * 1e6 / std::max(1e-3, head.column_period_us)));
}

// The rotor wanders by less than a thousandth of its rate, so each step is nearer by as much.
double HeadLidar::TimeAt(double azimuth_rad) const {
  double time_s = (azimuth_rad - rotor_.AzimuthAt(0.0)) / rotor_.mean_rate_radps();
  for (int i = 0; i < 4; ++i) time_s += (azimuth_rad - rotor_.AzimuthAt(time_s)) / rotor_.mean_rate_radps();
  return time_s;
}

HeadScan HeadLidar::Next() {
  HeadScan made;
  auto& head = made.scan.head;
  head.seq = seq_++;
  head.range_unit_m = head_.ranges.unit_m;
  head.num_returns = effects_.return_mode() == config::Scene::DUAL ? 2 : 1;
  const double begin_rad = kTwoPi * static_cast<double>(next_turn_++);
  const double end_rad = begin_rad + kTwoPi;
  const double begin_s = TimeAt(begin_rad);
  const double rate_radps = kTwoPi / (TimeAt(end_rad) - begin_s);
  for (const HeadBeam& beam : head_.beams) {
    const double offset_rad = DegToRad(beam.azimuth_offset_deg) + rate_radps * beam.time_offset_us * 1e-6;
    const double elevation_rad = DegToRad(beam.elevation_deg);
    head.rings.push_back({static_cast<float>(elevation_rad), static_cast<float>(offset_rad),
                          static_cast<std::int32_t>(std::lround(beam.time_offset_us * 1e3)),
                          static_cast<float>(-head_.beam_radius_m * std::sin(elevation_rad))});
  }
  const auto fire = [&](double time_s, double azimuth_rad) {
    if (!field_of_view_.Contains(azimuth_rad)) return;
    const Utime time = start_ + std::chrono::floor<microseconds>(ToNanoseconds(time_s));
    if (made.scan.columns.azimuth_rad.empty()) head.time = time;
    FireColumn(time_s, azimuth_rad, rate_radps, made);
    head.end_time = time;
  };
  if (head_.columns_per_turn > 0) {
    for (int column = 0; column < head_.columns_per_turn; ++column) {
      const double turned_rad = kTwoPi * column / head_.columns_per_turn;
      fire(TimeAt(begin_rad + turned_rad), turned_rad);
    }
  } else {
    for (;; ++next_column_) {
      const double time_s = static_cast<double>(next_column_) * head_.column_period_us * 1e-6;
      const double azimuth_rad = rotor_.AzimuthAt(time_s);
      if (azimuth_rad >= end_rad) break;
      if (azimuth_rad >= begin_rad) fire(time_s, WrapTo2Pi(azimuth_rad));
    }
  }
  double last_us = 0.0;
  for (const HeadBeam& beam : head_.beams) last_us = std::max(last_us, beam.time_offset_us);
  head.end_time += std::chrono::ceil<microseconds>(ToNanoseconds(last_us * 1e-6));
  head.num_turn_columns = made.scan.columns.size();
  made.scan.parts = {{0, head.num_turn_columns}};
  return made;
}

void HeadLidar::FireColumn(double time_s, double column_azimuth_rad, double rate_radps, HeadScan& made) {
  auto& head = made.scan.head;
  auto& columns = made.scan.columns;
  shots_.MoveTo(time_s);
  columns.azimuth_rad.push_back(static_cast<float>(column_azimuth_rad));
  const auto time_ns = static_cast<std::int32_t>((start_ + ToNanoseconds(time_s) - head.time) / nanoseconds(1));
  columns.time_ns.push_back(time_ns);
  const bool is_dual = head.num_returns == 2;
  for (std::size_t ring = 0; ring < head_.beams.size(); ++ring) {
    const HeadBeam& beam = head_.beams[ring];
    const double azimuth_rad = column_azimuth_rad + DegToRad(beam.azimuth_offset_deg) + rate_radps * beam.time_offset_us * 1e-6;
    const double elevation_rad = DegToRad(beam.elevation_deg);
    const Eigen::Vector3d direction = BeamDirection(azimuth_rad, elevation_rad);
    // The beam starts off the axis, ahead of the column; the range counts as if it started on the axis.
    const Eigen::Vector3d origin_m = head_.beam_radius_m * (BeamDirection(column_azimuth_rad, 0.0) - direction);
    const Shot shot = shots_.Fire(origin_m, direction);
    const auto add = [&](const Measurement& measurement, int return_index) {
      if (measurement.range != 0) {
        const nanoseconds since_start(std::int64_t{time_ns} + head.rings[ring].time_offset_ns);
        made.returns.push_back({head.time + std::chrono::round<microseconds>(since_start), static_cast<int>(ring), return_index,
                                measurement.object_id, measurement.reason, static_cast<int>(columns.range.size()),
                                origin_m + measurement.true_range_m * direction});
      }
      columns.range.push_back(measurement.range);
      columns.reflectivity.push_back(measurement.range != 0 ? measurement.reflectivity : std::uint8_t{0});
      made.object_id.push_back(measurement.range != 0 ? measurement.object_id : kNoObject);
    };
    if (is_dual) {
      add(shot.last, 0);
      add(shot.strongest, 1);
    } else {
      add(effects_.return_mode() == config::Scene::LAST ? shot.last : shot.strongest, 0);
    }
  }
}

}  // namespace lookout::sim
