// Distances for an autopilot behind the whole chain, against the outlines of all that a simulated scene holds, seen from the true place of the boat.
//   build/release/tests/property_plotter_distances   prints the figures; with LOOKOUT_DISTANCE_SECONDS, the length
// of a run, those of nine scenes, else of three for 8 s
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/config/boat.hpp"
#include "common/messages/pose_message.hpp"
#include "lab/sim/scene_file.hpp"
#include "lab/sim/simulation.hpp"
#include "services/plotter/params.hpp"
#include "services/plotter/surroundings.hpp"
#include "tests/support/files.hpp"
#include "tools/replay/chain.hpp"

namespace lookout {
namespace {

constexpr Utime kStart{std::chrono::seconds(1'781'532'600)};
constexpr double kSettleS = 3.0;
constexpr double kNothing = std::numeric_limits<double>::infinity();

double SecondsOfARun() {
  const char* text = std::getenv("LOOKOUT_DISTANCE_SECONDS");
  return text != nullptr ? std::atof(text) : 8.0;
}

std::vector<std::string> ScenesToRun() {
  if (std::getenv("LOOKOUT_DISTANCE_SECONDS") == nullptr) return {"lake", "islands", "turning"};
  return {"lake", "marina", "islands", "crossing", "shore_20m", "turning", "canal", "waves", "rain"};
}

struct Outline {
  std::vector<Eigen::Vector2d> corners_m;
  bool is_ground = false;  // a sloping beach: the lidar's beams meet it higher up, behind the edge of the water
};

bool IsGround(const sim::SceneObject& object) { return object.kind == "shore" || object.kind == "island" || object.kind == "coast"; }

// Everything from the true place of the boat: x forward, y to port.
std::vector<Outline> AroundTheBoat(const sim::Scene& scene, double reference_point_above_water_m, double time_s) {
  const auto own = sim::StateAt(scene.own_motion, reference_point_above_water_m, time_s);
  const Eigen::Vector2d bow(std::sin(own.heading_rad), std::cos(own.heading_rad));
  const Eigen::Vector2d port(-bow.y(), bow.x());
  std::vector<Outline> outlines_m;
  for (const auto& object : scene.objects) {
    const auto T_map_object = sim::PoseAt(object, scene.sea, time_s);
    auto& outline_m = outlines_m.emplace_back(Outline{{}, IsGround(object)});
    for (const auto& corner_m : object.outline_m) {
      const Eigen::Vector2d there_m = (T_map_object * Eigen::Vector3d(corner_m.x(), corner_m.y(), 0.0)).head<2>() - own.position_map_m.head<2>();
      outline_m.corners_m.emplace_back(there_m.dot(bow), there_m.dot(port));
    }
  }
  return outlines_m;
}

struct Truth {
  double range_m = kNothing;
  bool is_ground = false;
};

// Where a ray at a bearing meets the nearest outline.
Truth TruthAt(const std::vector<Outline>& outlines, double bearing_rad) {
  const Eigen::Vector2d direction(std::cos(bearing_rad), -std::sin(bearing_rad));
  Truth nearest;
  for (const auto& outline : outlines) {
    for (std::size_t i = 0; i < outline.corners_m.size(); ++i) {
      const Eigen::Vector2d& a_m = outline.corners_m[i];
      const Eigen::Vector2d edge_m = outline.corners_m[(i + 1) % outline.corners_m.size()] - a_m;
      const double turn = direction.x() * edge_m.y() - direction.y() * edge_m.x();
      if (std::abs(turn) < 1e-12) continue;
      const double range_m = (a_m.x() * edge_m.y() - a_m.y() * edge_m.x()) / turn;
      const double share = (a_m.x() * direction.y() - a_m.y() * direction.x()) / turn;
      if (range_m > 0.0 && range_m < nearest.range_m && share >= 0.0 && share <= 1.0) nearest = {range_m, outline.is_ground};
    }
  }
  return nearest;
}

Truth TruthOf(const std::vector<Outline>& outlines, std::size_t sector, double wider_deg) {
  const double half_deg = plotter::kSectorDeg / 2.0 + wider_deg;
  Truth nearest;
  for (double within_deg = -half_deg; within_deg <= half_deg; within_deg += 0.1) {
    const auto truth = TruthAt(outlines, DegToRad(static_cast<double>(sector) * plotter::kSectorDeg + within_deg));
    if (truth.range_m < nearest.range_m) nearest = truth;
  }
  return nearest;
}

// Sectors with a thing within reach, and how far from the truth they are; and those that are clear.
struct Figures {
  std::vector<double> farther_m;  // than the truth of the sector without half a degree at each side; below 0: nearer
  std::vector<double> nearer_m;   // than the truth of the sector with half a degree more at each side
  int num_clear_with_thing = 0;
  int num_unknown = 0;
  int num_unclear_water = 0;  // a distance where nothing is

  double ShareFarther(double most_m) const {
    const auto num = std::ranges::count_if(farther_m, [most_m](double one_m) { return one_m > most_m; });
    return static_cast<double>(num) / static_cast<double>(std::max<std::size_t>(farther_m.size(), 1));
  }
  double ShareWithin(double most_m) const {
    int num = 0;
    for (std::size_t i = 0; i < farther_m.size(); ++i) num += farther_m[i] <= most_m && nearer_m[i] <= most_m ? 1 : 0;
    return static_cast<double>(num) / static_cast<double>(std::max<std::size_t>(farther_m.size(), 1));
  }

  void Add(const plotter::Look& look, const std::vector<Outline>& outlines, bool is_ground) {
    for (std::size_t i = 0; i < plotter::kNumSectors; ++i) {
      const auto narrow = TruthOf(outlines, i, -0.5);
      const auto wide = TruthOf(outlines, i, 0.5);
      const double told_m = look.sectors.distance_m(i);
      num_unknown += told_m > look.reach_m && !look.is_looked[i] ? 1 : 0;
      num_unclear_water += told_m <= look.reach_m && wide.range_m == kNothing ? 1 : 0;
      if (narrow.range_m > look.reach_m - 1.0 || narrow.is_ground != is_ground) continue;
      num_clear_with_thing += told_m > look.reach_m ? 1 : 0;
      farther_m.push_back(std::min(told_m, look.reach_m) - narrow.range_m);
      nearer_m.push_back(wide.range_m - told_m);
    }
  }
  void Print(const std::string& scene, const char* of) const {
    std::printf(
        "%-12s %-7s %5zu sectors: within 0.1 m %5.1f %%, within 0.3 m %5.1f %%, farther by more than 0.3 m %5.2f %%, than 1 m %5.2f %%; "
        "%d without a distance; %d told where nothing is, %d unknown\n",
        scene.c_str(), of, farther_m.size(), 100.0 * ShareWithin(0.1), 100.0 * ShareWithin(0.3), 100.0 * ShareFarther(0.3), 100.0 * ShareFarther(1.0),
        num_clear_with_thing, num_unclear_water, num_unknown);
  }
};

struct OfARun {
  Figures things;
  Figures ground;
};

OfARun Simulate(const std::string& scene_name, std::uint64_t seed) {
  const support::TempDir folder;
  std::filesystem::copy(support::kDemoConfig, folder / "config");
  support::WriteFile(folder / "config/plotter.txtpb", "output { name: 'pilot' format: MAVLINK udp { address: '127.0.0.1' port: 14550 } }\n");
  const auto params = plotter::LoadParams(folder / "config");
  const auto boat = config::LoadBoat(support::kDemoConfig);
  const auto scene = sim::ParseScene(support::ReadFile(support::kSources / "config/scenes" / (scene_name + ".txtpb")), scene_name, seed);
  sim::SimulationParams simulated;
  simulated.start = kStart;
  simulated.duration = std::chrono::microseconds(std::llround(SecondsOfARun() * 1e6));
  simulated.seed = seed;
  sim::Simulation simulation(scene, boat, simulated, nullptr);
  plotter::Surroundings surroundings(params.surroundings.value());
  OfARun figures;
  std::int64_t pose_us = 0;
  const auto take = [&](Utime, std::string_view channel, Bytes bytes) {
    if (channel == bus::kLidarScan.name) surroundings.OnScan(0, bus::Decode<lidar_scan_t>(bytes).value());
    if (channel == bus::kSegments.name) surroundings.OnLabels(0, bus::Decode<segments_t>(bytes).value());
    if (channel == bus::kPose.name) {
      const auto message = bus::Decode<pose_t>(bytes).value();
      surroundings.OnPose(std::get<Pose>(messages::ToPose(message)));
      pose_us = message.utime_us;
    }
    if (channel != bus::kTracks.name) return;
    const auto tracks = bus::Decode<tracks_t>(bytes).value();
    ASSERT_EQ(tracks.num_parts, 1);
    const auto look = surroundings.LookAt({&tracks, 1});
    const double time_s = static_cast<double>(pose_us - ToUtimeUs(kStart)) * 1e-6;
    if (time_s < kSettleS) return;
    const auto outlines = AroundTheBoat(scene, boat.reference_point_above_water_m, time_s);
    figures.things.Add(look, outlines, false);
    figures.ground.Add(look, outlines, true);
  };
  replay::Chain chain(folder / "config", {}, take);
  while (const auto datagram = simulation.Next()) chain.OnDatagram({datagram->time, datagram->port, datagram->payload});
  chain.Finish();
  figures.things.Print(scene_name, "things");
  figures.ground.Print(scene_name, "ground");
  return figures;
}

// Things that the chain has not found yet, and what floats too low in waves, have no distance; the README has the figures of ten scenes.
TEST(PlotterDistances, AreSeldomFartherThanTheTruth) {
  for (const auto& scene : ScenesToRun()) {
    const auto figures = Simulate(scene, 17);
    EXPECT_GT(figures.things.farther_m.size(), 50U) << scene;
    EXPECT_LE(figures.things.ShareFarther(0.3), 0.06) << scene;
    EXPECT_GE(figures.things.ShareWithin(0.3), 0.8) << scene;
    EXPECT_LE(figures.ground.ShareFarther(1.0), 0.1) << scene;
  }
}

}  // namespace
}  // namespace lookout
