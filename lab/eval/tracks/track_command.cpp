#include "lab/eval/tracks/track_command.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "config/schema/tracker.pb.h"
#include "lab/eval/baselines/nearest_neighbour.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/eval/methods/leave_out.hpp"
#include "lab/eval/table.hpp"
#include "lab/eval/tracks/ablation.hpp"
#include "lab/eval/tracks/track_run.hpp"
#include "lab/eval/tracks/track_tables.hpp"
#include "lab/eval/tracks/track_targets.hpp"
#include "lab/sim/motion.hpp"
#include "lab/sim/scene_file.hpp"
#include "lab/sim/simulation.hpp"
#include "lookout/pose_t.hpp"
#include "services/tracker/params.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

// Least share of the returns of the chain's scans that are in the truth: with fewer the two do not belong together.
constexpr double kLeastJoined = 0.99;

ApproachLimits LimitsOf(const fs::path& config_folder) {
  const auto tracker = config::Load<config::Tracker>(config_folder, "tracker.txtpb");
  return {tracker.cpa_limit_m(), tracker.look_ahead_s()};
}

// Lays the relative frames of POSE on the earth: by the first pose of each whose way is known, and the true place then.
class FrameFinder {
 public:
  FrameFinder(const sim::OwnMotion& motion, const config::BoatFacts& boat) : motion_(motion), boat_(boat) {}

  void OnPose(const pose_t& pose) {
    if (pose.status != pose_t::STATUS_RELATIVE || placements_.contains(pose.datum_ellipsoid_height_m)) return;
    const auto own =
        sim::StateAt(motion_, boat_.reference_point_above_water_m, 1e-6 * static_cast<double>(pose.utime_us - ToUtimeUs(kSimulationStart)));
    MapPlacement map{{}, WrapTo2Pi(own.heading_rad - pose.heading_rad)};
    const double sin = std::sin(map.y_axis_rad);
    const double cos = std::cos(map.y_axis_rad);
    const auto& p_m = pose.position_map_m;
    sim::MapFrame(boat_).Reverse(own.position_map_m.x() - (cos * p_m[0] + sin * p_m[1]), own.position_map_m.y() - (-sin * p_m[0] + cos * p_m[1]), 0.0,
                                 map.origin[0], map.origin[1], map.origin[2]);
    placements_[pose.datum_ellipsoid_height_m] = map;
  }
  std::optional<MapPlacement> Find(double number) const {
    const auto found = placements_.find(number);
    return found == placements_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  sim::OwnMotion motion_;
  config::BoatFacts boat_;
  std::map<double, MapPlacement> placements_;  // by number of the frame
};

// One run: `feed` is called with the handler of its datagrams.
template <typename Feed>
std::vector<TrackRow> ScoreRun(const fs::path& config_folder, const std::string& scene, Truth& truth, const std::vector<Ablation>& ablations,
                               const CountReturns& count, const Feed& feed, FrameFinder* frames = nullptr) {
  const auto limits = LimitsOf(config_folder);
  std::optional<TrackRun> run;
  const auto check = [&scene](bool is_used, std::string_view channel) {
    if (!is_used) throw std::runtime_error(scene + ": a message on " + std::string(channel) + " cannot be used");
  };
  std::vector<std::string> names;
  std::vector<std::unique_ptr<AblatedTracker>> ablated;
  for (const auto& ablation : ablations) {
    names.push_back(ablation.name);
    ablated.push_back(std::make_unique<AblatedTracker>(
        tracker::LoadParams(config_folder), ablation.without,
        [&run, &check, name = ablation.name](Bytes bytes) { check(run->AddTracksOf(name, bytes), kTracksChannel); }));
  }
  replay::Chain chain(config_folder, {}, [&](Utime, std::string_view channel, Bytes bytes) {
    if (frames != nullptr && channel == bus::kPose.name) frames->OnPose(bus::Decode<pose_t>(bytes).value());
    check(run->Add(channel, bytes), channel);
    for (const auto& one : ablated) one->Add(channel, bytes);
  });
  const auto begin = [&] {
    io::ThrowIfStopAsked();
    // The truth knows its objects now.
    if (!run) run.emplace(truth, ablations.empty() ? MakeTrackers() : MultiObjectTrackers(), TrackRun::Returns::kForgotten, limits, names, count);
    if (frames != nullptr) run->SetFramePlacement([frames](double number) { return frames->Find(number); });
  };
  feed(
      [&](const replay::Datagram& datagram) {
        begin();
        chain.OnDatagram(datagram);
      },
      [&](Utime time, const std::vector<lidar_scan_t>& parts) {
        begin();
        for (const auto& part : parts) chain.OnLogged(time, bus::kLidarScan, bus::Encode(part));
      });
  if (!run) throw std::runtime_error(scene + ": no datagram");
  chain.Finish();
  for (const auto& one : ablated) one->Finish();
  run->Finish();
  if (run->num_scans() == 0) throw std::runtime_error(scene + ": no whole scan with a known position");
  if (!count && !(run->JoinedShare() >= kLeastJoined)) {
    throw std::runtime_error(
        fmt::format("{}: the truth is of another run: only {:.1f} % of the returns are in it", scene, 100.0 * run->JoinedShare()));
  }
  std::vector<TrackRow> rows;
  for (auto& row : run->Rows()) rows.push_back({scene, std::move(row)});
  return rows;
}

// Writes the events of one run.
void WriteEvents(const std::vector<TrackRow>& rows, std::uint64_t seed, const Truth& truth, std::ostream& out) {
  constexpr std::array<std::string_view, 6> kNames{"missed", "false", "switch", "moving", "standing", "approach"};
  for (const auto& [scene, row] : rows) {
    for (const auto& event : row.scores.events) {
      const auto name_of = [&truth](std::int64_t thing) { return thing == 0 ? std::string() : truth.objects().at(static_cast<int>(thing)).name; };
      const auto nearest = event.what == TrackEvent::What::kFalse ? name_of(event.nearest) : std::to_string(event.nearest);
      out << CsvRow({scene, std::to_string(seed), row.tracker, Number(event.utime_us), std::string(kNames.at(static_cast<std::size_t>(event.what))),
                     name_of(event.thing), std::to_string(event.num_returns), Number(event.track), Number(event.position_m.x(), 2),
                     Number(event.position_m.y(), 2), nearest, fmt::format("{:.2f}", event.nearest_gap_m), Number(event.speed_mps, 2)});
    }
  }
}

std::vector<Ablation> AblationsOf(const TrackOptions& options) { return options.has_ablation ? Ablations() : std::vector<Ablation>(); }

void AddTo(std::vector<TrackRow>& runs, std::vector<TrackRow> rows) {
  runs.insert(runs.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
}

// @param lidar  the head; empty: as the scenes say
std::vector<TrackRow> RunScenes(const TrackOptions& options, const std::string& lidar, std::ostream* events) {
  std::vector<TrackRow> runs;
  const auto ablations = AblationsOf(options);
  const LeaveOutEvidence evidence(options.weights_folder, options.left_out);
  std::optional<ConfigWithEvidence> with_evidence;
  std::string evidence_of;
  std::optional<ConfigWithoutLidarNmea> without_earth;
  if (options.is_without_earth) without_earth.emplace(options.config_folder);
  const auto boat = config::LoadBoat(options.config_folder);
  const int nmea_port = sim::ParamsOfConfig(options.config_folder).navigation.nmea_port;
  ForEachRunWithProgress(options, [&](const fs::path& file, const std::string& scene, std::uint64_t seed) {
    Truth truth(1);
    if (!options.left_out.empty() && evidence_of != scene) {
      with_evidence.emplace(options.config_folder, evidence.FileOf(scene));
      evidence_of = scene;
    }
    std::optional<FrameFinder> frames;
    if (options.is_without_earth) frames.emplace(sim::LoadScene(file, seed).own_motion, boat);
    const auto feed = [&](const DatagramHandler& on_datagram, const ScanMessageHandler& on_scan) {
      const auto without_sentences = [&](const replay::Datagram& datagram) {
        if (datagram.port != nmea_port) on_datagram(datagram);
      };
      SimulateRun(options.config_folder, file, seed, options.plan.seconds, truth,
                  options.is_without_earth ? DatagramHandler(without_sentences) : on_datagram, on_scan, lidar);
    };
    const auto& config_folder = with_evidence ? with_evidence->path() : without_earth ? without_earth->path() : options.config_folder;
    auto rows = ScoreRun(config_folder, lidar.empty() ? scene : lidar + ": " + scene, truth, ablations, nullptr, feed, frames ? &*frames : nullptr);
    if (events != nullptr) WriteEvents(rows, seed, truth, *events);
    AddTo(runs, std::move(rows));
  });
  return runs;
}

// "second_world_long" is the world "second world long".
std::string WorldOf(const fs::path& captures) {
  auto name = (captures.has_filename() ? captures : captures.parent_path()).filename().string();
  std::ranges::replace(name, '_', ' ');
  return name;
}

bool HasTruthOfReturns(const fs::path& captures) {
  return std::ranges::any_of(fs::directory_iterator(captures), [](const auto& entry) { return entry.path().string().ends_with(".truth.csv.xz"); });
}

// Where none lies beside the captures, the boat is that of the other captures.
std::vector<TrackRow> RunCaptures(const TrackOptions& options, const fs::path& folder, std::ostream* events) {
  const bool has_returns = HasTruthOfReturns(folder);
  const auto captures = ListCaptures(folder, has_returns ? CaptureTruth::kOfReturns : CaptureTruth::kOfObjects);
  if (captures.empty()) throw std::runtime_error(folder.string() + ": holds no capture (NAME-SEED.pcap.xz)");
  const auto has_boat = [](const fs::path& one) { return fs::exists(one / "boat.txtpb"); };
  const auto with_boat = std::ranges::find_if(options.captures, has_boat);
  const ConfigOfCaptures config(has_boat(folder) || with_boat == options.captures.end() ? folder : *with_boat, options.config_folder);
  const auto boat = config::LoadBoat(config.path());
  std::vector<TrackRow> runs;
  for (const auto& files : captures) {
    std::cerr << fmt::format("lookout-eval: {}\n", files.capture.filename().string());
    Truth truth(kCaptureToleranceUs);
    const auto read = has_returns ? ReadRun : ReadRunOfObjects;
    auto rows = ScoreRun(config.path(), WorldOf(folder) + ": " + files.scene, truth, AblationsOf(options),
                         has_returns ? CountReturns() : ReadReturnCounts(files),
                         [&](const DatagramHandler& on_datagram, const ScanMessageHandler& /*on_scan*/) { read(files, boat, truth, on_datagram); });
    if (events != nullptr) WriteEvents(rows, files.seed, truth, *events);
    AddTo(runs, std::move(rows));
  }
  return runs;
}

// Targets first, then the scenes, and behind the scenes of a world one row over all of them.
std::vector<NamedTable> AllTablesOf(const TrackOptions& options, const std::vector<TrackWorld>& worlds) {
  std::vector<TrackRow> rows;
  std::vector<TrackRow> overall;
  for (const auto& world : worlds) AddTo(overall, OverAll(world.scenes, world.name));
  if (options.has_ablation) return {AblationTable(overall)};
  for (const auto& world : worlds) {
    AddTo(rows, world.scenes);
    AddTo(rows, OverAll(world.scenes, world.over_all));
  }
  if (!options.left_out.empty()) return {LeftOutTable(rows)};
  std::vector<NamedTable> tables{TargetTable(worlds, "lookout", "nearest neighbour")};
  for (auto& table : TablesOf(rows)) tables.push_back(std::move(table));
  return tables;
}

std::string ScopeOf(const TrackOptions& options, bool has_captures) {
  const auto& plan = options.plan;
  return fmt::format("Own simulator: {} scenes, {} seeds each from {} on, {:.0f} s a seed. The second world: {}.", plan.scenes.size(), plan.num_seeds,
                     plan.first_seed, plan.seconds, has_captures ? "all of its captures" : "not here");
}

}  // namespace

MultiObjectTrackers MakeTrackers() {
  MultiObjectTrackers trackers;
  trackers.push_back(std::make_unique<NearestNeighbour>());
  return trackers;
}

int EvaluateTracks(const TrackOptions& options) {
  BeginRuns(options, !options.captures.empty(), "--tracks");
  // Outputs before all work.
  TableFiles files(options.csv_folder, AllTablesOf(options, {}), options.is_forced);
  std::optional<io::OutputFile> lost;
  if (!options.lost_file.empty()) {
    lost.emplace(options.lost_file, io::OutputOptions{.force = options.is_forced});
    lost->Write("scene,seed,tracker,utime_us,event,thing,num_returns,track_id,east_m,north_m,nearest,gap_m,speed_mps\n");
  }
  std::ostream* const events = lost ? &lost->stream() : nullptr;
  std::vector<TrackWorld> worlds;
  const auto add_world = [&worlds](const std::string& name, const std::vector<TrackRow>& runs, const std::string& over_all) {
    if (!runs.empty()) worlds.push_back({name, AddUp(runs), over_all});
  };
  if (options.plan.lidars.empty()) add_world("own scenes", RunScenes(options, "", events), "all scenes");
  for (const auto& lidar : options.plan.lidars) add_world(lidar, RunScenes(options, lidar, events), lidar + ": all scenes");
  bool has_captures = false;
  for (const auto& folder : options.captures) {
    if (!fs::exists(folder)) {
      std::cerr << "lookout-eval: " << folder.string() << " is not here\n";
      continue;
    }
    has_captures = true;
    add_world(WorldOf(folder), RunCaptures(options, folder, events), WorldOf(folder) + ": all");
  }
  if (lost) lost->Commit();
  const auto tables = AllTablesOf(options, worlds);
  PrintTables(tables, std::cout);
  files.Commit(tables);
  if (!options.block_files.empty()) FillBlocksOf(options.block_files, FiguresOf(tables, ScopeOf(options, has_captures)));
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
