#include "lab/eval/log_command.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/config/boat.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "lab/eval/report/report.hpp"
#include "lab/eval/report/truth_match.hpp"
#include "lab/eval/tracks/track_command.hpp"
#include "lab/eval/tracks/track_run.hpp"
#include "lab/eval/tracks/track_tables.hpp"
#include "tools/export/boat_of_log.hpp"
#include "tools/export/scans.hpp"
#include "tools/export/selection.hpp"
#include "tools/log/other_type.hpp"
#include "tools/log/pose_counts.hpp"

namespace lookout::eval {
namespace {

// A scan waits for its obstacles for some seconds of scans at most.
constexpr std::size_t kMaxWaiting = 256;

constexpr const char* kOwnTracker = "lookout";  // the boat's, in tables of tracks

// Decodes and hands on. @return whether the message could be used
template <typename Message>
bool Take(const bus::LogEvent& event, auto& taker) {
  const auto message = bus::Decode<Message>(event.bytes);
  if (message) taker.Add(*message);
  return message.has_value();
}

bool IsOfAScan(std::string_view channel) {
  return channel == bus::kLidarScan.name || channel == bus::kSegments.name || channel == bus::kObstacles.name || channel == bus::kTracks.name ||
         channel == bus::kAlerts.name;
}

// Writes figures for scripts: a row per figure, "-" where it is not known. Figures of tracks are of the boat's own tracker.
void WriteFigures(const LogOptions& options, const Evaluation& evaluation, const std::vector<NamedTable>& tracks) {
  Table table({"figure", "value"});
  table.Add({"scans", Number(evaluation.scan_iou.count)});
  table.Add({"miou", Percent(evaluation.scan_iou.value(), 3)});
  table.Add({"segments_per_scan", Number(evaluation.segments.value(), 4)});
  table.Add({"false_segments_per_scan", Number(evaluation.clutter_segments.value(), 4)});
  table.Add({"sure_false_segments_per_scan", Number(evaluation.sure_clutter_segments.value(), 4)});
  Mean recall;
  Errors errors;
  for (const auto& [kind, score] : evaluation.scores_by_kind) {
    recall.sum += score.recall.sum;
    recall.count += score.recall.count;
  }
  for (const auto& [kind, of_kind] : evaluation.errors_by_kind) errors.Add(of_kind);
  table.Add({"recall", Percent(recall.value(), 3)});
  const auto& outside = errors.position_outside_m;
  table.Add({"position_outside_95_m", outside.count() > 0 ? Number(outside.Percentile(95), 4) : "-"});
  std::set<std::string> names;
  for (const auto& named : tracks) {
    const auto& rows = named.table.rows();
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (rows[i].size() < 3 || rows[i][1] != kOwnTracker) continue;
      for (std::size_t column = 2; column < rows[i].size(); ++column) {
        auto name = named.name + "." + named.table.header()[column];
        if (!names.insert(name).second) name += ".2";  // a table may have a heading twice
        table.Add({name, rows[i][column]});
      }
    }
  }
  std::vector<std::filesystem::path> inputs{options.log_file};
  for (const auto& folder : {options.truth_folder, options.true_boat_folder}) {
    if (!folder.empty()) std::ranges::move(io::FilesIn(folder), std::back_inserter(inputs));
  }
  io::OutputFile output(options.figures_file, {.force = options.is_forced, .inputs = std::move(inputs)});
  table.PrintCsv(output.stream());
  output.Commit();
}

}  // namespace

int EvaluateLog(const LogOptions& options) {
  std::unique_ptr<Truth> truth;
  if (!options.truth_folder.empty()) truth = std::make_unique<Truth>(options.truth_folder);
  std::optional<TrackRun> tracks;
  if (truth) tracks.emplace(*truth, MakeTrackers(), TrackRun::Returns::kKept);
  std::optional<TruthMatch> match;
  if (truth) match.emplace(*truth);
  Evaluation evaluation(truth.get(), options.min_num_returns);
  if (!options.true_boat_folder.empty()) evaluation.SetMounting(config::LoadBoat(options.true_boat_folder).T_vessel_lidar);
  log::PoseCounts poses;
  Machine machine;
  std::int64_t num_incomplete = 0;
  messages::ScanCollector collector([](const messages::ScanMessages& scan) { return messages::HasAllParts(scan.obstacles); },
                                    messages::ScanCollector::Order::kOfCompletion, kMaxWaiting,
                                    [&](const messages::ScanMessages& scan) {
                                      if (messages::HasAllParts(scan.obstacles)) {
                                        if (match) match->Add(scan);
                                        evaluation.Add(scan);
                                      } else if (!scan.obstacles.empty()) {
                                        ++num_incomplete;
                                      }
                                    });

  bus::LogReader reader(options.log_file);
  std::optional<config::BoatFacts> boat;
  std::int64_t num_unusable = 0;
  std::map<std::string, std::int64_t, std::less<>> num_of_other_type;  // by channel
  runtime::Progress progress("lookout-eval", runtime::OnlyTerminal(stderr));
  bool holds_events = false;
  while (const auto event = reader.Next()) {
    holds_events = true;
    io::ThrowIfStopAsked();
    progress.Update(static_cast<double>(reader.position_bytes()) / static_cast<double>(reader.size_bytes()));
    bool is_taken = true;
    const auto& channel = event->channel;
    const auto utime_us = match && IsOfAScan(channel) ? exporter::UtimeUsOf(event->bytes) : std::nullopt;
    if (utime_us && channel == bus::kObstacles.name) match->Count(*utime_us);
    if (utime_us && !match->Holds(*utime_us)) continue;  // the truth does not cover that time
    if (channel == bus::kObstacles.name || (truth && (channel == bus::kLidarScan.name || channel == bus::kSegments.name))) {
      is_taken = exporter::AddTo(collector, channel, event->bytes) == exporter::Taken::kOk;
    } else if (channel == bus::kLidarClock.name) {
      is_taken = Take<lidar_clock_t>(*event, machine);
    } else if (channel == bus::kHealth.name) {
      is_taken = Take<health_t>(*event, machine);
    } else if (truth && channel == bus::kRunInfo.name) {
      is_taken = exporter::TakeRunInfo(event->bytes, boat) == exporter::Taken::kOk;
      if (boat && options.true_boat_folder.empty()) evaluation.SetMounting(boat->T_vessel_lidar);
    } else if (channel == bus::kPose.name) {
      is_taken = Take<pose_t>(*event, poses);
      if (is_taken && match) {
        Take<pose_t>(*event, evaluation);
        Take<pose_t>(*event, *match);
      }
    }
    // Messages of the channels above that do not decode are counted there.
    if (tracks && !tracks->Add(channel, event->bytes) && channel == kTracksChannel) is_taken = false;
    if (is_taken) continue;
    const auto* known = bus::FindChannel(channel);
    ++(known != nullptr && log::IsOfOtherType(*known, event->bytes) ? num_of_other_type[channel] : num_unusable);
  }
  collector.Finish();
  progress.Clear();
  if (!holds_events) throw std::runtime_error(io::NoEventText(options.log_file));
  if (const auto fault = match ? match->Fault(options.log_file, options.truth_folder) : ""; !fault.empty()) throw std::runtime_error(fault);
  if (evaluation.num_scans == 0) {
    std::cerr << options.log_file << ": no scan of OBSTACLES\n";
    return EXIT_FAILURE;
  }

  if (const auto coverage = match ? match->Coverage() : ""; !coverage.empty()) std::cout << coverage << "\n\n";
  PrintObstacles(std::cout, evaluation, truth != nullptr);
  if (const auto why = poses.WhyNotPlaced(); !why.empty() && !evaluation.num_by_status.contains(obstacle_t::STATUS_OK)) {
    std::cout << "no obstacle has a place on the earth, and there are no tracks, as " << why << "\n\n";
  }
  if (truth) {
    PrintAccuracy(std::cout, evaluation);
    PrintSeen(std::cout, evaluation);
    PrintSegmentation(std::cout, evaluation, options.min_num_returns);
  }
  std::vector<NamedTable> track_tables;
  if (tracks) {
    tracks->Finish();
    std::vector<TrackRow> rows;
    for (auto& row : tracks->Rows()) rows.push_back({"log", std::move(row)});
    if (tracks->has_own_tracks()) track_tables = TablesOf(rows);
    PrintTables(track_tables, std::cout);
  }
  PrintMachine(std::cout, machine);
  for (const auto& [channel, num] : num_of_other_type) std::cout << log::OtherTypeText(*bus::FindChannel(channel), num) << '\n';
  if (num_unusable > 0) std::cout << num_unusable << " messages of the log could not be used\n";
  if (num_incomplete > 0) std::cout << num_incomplete << " scans lack a part of OBSTACLES\n";
  if (reader.num_damaged() > 0) std::cout << reader.num_damaged() << " stretches of the log are damaged\n";
  if (!options.figures_file.empty()) WriteFigures(options, evaluation, track_tables);
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
