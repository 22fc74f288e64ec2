#include "tools/eval/log_command.hpp"

#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/config/boat.hpp"
#include "common/io/file_kind.hpp"
#include "tools/eval/report.hpp"
#include "tools/eval/track_command.hpp"
#include "tools/eval/track_run.hpp"
#include "tools/eval/track_tables.hpp"
#include "tools/export/boat_of_log.hpp"
#include "tools/export/scans.hpp"

namespace lookout::eval {
namespace {

// A scan waits for its obstacles for some seconds of scans at most.
constexpr std::size_t kMaxWaiting = 256;

// Decodes and hands on. @return whether the message could be used
template <typename Message>
bool Take(const bus::LogEvent& event, auto& taker) {
  const auto message = bus::Decode<Message>(event.bytes);
  if (message) taker.Add(*message);
  return message.has_value();
}

}  // namespace

int EvaluateLog(const LogOptions& options) {
  std::unique_ptr<Truth> truth;
  if (!options.truth_folder.empty()) truth = std::make_unique<Truth>(options.truth_folder);
  std::optional<TrackRun> tracks;
  if (truth) tracks.emplace(*truth, MakeTrackers(), TrackRun::Returns::kKept);
  Evaluation evaluation(truth.get(), options.min_num_returns);
  if (!options.true_boat_folder.empty()) evaluation.SetMounting(config::LoadBoat(options.true_boat_folder).T_vessel_lidar);
  Machine machine;
  std::int64_t num_incomplete = 0;
  messages::ScanCollector collector([](const messages::ScanMessages& scan) { return messages::HasAllParts(scan.obstacles); },
                                    messages::ScanCollector::Order::kOfCompletion, kMaxWaiting,
                                    [&](const messages::ScanMessages& scan) {
                                      if (messages::HasAllParts(scan.obstacles)) {
                                        evaluation.Add(scan);
                                      } else if (!scan.obstacles.empty()) {
                                        ++num_incomplete;
                                      }
                                    });

  bus::LogReader reader(options.log_file);
  std::optional<config::BoatFacts> boat;
  std::int64_t num_unusable = 0;
  bool holds_events = false;
  while (const auto event = reader.Next()) {
    holds_events = true;
    bool is_taken = true;
    const auto& channel = event->channel;
    if (channel == bus::kObstacles.name || (truth && (channel == bus::kLidarScan.name || channel == bus::kSegments.name))) {
      is_taken = exporter::AddTo(collector, channel, event->bytes) == exporter::Taken::kOk;
    } else if (channel == bus::kLidarClock.name) {
      is_taken = Take<lidar_clock_t>(*event, machine);
    } else if (channel == bus::kHealth.name) {
      is_taken = Take<health_t>(*event, machine);
    } else if (truth && channel == bus::kRunInfo.name) {
      is_taken = exporter::TakeRunInfo(event->bytes, boat) == exporter::Taken::kOk;
      if (boat && options.true_boat_folder.empty()) evaluation.SetMounting(boat->T_vessel_lidar);
    } else if (truth && channel == bus::kPose.name) {
      is_taken = Take<pose_t>(*event, evaluation);
    }
    // What it cannot decode of the channels above is counted there.
    if (tracks && !tracks->Add(channel, event->bytes) && channel == kTracksChannel) is_taken = false;
    if (!is_taken) ++num_unusable;
  }
  collector.Finish();
  if (!holds_events) throw std::runtime_error(io::NoEventText(options.log_file));
  if (evaluation.num_scans == 0) {
    std::cerr << options.log_file << ": no scan of OBSTACLES\n";
    return EXIT_FAILURE;
  }

  PrintObstacles(std::cout, evaluation, truth != nullptr);
  if (truth) {
    PrintAccuracy(std::cout, evaluation);
    PrintSeen(std::cout, evaluation);
    PrintSegmentation(std::cout, evaluation, options.min_num_returns);
  }
  if (tracks) {
    tracks->Finish();
    std::vector<TrackRow> rows;
    for (auto& row : tracks->Rows()) rows.push_back({"log", std::move(row)});
    if (tracks->has_own_tracks()) PrintTables(TablesOf(rows), std::cout);
  }
  PrintMachine(std::cout, machine);
  if (num_unusable > 0) std::cout << num_unusable << " messages of the log could not be used\n";
  if (num_incomplete > 0) std::cout << num_incomplete << " scans lack a part of OBSTACLES\n";
  if (reader.num_damaged() > 0) std::cout << reader.num_damaged() << " stretches of the log are damaged\n";
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
