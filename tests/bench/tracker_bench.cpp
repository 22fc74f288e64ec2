// The tracker's time for one scan of a VLP-16, the segmenter's of the same scan beside it, and its memory over hours.
// Scenes (argument): 0 some 30 obstacles, 1 some 200, 2 the 30 in rain: some 1500 tentative ones that each scan shows elsewhere.
#include <malloc.h>

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "services/segmenter/core/segmenter.hpp"
#include "services/tracker/core/tracker.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace {

using namespace lookout;
using segmenter::test::Wall;

constexpr std::uint64_t kSeed = 20261123;
constexpr std::chrono::milliseconds kScanPeriod(100);
// Drops and noise come again after so many scans: longer than what is not confirmed lives.
constexpr int kNumScans = 12;
constexpr Datum kDatum{43.7, -72.3, 100.0};
constexpr double kLidarAboveWaterM = 1.0;
constexpr double kNoiseM2 = 0.01;

// Boats and buoys that stand, no two nearer than 3 m to each other.
std::vector<Wall> Things(int number) {
  std::mt19937_64 random(kSeed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  std::vector<Wall> walls;
  std::vector<Eigen::Vector2d> places_m;
  while (std::ssize(places_m) < number) {
    const double azimuth_rad = uniform(0.0, kTwoPi);
    // Nothing but open water lies between most of them and the boat: the farther off, the higher.
    const double range_m = 6.0 + 55.0 * std::sqrt(uniform(0.0, 1.0));
    const Eigen::Vector2d place_m(range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad));
    if (std::ranges::any_of(places_m, [&](const auto& other_m) { return (other_m - place_m).norm() < 3.0; })) continue;
    places_m.push_back(place_m);
    const double size_m = uniform(0.6, 2.0);
    AddBoat(walls, place_m.x(), place_m.y(), uniform(0.0, kPi), size_m, 0.6 * size_m, -kLidarAboveWaterM, -0.6 + 0.05 * range_m);
  }
  return walls;
}

segmenter::Scan MakeScan(int scene, int number) {
  auto scan = segmenter::test::EmptyScan({});
  segmenter::test::Look(scan, Things(scene == 1 ? 600 : 32), 0.02, kSeed + static_cast<std::uint64_t>(number));
  if (scene == 2) segmenter::test::AddRain(scan, 1750, kSeed + static_cast<std::uint64_t>(number));
  return scan;
}

tracker::Sweep SweepOf(const segmenter::Scan& scan, const segmenter::Segments& segments, Utime time) {
  tracker::Sweep sweep;
  for (const auto& ring : scan.head.rings) {
    sweep.elevation_rad.push_back(ring.elevation_rad);
    sweep.azimuth_offset_rad.push_back(ring.azimuth_offset_rad);
  }
  sweep.azimuth_rad = scan.columns.azimuth_rad;
  for (const auto time_ns : scan.columns.time_ns) sweep.time.push_back(time + std::chrono::microseconds(time_ns / 1000));
  for (const auto range : scan.columns.range) sweep.range_m.push_back(static_cast<float>(scan.head.range_unit_m * range));
  sweep.label = segments.label;
  return sweep;
}

// The lidar is the vessel's origin, which lies at the map's and looks north: x is north, y west.
tracker::Seen SeenOf(const segmenter::Segment& segment, Utime time) {
  tracker::Seen seen;
  seen.segment_id = segment.id;
  seen.time = time;
  seen.is_sure = segment.confidence == segmenter::Confidence::kSure;
  seen.is_land = segment.kind == segmenter::SegmentKind::kLand;
  seen.thing_probability = segment.thing_probability;
  seen.num_returns = segment.num_points;
  seen.position_m = {-segment.box_center_y_m, segment.box_center_x_m};
  seen.covariance_m2 = Eigen::Matrix2d::Identity();
  seen.covariance_relative_m2 = kNoiseM2 * Eigen::Matrix2d::Identity();
  seen.top_above_water_m = kLidarAboveWaterM + segment.max_z_m;
  for (const auto& corner : segment.hull) seen.outline_m.emplace_back(-corner.y_m, corner.x_m);
  return seen;
}

Pose StandingPose(Utime time) {
  Pose pose;
  pose.time = time;
  pose.datum = kDatum;
  pose.is_placed = true;
  pose.position_map_m.setZero();
  pose.velocity_map_mps.setZero();
  pose.heading_rad = pose.roll_rad = pose.pitch_rad = pose.heave_m = 0.0;
  pose.R_map_here.setIdentity();
  pose.covariance = kNoiseM2 * decltype(pose.covariance)::Identity();
  return pose;
}

tracker::TrackerParams MakeParams() {
  tracker::TrackerParams params;
  params.reference_point_above_water_m = kLidarAboveWaterM;
  params.max_range_m = 100.0;
  params.own_hull_m = {{-1.5, -0.7}, {1.5, -0.7}, {1.5, 0.7}, {-1.5, 0.7}};
  params.encounter = {.limit_m = 5.0, .look_ahead_s = 30.0};
  return params;
}

// Moves a scan to another time.
void SetTime(tracker::ScanInput& input, std::int64_t number) {
  const Utime time = segmenter::test::kScanTime + number * kScanPeriod;
  input.seq = number;
  input.datum = kDatum;
  input.time = time;
  input.end_time = time + kScanPeriod - std::chrono::milliseconds(1);
  input.own_at_start = StandingPose(input.time);
  input.own = StandingPose(input.end_time);
}

struct Bench {
  explicit Bench(int scene) {
    segmenter::Segmenter segmenter{segmenter::Params{}};
    for (int i = 0; i < kNumScans; ++i) {
      scans.push_back(MakeScan(scene, i));
      const auto& segments = segmenter.Segment(scans.back());
      tracker::ScanInput input;
      SetTime(input, i);
      for (const auto& segment : segments.segments) input.seen.push_back(SeenOf(segment, input.time));
      input.sweep = SweepOf(scans.back(), segments, input.time);
      inputs.push_back(std::move(input));
    }
  }

  std::vector<segmenter::Scan> scans;
  std::vector<tracker::ScanInput> inputs;
};

void Segmenting(benchmark::State& state) {
  const Bench bench(static_cast<int>(state.range(0)));
  segmenter::Segmenter segmenter{segmenter::Params{}};
  std::size_t number = 0;
  for (auto _ : state) benchmark::DoNotOptimize(segmenter.Segment(bench.scans[number++ % kNumScans]));
}

void Tracking(benchmark::State& state) {
  Bench bench(static_cast<int>(state.range(0)));
  tracker::Tracker tracker(MakeParams());
  std::int64_t number = 0;
  std::size_t num_seen = 0;
  std::size_t num_tracks = 0;
  const auto next = [&]() -> const tracker::ScanInput& {
    auto& input = bench.inputs[static_cast<std::size_t>(number % kNumScans)];
    SetTime(input, number++);
    num_seen += input.seen.size();
    return input;
  };
  for (int i = 0; i < 2 * kNumScans; ++i) tracker.Update(next());
  num_seen = 0;
  for (auto _ : state) num_tracks += tracker.Update(next()).tracks.size();
  state.counters["segments"] = benchmark::Counter(static_cast<double>(num_seen), benchmark::Counter::kAvgIterations);
  state.counters["tracks"] = benchmark::Counter(static_cast<double>(num_tracks), benchmark::Counter::kAvgIterations);
}

// Eight hours at 3 m/s past 20 to 30 things at a time, which stand 12 m from each other, a bank, and 50 tentative segments a scan.
void Hours(benchmark::State& state) {
  constexpr std::int64_t kScansAnHour = 36'000;
  constexpr double kSpeedMps = 3.0;
  constexpr double kApartM = 12.0;
  constexpr double kReachM = 35.0;
  std::mt19937_64 random(kSeed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  for (auto _ : state) {
    tracker::Tracker tracker(MakeParams());
    const auto before = mallinfo2().uordblks;
    double most_kb = 0.0;
    const auto kilobytes = [before] { return static_cast<double>(mallinfo2().uordblks - before) / 1e3; };
    for (std::int64_t number = 0; number < 8 * kScansAnHour; ++number) {
      tracker::ScanInput input;
      SetTime(input, number);
      const double north_m = kSpeedMps * 0.1 * static_cast<double>(number);
      for (auto* pose : {&input.own_at_start, &input.own}) {
        (*pose)->position_map_m.y() = north_m;
        (*pose)->velocity_map_mps.y() = kSpeedMps;
      }
      const auto add = [&](double east_m, double at_north_m, double size_m, bool is_sure) -> tracker::Seen& {
        auto& seen = input.seen.emplace_back();
        seen.segment_id = static_cast<std::int32_t>(input.seen.size());
        seen.time = input.time;
        seen.is_sure = is_sure;
        seen.thing_probability = is_sure ? 0.95 : 0.1;
        seen.num_returns = is_sure ? 12 : 1;
        seen.position_m = {east_m, at_north_m};
        seen.covariance_m2 = Eigen::Matrix2d::Identity();
        seen.covariance_relative_m2 = kNoiseM2 * Eigen::Matrix2d::Identity();
        seen.top_above_water_m = 1.0;
        const double half_m = size_m / 2.0;
        seen.outline_m = {{east_m - half_m, at_north_m - half_m},
                          {east_m + half_m, at_north_m - half_m},
                          {east_m + half_m, at_north_m + half_m},
                          {east_m - half_m, at_north_m + half_m}};
        return seen;
      };
      const auto first_row = static_cast<std::int64_t>(std::ceil((north_m - kReachM) / kApartM));
      for (auto row = first_row; kApartM * static_cast<double>(row) < north_m + kReachM; ++row) {
        for (int column = -2; column <= 2; ++column) {
          if (column != 0) add(kApartM * column + uniform(-0.03, 0.03), kApartM * static_cast<double>(row) + uniform(-0.03, 0.03), 1.0, true);
        }
      }
      for (int i = 0; i < 50; ++i) add(uniform(-20.0, 20.0), north_m + uniform(-20.0, 20.0), 0.05, false);
      auto& bank = add(72.0, north_m, 60.0, true);
      bank.is_land = true;
      for (double off_m = -30.0; off_m <= 30.0; off_m += 0.5)
        bank.waterline_m.emplace_back(40.0 + std::sin(0.1 * (north_m + off_m)), north_m + off_m);
      tracker.Update(input);
      if ((number + 1) % 100 == 0) most_kb = std::max(most_kb, kilobytes());
      if (number + 1 == kScansAnHour) state.counters["kb_after_1_h"] = kilobytes();
      if (number + 1 == 2 * kScansAnHour) state.counters["kb_after_2_h"] = kilobytes();
    }
    state.counters["kb_after_8_h"] = kilobytes();
    state.counters["kb_at_most"] = most_kb;
    for (const auto& counter : tracker.counters()) {
      if (counter.name.starts_with("restarts") && counter.count > 0) return state.SkipWithError("it began anew: it had nothing to remember");
      if (counter.name == "tracks" || counter.name == "land_tiles") state.counters[std::string(counter.name)] = static_cast<double>(counter.count);
    }
  }
}

BENCHMARK(Segmenting)->DenseRange(0, 2)->ArgName("scene")->Unit(benchmark::kMicrosecond);
BENCHMARK(Tracking)->DenseRange(0, 2)->ArgName("scene")->Unit(benchmark::kMicrosecond);
BENCHMARK(Hours)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
