#include "lab/eval/tracks/track_autoferry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/assignment.hpp"
#include "common/core/log_time.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/eval/tracks/track_command.hpp"
#include "lab/eval/tracks/track_run.hpp"
#include "lab/eval/tracks/track_sources.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSwitchRange = 2;
static_assert(kFerryRangesM.at(kSwitchRange) == kSwitchRangeM);

using Places = std::map<int, Eigen::Vector2d>;  // by target

Places TruthAt(const importer::FerryTruth& truth, std::int64_t utime_us) {
  // Clocks of receivers and lidar tick apart: 0.6 s is the longest step of the truth.
  constexpr std::int64_t kMarginUs = 600'000;
  Places places;
  for (const auto& [target, by_time] : truth) {
    if (utime_us < by_time.begin()->first - kMarginUs || utime_us > by_time.rbegin()->first + kMarginUs) continue;
    const auto after = by_time.lower_bound(utime_us);
    if (after == by_time.begin() || after == by_time.end()) {
      places[target] = after == by_time.end() ? by_time.rbegin()->second : after->second;
      continue;
    }
    const auto before = std::prev(after);
    const double share = static_cast<double>(utime_us - before->first) / static_cast<double>(after->first - before->first);
    places[target] = (1.0 - share) * before->second + share * after->second;
  }
  return places;
}

// Assignment by centres, scan after scan.
class FerryIdentities {
 public:
  std::int64_t CountSwitches(const Places& truths_m, const std::vector<const TrackState*>& tracks) {
    std::map<int, std::int64_t> now;
    std::set<std::int64_t> taken;
    for (const auto& [target, place_m] : truths_m) {
      const auto before = last_.find(target);
      if (before == last_.end()) continue;
      const auto track = std::ranges::find(tracks, before->second, [](const TrackState* one) { return one->id; });
      if (track == tracks.end() || ((*track)->position_m - place_m).norm() > kGospaCutOffM) continue;
      now[target] = before->second;
      taken.insert(before->second);
    }
    std::vector<int> targets;
    for (const auto& [target, place_m] : truths_m) {
      if (!now.contains(target)) targets.push_back(target);
    }
    std::vector<const TrackState*> free;
    std::ranges::copy_if(tracks, std::back_inserter(free), [&](const TrackState* one) { return !taken.contains(one->id); });
    Eigen::MatrixXd cost(static_cast<Eigen::Index>(targets.size()), static_cast<Eigen::Index>(free.size()));
    for (std::size_t i = 0; i < targets.size(); ++i) {
      for (std::size_t k = 0; k < free.size(); ++k) {
        const double squared_m2 = (truths_m.at(targets[i]) - free[k]->position_m).squaredNorm();
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = std::min(squared_m2, kGospaCutOffM * kGospaCutOffM);
      }
    }
    const auto assigned = CheapestAssignment(cost);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (assigned[i] < 0 || cost(static_cast<Eigen::Index>(i), assigned[i]) >= kGospaCutOffM * kGospaCutOffM) continue;
      now[targets[i]] = free[static_cast<std::size_t>(assigned[i])]->id;
    }
    std::int64_t num_switches = 0;
    for (const auto& [target, track] : now) {
      const auto [before, is_first] = last_.try_emplace(target, track);
      if (!is_first && before->second != track) ++num_switches;
      before->second = track;
    }
    return num_switches;
  }

 private:
  std::map<int, std::int64_t> last_;  // target, track
};

// The boat's tracker on OBSTACLES and POSE alone, as lookout-replay --from OBSTACLES runs it.
std::optional<FerryTracks> OwnTracks(const fs::path& config_folder, const std::vector<importer::FerryScan>& scans) {
  constexpr std::string_view kTracker = "tracker";
  const bool is_there = std::ranges::any_of(replay::StageFactories(), [&](const auto& factory) { return factory.service == kTracker; });
  if (!is_there) return std::nullopt;
  std::map<std::int64_t, std::vector<TrackState>> tracks;  // by time of the scan
  replay::Plan plan;
  plan.services = {std::string(kTracker)};
  plan.read = {std::string(bus::kPose.name), std::string(bus::kObstacles.name)};
  replay::Chain chain(config_folder, plan, [&](Utime, std::string_view channel, Bytes bytes) {
    if (channel != kTracksChannel) return;
    const auto message = bus::Decode<tracks_t>(bytes);
    if (!message) throw std::runtime_error("a message on TRACKS cannot be decoded");
    auto& of_scan = tracks[message->utime_us];
    for (const auto& track : message->tracks) of_scan.push_back(ToTrackState(track));
  });
  const auto feed = [&](const bus::Channel& channel, const auto& message) {
    chain.OnLogged(Utime(std::chrono::microseconds(message.utime_us)), channel, bus::Encode(message));
  };
  const auto poses = importer::ToPoses(scans);
  auto pose = poses.begin();
  for (const auto& obstacles : importer::ToObstacles(scans)) {
    for (; pose != poses.end() && pose->utime_us <= obstacles.utime_us; ++pose) feed(bus::kPose, *pose);
    feed(bus::kObstacles, obstacles);
  }
  for (; pose != poses.end(); ++pose) feed(bus::kPose, *pose);
  chain.FinishLogs(true);
  FerryTracks own{"lookout", {}};
  for (const auto& scan : scans) own.tracks.push_back(tracks[scan.utime_us]);
  return own;
}

struct Scenario {
  int number = 0;
  fs::path scans;
  fs::path truth;
};

std::vector<Scenario> ListScenarios(const fs::path& folder) {
  static const std::regex kName(R"(scenario(\d{1,4})_lidar_detections\.json)");
  std::vector<Scenario> scenarios;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto name = entry.path().filename().string();
    std::smatch parts;
    if (!std::regex_match(name, parts, kName)) continue;
    scenarios.push_back({std::stoi(parts[1]), entry.path(), folder / ("scenario" + parts[1].str() + "_ground_truth.json")});
  }
  if (scenarios.empty()) throw std::runtime_error(folder.string() + ": holds no scenarioN_lidar_detections.json");
  std::ranges::sort(scenarios, {}, &Scenario::number);
  return scenarios;
}

Table::Row RowOf(const std::string& scenario, const std::string& tracker, std::size_t num_scans, const FerryScores& scores) {
  Table::Row row{scenario, tracker, Number(static_cast<std::int64_t>(num_scans))};
  for (const auto& gospa : scores.gospa) row.push_back(Number(gospa.Rms(), 1));
  for (std::size_t i = 0; i < kSwitchRange + 1; ++i) row.push_back(Number(scores.with_boat.at(i).Rms(), 1));
  const auto& near = scores.with_boat.at(kSwitchRange);
  for (const double part_m : {near.LocalisationRms(), near.MissedRms(), near.FalseRms()}) row.push_back(Number(part_m, 1));
  row.push_back(Number(scores.num_switches));
  return row;
}

// Targets of the boat's tracker, over all scans: below the best of a multi-hypothesis tracker (VIMMJIPDA) and of a plain one with existence and
// optimal assignment, both with settings of their own for these data and on more scenarios of the same kind.
struct FerryTarget {
  std::string_view group;
  std::size_t range;  // of kFerryRangesM
  double below_m;
};
constexpr std::array<FerryTarget, 6> kFerryTargets{
    {{"open water", 0, 7.4}, {"open water", 1, 8.6}, {"open water", 2, 10.7}, {"channel", 0, 3.2}, {"channel", 1, 4.6}, {"channel", 2, 9.0}}};
constexpr std::int64_t kMostFerrySwitches = 1;

// Facts of the boat for its tracker: milliAmpere is 5 m long and 2.8 m wide; where its lidar is does not matter to detections. All else is as the
// schemas have it.
class FerryConfig {
 public:
  FerryConfig() {
    Write("boat.txtpb",
          "name: \"ferry\"\nlidar { x_m: 0 y_m: 0 z_m: 2 roll_deg: 0 pitch_deg: 0 yaw_deg: 0 }\ngnss_antenna { x_m: 0 y_m: 0 z_m: 2 }\n"
          "reference_point_above_water_m: 0.5\nhull_length_m: 5\nhull_beam_m: 2.8\n"
          "own_vessel { min_x_m: -2.5 max_x_m: 2.5 min_y_m: -1.4 max_y_m: 1.4 min_z_m: -1 max_z_m: 3 }\n");
    for (const auto* defaults : {"segmenter.txtpb", "tracker.txtpb"}) Write(defaults, "# defaults\n");
  }
  const fs::path& path() const { return folder_.path(); }

 private:
  void Write(const char* name, std::string_view text) const {
    io::OutputFile file(folder_.path() / name);
    file.Write(text);
    file.Commit();
  }

  TempFolder folder_;
};

}  // namespace

FerryScores::FerryScores() {
  for (auto& one : gospa) one.num_scans = 0;
  for (auto& one : with_boat) one.num_scans = 0;
}

void FerryScores::Add(const FerryScores& other) {
  for (std::size_t i = 0; i < gospa.size(); ++i) gospa.at(i).Add(other.gospa.at(i));
  for (std::size_t i = 0; i < with_boat.size(); ++i) with_boat.at(i).Add(other.with_boat.at(i));
  num_switches += other.num_switches;
}

FerryScores ScoreFerry(const std::vector<importer::FerryScan>& scans, const importer::FerryTruth& truth,
                       const std::vector<std::vector<TrackState>>& tracks) {
  FerryScores scores;
  FerryIdentities identities;
  for (std::size_t n = 0; n < scans.size(); ++n) {
    const auto is_within = [&](const Eigen::Vector2d& place_m, double range_m) { return (place_m - scans[n].own_m).norm() <= range_m; };
    const auto places_m = TruthAt(truth, scans[n].utime_us);
    for (std::size_t i = 0; i < kFerryRangesM.size(); ++i) {
      std::vector<Eigen::Vector2d> truths_m;
      std::vector<Eigen::Vector2d> estimates_m;
      for (const auto& [target, place_m] : places_m) {
        if (is_within(place_m, kFerryRangesM.at(i))) truths_m.push_back(place_m);
      }
      for (const auto& track : tracks[n]) {
        if (track.IsReported() && is_within(track.position_m, kFerryRangesM.at(i))) estimates_m.push_back(track.position_m);
      }
      const auto gospa = GospaOf(truths_m, estimates_m);
      scores.gospa.at(i).Add(gospa);
      if (!truths_m.empty()) scores.with_boat.at(i).Add(gospa);
    }
    Places near_m;
    for (const auto& [target, place_m] : places_m) {
      if (is_within(place_m, kFerryRangesM.at(kSwitchRange))) near_m[target] = place_m;
    }
    std::vector<const TrackState*> reported;
    for (const auto& track : tracks[n]) {
      if (track.IsReported()) reported.push_back(&track);
    }
    scores.num_switches += identities.CountSwitches(near_m, reported);
  }
  return scores;
}

std::vector<FerryTracks> TrackFerry(const fs::path& config_folder, const std::vector<importer::FerryScan>& scans,
                                    const MultiObjectTrackers& trackers) {
  std::vector<FerryTracks> result;
  if (auto own = OwnTracks(config_folder, scans)) result.push_back(*std::move(own));
  const auto obstacles = importer::ToObstacles(scans);
  for (const auto& tracker : trackers) {
    FerryTracks said{tracker->name(), {}};
    for (const auto& message : obstacles) {
      messages::ScanMessages scan;
      scan.utime_us = message.utime_us;
      scan.seq = message.seq;
      scan.obstacles[0] = message;
      said.tracks.push_back(tracker->Update(scan));
    }
    result.push_back(std::move(said));
  }
  return result;
}

int EvaluateAutoferry(const FerryOptions& options) {
  constexpr int kLastInOpenWater = 9;
  io::CatchStopSignals();
  FillBlocksOf(options.block_files, {});  // a block that is wrong stops the run before it begins
  std::optional<FerryConfig> ferry;
  if (options.config_folder.empty()) ferry.emplace();
  const auto& config_folder = ferry ? ferry->path() : options.config_folder;
  Table table({"scenario", "tracker", "scans", "50m", "75m", "100m", "all", "boat_50m", "boat_75m", "boat_100m", "localisation", "missed", "false",
               "switches_100m"});
  struct Sum {
    std::size_t num_scans = 0;
    FerryScores scores;
  };
  std::vector<std::string> trackers;
  std::map<std::pair<std::string, std::string>, Sum> sums;  // by group and tracker
  const std::vector<std::string> groups{"open water", "channel", "all"};
  const auto scenarios = ListScenarios(options.folder);
  runtime::Progress progress("lookout-eval", runtime::OnlyTerminal(stderr));
  double num_done = 0.0;
  for (const auto& scenario : scenarios) {
    io::ThrowIfStopAsked();
    progress.Update(num_done++ / static_cast<double>(scenarios.size()), [&] { return fmt::format("scenario {}", scenario.number); });
    const auto scans = importer::ReadFerryScans(scenario.scans);
    const auto truth = importer::ReadFerryTruth(scenario.truth);
    const auto has_truth = [&truth](const importer::FerryScan& scan) { return !TruthAt(truth, scan.utime_us).empty(); };
    if (std::ranges::none_of(scans, has_truth)) {
      throw std::runtime_error(fmt::format(
          "{} and {} are not of one run: no scan lies in the time of the truth; the scans go {}", scenario.scans.string(), scenario.truth.string(),
          SpanText({Utime(std::chrono::microseconds(scans.front().utime_us)), Utime(std::chrono::microseconds(scans.back().utime_us))})));
    }
    trackers.clear();
    for (const auto& [tracker, tracks] : TrackFerry(config_folder, scans, MakeTrackers())) {
      trackers.push_back(tracker);
      const auto scores = ScoreFerry(scans, truth, tracks);
      table.Add(RowOf(std::to_string(scenario.number), tracker, scans.size(), scores));
      for (const auto& group : {groups[scenario.number <= kLastInOpenWater ? 0 : 1], groups[2]}) {
        auto& sum = sums[{group, tracker}];
        sum.num_scans += scans.size();
        sum.scores.Add(scores);
      }
    }
  }
  progress.Clear();
  for (const auto& group : groups) {
    for (const auto& tracker : trackers) {
      const auto sum = sums.find({group, tracker});
      if (sum != sums.end()) table.Add(RowOf(group, tracker, sum->second.num_scans, sum->second.scores));
    }
  }
  Table targets({"what", "target", "tracker", "has", "reached"});
  for (const auto& tracker : trackers) {
    for (const auto& [group, range, below_m] : kFerryTargets) {
      const auto sum = sums.find({std::string(group), tracker});
      if (sum == sums.end()) continue;
      const double gospa_m = sum->second.scores.gospa.at(range).Rms();
      targets.Add({fmt::format("GOSPA within {:.0f} m, {}, m", kFerryRangesM.at(range), group), "< " + Number(below_m, 1), tracker,
                   Number(gospa_m, 1), gospa_m < below_m ? "yes" : "MISSED"});
    }
    const auto num_switches = sums.at({"all", tracker}).scores.num_switches;
    targets.Add(
        {"switches", "<= " + Number(kMostFerrySwitches), tracker, Number(num_switches), num_switches <= kMostFerrySwitches ? "yes" : "MISSED"});
  }
  const std::string title =
      "Autoferry: GOSPA (c 20 m, p 2, alpha 2), root of the mean square, m: within a range over all scans; boat: over the scans with a boat within "
      "it, parts "
      "of that within 100 m";
  std::cout << title << '\n';
  table.Print(std::cout);
  std::cout << "\nAutoferry: targets\n";
  targets.Print(std::cout);
  if (options.block_files.empty()) return EXIT_SUCCESS;
  const auto measured = MeasuredToday();
  FillBlocksOf(options.block_files,
               {{"autoferry", {title + ".", measured}, table}, {"autoferry_targets", {"Autoferry: targets.", measured}, targets}});
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
