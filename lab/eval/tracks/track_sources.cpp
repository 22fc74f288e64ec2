#include "lab/eval/tracks/track_sources.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <google/protobuf/text_format.h>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "config/schema/navigator.pb.h"
#include "config/schema/segmenter.pb.h"
#include "lab/data/csv_file.hpp"
#include "lab/data/scan_message.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/sim/head_simulation.hpp"
#include "lab/sim/scene_file.hpp"
#include "lab/sim/simulation.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kOutlinePeriodUs = 100'000;

std::vector<Geodetic> OnEarth(const GeographicLib::LocalCartesian& map, const Polygon& outline_m) {
  std::vector<Geodetic> outline;
  for (const auto& p_m : outline_m) {
    Geodetic place{};
    double height_m = 0.0;
    map.Reverse(p_m.x(), p_m.y(), 0.0, place.latitude_deg, place.longitude_deg, height_m);
    outline.push_back(place);
  }
  return outline;
}

Polygon OutlineAt(const Eigen::Vector2d& position_m, double heading_rad, const Polygon& outline_m) {
  const sim::Placement placement{position_m, heading_rad};
  Polygon placed_m;
  for (const auto& p_m : outline_m) placed_m.push_back(placement.ToMap(p_m));
  return placed_m;
}

// From one period before the run to one behind it, so that velocities have both sides.
void AddOutlines(const sim::Scene& scene, const config::BoatFacts& boat, double seconds, Truth& truth) {
  const auto map = sim::MapFrame(boat);
  truth.AddObject(sim::kOwnVessel, {"own_vessel", "own_vessel", true, true});
  truth.AddObject(sim::kNoObject, {"none", "none", false, false});
  for (const auto& object : scene.objects) {
    truth.AddObject(object.id, {object.name, object.kind, object.track.is_moving(), object.is_in_water});
    if (object.track.is_moving()) continue;
    const auto place = object.track.At(0.0);
    truth.AddOutline(object.id, ToUtimeUs(kSimulationStart), OnEarth(map, OutlineAt(place.position_map_m, place.heading_rad, object.outline_m)));
  }
  const auto num_periods = static_cast<int>(std::ceil(seconds * 1e6 / static_cast<double>(kOutlinePeriodUs)));
  for (int i = 0; i <= num_periods + 1; ++i) {
    const double time_s = 1e-6 * static_cast<double>(i * kOutlinePeriodUs);
    const std::int64_t utime_us = ToUtimeUs(kSimulationStart) + i * kOutlinePeriodUs;
    const auto own = sim::StateAt(scene.own_motion, boat.reference_point_above_water_m, time_s);
    truth.AddOutline(sim::kOwnVessel, utime_us, OnEarth(map, OutlineAt(own.position_map_m.head<2>(), own.heading_rad, OwnHullOf(boat))));
    for (const auto& object : scene.objects) {
      if (!object.track.is_moving()) continue;
      const auto place = object.track.At(time_s);
      truth.AddOutline(object.id, utime_us, OnEarth(map, OutlineAt(place.position_map_m, place.heading_rad, object.outline_m)));
    }
  }
}

constexpr auto kMaxTime = std::numeric_limits<std::int64_t>::max();
constexpr auto kMaxId = std::numeric_limits<int>::max();

fs::path Beside(const CaptureWithTruth& files, const std::string& ending) {
  return files.capture.parent_path() / (files.scene + "-" + std::to_string(files.seed) + ending);
}

// Outlines of objects that are no rectangles; these objects stand.
std::map<int, Polygon> ReadShapes(const fs::path& file) {
  std::map<int, Polygon> shapes;
  data::CsvFile csv(file, {"object_id", "east", "north"});
  while (csv.Next()) shapes[static_cast<int>(csv.WholeNumber(0, 1, kMaxId))].emplace_back(csv.Number(1), csv.Number(2));
  return shapes;
}

GeographicLib::LocalCartesian MapAt(double latitude_deg, double longitude_deg) { return {latitude_deg, longitude_deg, 0.0}; }

// Rows are by scan: earlier rows of an object stand behind it.
struct LastRow {
  std::int64_t utime_us = 0;
  std::vector<Geodetic> outline;
  std::vector<Geodetic> before;
};

std::vector<Geodetic> Extrapolated(const std::vector<Geodetic>& from, const std::vector<Geodetic>& to) {
  std::vector<Geodetic> further;
  for (std::size_t i = 0; i < to.size(); ++i) {
    further.push_back({2.0 * to[i].latitude_deg - from[i].latitude_deg, 2.0 * to[i].longitude_deg - from[i].longitude_deg});
  }
  return further;
}

// Shapes have their places at the same origin as the objects' east and north.
void ReadObjectRows(const CaptureWithTruth& files, Truth& truth) {
  constexpr double kMovingMps = 0.01;
  const auto shapes = ReadShapes(Beside(files, ".shapes.csv.xz"));
  const auto known = ReadObjectsOfCapture(files);
  data::CsvFile csv(files.objects, {"utime_us", "object_id", "lat", "lon", "east", "north", "heading_deg", "speed_mps", "length", "width"});
  std::map<int, LastRow> last;
  while (csv.Next()) {
    const auto utime_us = csv.WholeNumber(0, 0, kMaxTime);
    const auto id = static_cast<int>(csv.WholeNumber(1, 1, kMaxId));
    const auto& object = known.at(id);
    const bool is_moving = csv.Number(7) > kMovingMps || (truth.objects().contains(id) && truth.objects().at(id).is_moving);
    truth.AddObject(id, {object.name, object.kind, is_moving, object.is_in_water});
    const auto here = MapAt(csv.Number(2), csv.Number(3));
    Polygon outline_m;
    if (const auto shape = shapes.find(id); shape != shapes.end()) {
      for (const auto& p_m : shape->second) outline_m.push_back(p_m - Eigen::Vector2d(csv.Number(4), csv.Number(5)));
    } else {
      const double half_length_m = csv.Number(8) / 2.0;
      const double half_width_m = csv.Number(9) / 2.0;
      outline_m =
          OutlineAt(Eigen::Vector2d::Zero(), DegToRad(csv.Number(6)), sim::Rectangle(-half_length_m, half_length_m, -half_width_m, half_width_m));
    }
    auto outline = OnEarth(here, outline_m);
    truth.AddOutline(id, utime_us, outline);
    auto& row = last[id];
    if (row.utime_us != 0 && !row.outline.empty() && row.before.empty()) {
      truth.AddOutline(id, 2 * row.utime_us - utime_us, Extrapolated(outline, row.outline));  // one before the first
    }
    row.before = std::move(row.outline);
    row.outline = std::move(outline);
    row.utime_us = utime_us;
  }
  for (const auto& [id, row] : last) {
    if (!row.before.empty()) truth.AddOutline(id, row.utime_us + kOutlinePeriodUs, Extrapolated(row.before, row.outline));
  }
}

void ReadOwnRows(const CaptureWithTruth& files, const config::BoatFacts& boat, Truth& truth) {
  truth.AddObject(data::kOwnVesselObject, {"own_vessel", "own_vessel", true, true});
  truth.AddObject(data::kNoTrueObject, {"none", "none", false, false});
  data::CsvFile csv(Beside(files, ".ego.csv.xz"), {"utime_us", "lat", "lon", "heading_deg"});
  while (csv.Next()) {
    const auto map = MapAt(csv.Number(1), csv.Number(2));
    truth.AddOutline(data::kOwnVesselObject, csv.WholeNumber(0, 0, kMaxTime),
                     OnEarth(map, OutlineAt(Eigen::Vector2d::Zero(), DegToRad(csv.Number(3)), OwnHullOf(boat))));
  }
}

void ReadReturnRows(const CaptureWithTruth& files, Truth& truth) {
  constexpr int kMaxRing = 127;
  data::CsvFile csv(files.truth, {"utime_us", "ring", "return_index", "object_id"});
  std::vector<Truth::Return> returns;
  while (csv.Next()) {
    returns.push_back({csv.WholeNumber(0, 0, kMaxTime), static_cast<int>(csv.WholeNumber(1, 0, kMaxRing)), static_cast<int>(csv.WholeNumber(2, 0, 1)),
                       static_cast<int>(csv.WholeNumber(3, data::kOwnVesselObject, kMaxId)),
                       Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())});
  }
  truth.AddReturns(std::move(returns));
}

// Writes a file of a config anew.
template <typename Message>
void WriteConfig(const fs::path& file, const Message& message) {
  std::string text;
  google::protobuf::TextFormat::PrintToString(message, &text);
  io::OutputFile out(file, io::OutputOptions{.force = true});
  out.Write(text);
  out.Commit();
}

}  // namespace

void BeginRuns(const RunOptions& options, bool has_captures, const std::string& option) {
  if (!options.plan.scenes.empty()) options.plan.CheckSeeds(options.is_tuning ? SeedUse::kTuning : SeedUse::kTables);
  if (options.is_tuning && !(options.csv_folder.empty() && options.block_files.empty())) {
    throw std::invalid_argument("--tuning: no table is written of seeds of tuning: leave out --csv and --blocks");
  }
  if (options.plan.scenes.empty() && !has_captures) throw std::invalid_argument(option + " needs --scenes or --captures");
  replay::CheckConfig(options.config_folder);
  io::CatchStopSignals();
  FillBlocksOf(options.block_files, {});
}

void ForEachRun(const RunOptions& options, const RunHandler& handle) {
  for (const auto& name : options.plan.scenes) {
    const auto file = sim::FindScene(name, options.config_folder);
    const auto scene = SceneLabel(name);
    for (int k = 0; k < options.plan.num_seeds; ++k) handle(file, scene, options.plan.first_seed + static_cast<std::uint64_t>(k));
  }
}

void ForEachRunWithProgress(const RunOptions& options, const RunHandler& handle) {
  runtime::Progress progress("lookout-eval", stderr);
  const auto num_runs = static_cast<double>(options.plan.scenes.size()) * options.plan.num_seeds;
  double num_done = 0.0;
  ForEachRun(options, [&](const fs::path& file, const std::string& scene, std::uint64_t seed) {
    io::ThrowIfStopAsked();
    progress.Update(num_done++ / num_runs, [&] { return fmt::format("{}, seed {}", scene, seed); });
    handle(file, scene, seed);
  });
}

Polygon OwnHullOf(const config::BoatFacts& boat) {
  const auto center_m = boat.own_vessel_box_m.center();
  Eigen::Vector2d half_m = boat.own_vessel_box_m.sizes().head<2>() / 2.0;
  if (boat.hull_m) half_m = half_m.cwiseMin(Eigen::Vector2d(boat.hull_m->length_m, boat.hull_m->beam_m) / 2.0);
  return sim::Rectangle(center_m.x() - half_m.x(), center_m.x() + half_m.x(), center_m.y() - half_m.y(), center_m.y() + half_m.y());
}

void AddSceneTruth(const fs::path& config_folder, const fs::path& scene_file, std::uint64_t seed, double seconds, Truth& truth) {
  AddOutlines(sim::LoadScene(scene_file, seed), config::LoadBoat(config_folder), seconds, truth);
}

void SimulateRun(const fs::path& config_folder, const fs::path& scene_file, std::uint64_t seed, double seconds, Truth& truth,
                 const DatagramHandler& on_datagram, const ScanMessageHandler& on_scan, const std::string& lidar) {
  const auto boat = config::LoadBoat(config_folder);
  auto scene = sim::LoadScene(scene_file, seed);
  if (!lidar.empty()) scene.lidar = lidar;
  AddOutlines(scene, boat, seconds, truth);
  auto params = sim::ParamsOfConfig(config_folder);
  params.start = kSimulationStart;
  params.duration = std::chrono::microseconds(std::llround(seconds * 1e6));
  params.seed = seed;
  const auto add_returns = [&truth](const std::vector<sim::TrueReturn>& of_lidar) {
    std::vector<Truth::Return> returns;
    returns.reserve(of_lidar.size());
    for (const auto& made : of_lidar) {
      returns.push_back({ToUtimeUs(made.time), made.ring, made.return_index, made.object_id, made.p_lidar_m.cast<float>()});
    }
    truth.AddReturns(std::move(returns));
  };
  const auto send = [&on_datagram](const sim::Datagram& datagram) { on_datagram({datagram.time, datagram.port, datagram.payload}); };
  if (const auto* head = sim::FindHead(scene.lidar)) {
    if (!on_scan) throw std::invalid_argument(scene_file.string() + ": the packets of " + scene.lidar + " are not simulated");
    sim::HeadSimulation simulation(scene, boat, *head, params, nullptr);
    while (const auto event = simulation.Next()) {
      if (const auto* datagram = std::get_if<sim::Datagram>(&event->heard)) {
        send(*datagram);
        continue;
      }
      const auto& made = std::get<sim::HeadScan>(event->heard);
      add_returns(made.returns);
      on_scan(event->time, data::ToScanMessages(made.scan, std::string(head->model), bus::kMaxMessageBytes));
    }
    return;
  }
  if (scene.lidar == sim::kHiResName) params.lidar.model = vlp16::Model::kPuckHiRes;
  params.on_packet = [&add_returns](const sim::LidarPacket& packet) { add_returns(packet.returns); };
  sim::Simulation simulation(scene, boat, params, nullptr);
  while (const auto datagram = simulation.Next()) send(*datagram);
}

void SendCapture(const CaptureWithTruth& files, const DatagramHandler& on_datagram) {
  const UnpackedCapture unpacked(files.capture);
  lidar::CaptureReader reader(unpacked.path());
  while (const auto datagram = reader.Next()) {
    on_datagram({datagram->host_time, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port}});
  }
  if (reader.num_damaged() > 0) throw std::runtime_error(files.capture.string() + ": damaged: " + reader.damage());
}

void ReadRun(const CaptureWithTruth& files, const config::BoatFacts& boat, Truth& truth, const DatagramHandler& on_datagram) {
  ReadOwnRows(files, boat, truth);
  ReadObjectRows(files, truth);
  ReadReturnRows(files, truth);
  SendCapture(files, on_datagram);
}

void ReadRunOfObjects(const CaptureWithTruth& files, const config::BoatFacts& boat, Truth& truth, const DatagramHandler& on_datagram) {
  ReadOwnRows(files, boat, truth);
  ReadObjectRows(files, truth);
  SendCapture(files, on_datagram);
}

CountReturns ReadReturnCounts(const CaptureWithTruth& files) {
  constexpr std::int64_t kWithinUs = 60'000;  // of the middle of a scan, which its rows have
  std::map<std::int64_t, std::map<int, int>> counts;
  data::CsvFile csv(files.objects, {"utime_us", "object_id", "returns"});
  while (csv.Next()) {
    counts[csv.WholeNumber(0, 0, kMaxTime)][static_cast<int>(csv.WholeNumber(1, 1, kMaxId))] = static_cast<int>(csv.WholeNumber(2, 0, kMaxId));
  }
  return [counts = std::move(counts)](const TruthSpan& scan) -> std::map<int, int> {
    const std::int64_t middle_us = scan.begin_us + (scan.end_us - scan.begin_us) / 2;
    const auto next = counts.lower_bound(middle_us - kWithinUs);
    return next != counts.end() && next->first <= middle_us + kWithinUs ? next->second : std::map<int, int>{};
  };
}

TempFolder::TempFolder() {
  auto place = (fs::temp_directory_path() / "lookout_eval_XXXXXX").string();
  if (mkdtemp(place.data()) == nullptr) throw std::runtime_error("no temporary folder " + place);
  path_ = place;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

ConfigOfCaptures::ConfigOfCaptures(const fs::path& captures, const fs::path& config_folder) {
  fs::copy(config_folder, path(), fs::copy_options::recursive);
  if (fs::exists(captures / "boat.txtpb")) fs::copy_file(captures / "boat.txtpb", path() / "boat.txtpb", fs::copy_options::overwrite_existing);
}

ConfigWithoutLidarNmea::ConfigWithoutLidarNmea(const fs::path& config_folder) {
  fs::copy(config_folder, path(), fs::copy_options::recursive);
  const auto file = path() / "navigator.txtpb";
  config::Navigator message;
  config::LoadText(file, message);
  message.set_use_lidar_nmea(false);
  WriteConfig(file, message);
}

ConfigWithEvidence::ConfigWithEvidence(const fs::path& config_folder, const fs::path& evidence_file) {
  fs::copy(config_folder, path(), fs::copy_options::recursive);
  const auto file = path() / "segmenter.txtpb";
  config::Segmenter message;
  config::LoadText(file, message);
  message.set_evidence(fs::absolute(evidence_file));
  WriteConfig(file, message);
}

}  // namespace lookout::eval
