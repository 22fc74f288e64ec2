#include "lab/eval/tracks/alert_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/config/boat.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/eval/table.hpp"
#include "lab/eval/tracks/alert_kept.hpp"
#include "lab/eval/tracks/alert_run.hpp"
#include "lab/eval/tracks/alert_tables.hpp"
#include "lab/eval/tracks/track_tables.hpp"
#include "lab/sim/scene_file.hpp"
#include "services/tracker/params.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/plan.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

// Returns stand in the truth in the order of time, and scans come in theirs.
constexpr std::int64_t kReturnsKeptUs = 2'000'000;

AlertRules RulesOf(const fs::path& config_folder) {
  const auto params = tracker::LoadParams(config_folder);
  AlertRules rules;
  rules.cpa_limit_m = params.tracker.encounter.limit_m;
  rules.look_ahead_s = params.tracker.encounter.look_ahead_s;
  rules.zone = params.look_out.limits.guard_zone;
  return rules;
}

// A run that waits for somebody to do it.
struct AlertJob {
  std::string scene;
  std::uint64_t seed = 0;
  std::function<AlertScores()> run;
};

void AddTo(AlertRun& run, const std::string& scene, std::string_view channel, Bytes bytes) {
  if (!run.Add(channel, bytes)) throw std::runtime_error(scene + ": a message on " + std::string(channel) + " cannot be used");
}

AlertScores ScoresOf(AlertRun& run, const std::string& scene) {
  run.Finish();
  if (!run.has_position()) throw std::runtime_error(scene + ": no scan with a known position");
  return run.scores();
}

// `feed` is called with the handler of its datagrams; the truth knows its objects before the first.
// `also` sees each message, behind the run.
template <typename Feed>
AlertScores JudgeRun(const fs::path& config_folder, const std::string& scene, const Truth& truth, const CountReturns& count_returns,
                     const replay::Chain::Sink& also, const Feed& feed) {
  const auto rules = RulesOf(config_folder);
  const auto own_hull_m = OwnHullOf(config::LoadBoat(config_folder));
  std::optional<AlertRun> run;
  replay::Chain chain(config_folder, {}, [&](Utime time, std::string_view channel, Bytes bytes) {
    AddTo(*run, scene, channel, bytes);
    if (also) also(time, channel, bytes);
  });
  feed([&](const replay::Datagram& datagram) {
    io::ThrowIfStopAsked();
    if (!run) run.emplace(truth, own_hull_m, rules, count_returns);
    chain.OnDatagram(datagram);
  });
  if (!run) throw std::runtime_error(scene + ": no datagram");
  chain.Finish();
  return ScoresOf(*run, scene);
}

// A boat in its berth may lie there for hours. Under way things are in each other's way once the scene is over.
double SecondsOfRun(const fs::path& file, std::uint64_t seed, const AlertOptions& options) {
  const auto scene = sim::LoadScene(file, seed);
  if (scene.own_motion.semi_axes_m.isZero() && !scene.own_motion.track.is_moving()) return options.berth_seconds;
  return std::min(options.plan.seconds, scene.lasts_s.value_or(options.plan.seconds));
}

// What runs in a run that was kept: the tracker.
AlertScores JudgeKept(const AlertOptions& options, const fs::path& scene_file, const std::string& scene, std::uint64_t seed, double seconds,
                      const fs::path& file) {
  const KeptRun kept(file);
  Truth truth(1);
  AddSceneTruth(options.config_folder, scene_file, seed, seconds, truth);
  const auto count_returns = [&kept](const TruthSpan& scan) {
    const auto counts = kept.returns().find(scan.begin_us);
    return counts == kept.returns().end() ? std::map<int, int>{} : counts->second;
  };
  const replay::ChannelSet present{std::string(bus::kLidarScan.name), std::string(bus::kSegments.name), std::string(bus::kObstacles.name),
                                   std::string(bus::kPose.name)};
  const auto plan = replay::MakeLogPlan({.only = {"tracker"}}, present);
  AlertRun run(truth, OwnHullOf(config::LoadBoat(options.config_folder)), RulesOf(options.config_folder), count_returns);
  replay::Chain chain(options.config_folder, plan, [&](Utime, std::string_view channel, Bytes bytes) { AddTo(run, scene, channel, bytes); });
  kept.Send([&](Utime time, std::string_view channel, Bytes bytes) {
    io::ThrowIfStopAsked();
    chain.OnLogged(time, *bus::FindChannel(channel), bytes);
  });
  chain.Finish();
  return ScoresOf(run, scene);
}

AlertScores JudgeScene(const AlertOptions& options, const fs::path& file, const std::string& scene, std::uint64_t seed) {
  const double seconds = SecondsOfRun(file, seed, options);
  std::optional<KeptRunWriter> kept;
  if (!options.kept_folder.empty()) {
    const auto kept_file = options.kept_folder / fmt::format("{}-{}-{:.0f}.run", scene, seed, seconds);
    const auto fingerprint = FingerprintOfRun(options.config_folder, file, seed, seconds);
    if (KeptRun::IsThere(kept_file, fingerprint)) return JudgeKept(options, file, scene, seed, seconds, kept_file);
    kept.emplace(kept_file, fingerprint);
  }
  Truth truth(1);
  const auto count_returns = [&](const TruthSpan& scan) {
    auto counts = truth.CountReturns(scan);
    truth.ForgetReturnsBefore(scan.begin_us - kReturnsKeptUs);
    if (kept) kept->AddReturns(scan.begin_us, counts);
    return counts;
  };
  const auto also = [&kept](Utime time, std::string_view channel, Bytes bytes) {
    if (kept) kept->AddMessage(time, channel, bytes);
  };
  auto scores = JudgeRun(options.config_folder, scene, truth, count_returns, also,
                         [&](const DatagramHandler& on_datagram) { SimulateRun(options.config_folder, file, seed, seconds, truth, on_datagram); });
  if (kept) kept->Commit();
  return scores;
}

AlertScores JudgeCapture(const fs::path& config_folder, const std::string& scene, const CaptureWithTruth& files) {
  const auto boat = config::LoadBoat(config_folder);
  const auto count_returns = ReadReturnCounts(files);
  Truth truth(kCaptureToleranceUs);
  return JudgeRun(config_folder, scene, truth, count_returns, nullptr,
                  [&](const DatagramHandler& on_datagram) { ReadRunOfObjects(files, boat, truth, on_datagram); });
}

std::vector<AlertJob> SceneJobs(const AlertOptions& options) {
  std::vector<AlertJob> jobs;
  ForEachRun(options, [&](const fs::path& file, const std::string& scene, std::uint64_t seed) {
    jobs.push_back({scene, seed, [=, &options] { return JudgeScene(options, file, scene, seed); }});
  });
  return jobs;
}

// Scores by job. The first fault by the order of the jobs is thrown.
std::vector<AlertScores> RunAll(const std::vector<AlertJob>& jobs, std::size_t num_threads) {
  std::vector<AlertScores> scores(jobs.size());
  std::vector<std::exception_ptr> faults(jobs.size());
  std::atomic<std::size_t> next{0};
  std::atomic<bool> has_failed{false};
  std::mutex shown;
  std::size_t num_done = 0;
  runtime::Progress progress("lookout-eval", stderr);
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size() && !has_failed; i = next++) {
      try {
        scores[i] = jobs[i].run();
      } catch (...) {
        faults[i] = std::current_exception();
        has_failed = true;
      }
      const std::scoped_lock lock(shown);
      ++num_done;
      progress.Update(static_cast<double>(num_done) / static_cast<double>(jobs.size()),
                      [&] { return fmt::format("{}, seed {}", jobs[i].scene, jobs[i].seed); });
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 1; i < std::min(num_threads, jobs.size()); ++i) threads.emplace_back(work);
    work();
  }
  for (const auto& fault : faults) {
    if (fault) std::rethrow_exception(fault);
  }
  return scores;
}

AlertWorld JudgeWorld(const std::string& name, const std::string& over_all, const std::vector<AlertJob>& jobs, std::size_t num_threads,
                      io::OutputFile* list) {
  const auto scores = RunAll(jobs, num_threads);
  std::vector<AlertRow> runs;
  runs.reserve(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    runs.push_back({jobs[i].scene, scores[i]});
    if (list == nullptr) continue;
    for (const auto& event : scores[i].events) list->Write(AlertEventRow(jobs[i].scene, jobs[i].seed, event));
  }
  return {name, AddUpAlerts(runs), over_all};
}

std::string ScopeOf(const AlertOptions& options, bool has_captures) {
  const auto& plan = options.plan;
  return fmt::format(
      "Own simulator: {} scenes, {} seeds each from {} on, {:.0f} s a seed, or as long as the scene lasts; in a berth {:.0f} s. The second world: "
      "{}.",
      plan.scenes.size(), plan.num_seeds, plan.first_seed, plan.seconds, options.berth_seconds, has_captures ? "all of its captures" : "not here");
}

}  // namespace

int EvaluateAlerts(const AlertOptions& options) {
  BeginRuns(options, !options.captures.empty(), "--alerts");
  if (!options.kept_folder.empty()) fs::create_directories(options.kept_folder);
  // Outputs before all work.
  TableFiles files(options.csv_folder, AlertTablesOf({}), options.is_forced);
  std::optional<io::OutputFile> list;
  if (!options.list_file.empty()) {
    list.emplace(options.list_file, io::OutputOptions{.force = options.is_forced});
    list->Write(AlertEventHeader());
  }
  io::OutputFile* const events = list ? &*list : nullptr;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<AlertWorld> worlds;
  if (const auto jobs = SceneJobs(options); !jobs.empty()) worlds.push_back(JudgeWorld("own scenes", "all scenes", jobs, options.num_jobs, events));
  std::vector<AlertJob> capture_jobs;
  std::vector<std::unique_ptr<ConfigOfCaptures>> configs;
  const auto with_boat = std::ranges::find_if(options.captures, [](const fs::path& folder) { return fs::exists(folder / "boat.txtpb"); });
  for (const auto& folder : options.captures) {
    if (!fs::exists(folder)) {
      std::cerr << "lookout-eval: " << folder.string() << " is not here\n";
      continue;
    }
    const auto captures = ListCaptures(folder, CaptureTruth::kOfObjects);
    if (captures.empty()) throw std::runtime_error(folder.string() + ": holds no capture (NAME-SEED.pcap.xz)");
    const bool has_own_boat = with_boat == options.captures.end() || fs::exists(folder / "boat.txtpb");
    configs.push_back(std::make_unique<ConfigOfCaptures>(has_own_boat ? folder : *with_boat, options.config_folder));
    const fs::path config_folder = configs.back()->path();
    for (const auto& capture : captures) {
      const auto scene = "second world: " + capture.scene;
      capture_jobs.push_back({scene, capture.seed, [=] { return JudgeCapture(config_folder, scene, capture); }});
    }
  }
  const bool has_captures = !capture_jobs.empty();
  if (has_captures) worlds.push_back(JudgeWorld("second world", "second world: all", capture_jobs, options.num_jobs, events));
  if (list) list->Commit();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;

  const auto tables = AlertTablesOf(worlds);
  PrintTables(tables, std::cout);
  double seconds = 0.0;
  for (const auto& world : worlds) {
    for (const auto& row : world.scenes) seconds += row.scores.seconds;
  }
  std::cerr << fmt::format("lookout-eval: {:.2f} h of runs in {:.0f} s: {:.1f} times real time, {} at once\n", seconds / 3600.0, took.count(),
                           seconds / took.count(), options.num_jobs);
  files.Commit(tables);
  if (options.block_files.empty()) return EXIT_SUCCESS;
  auto figures = FiguresOf(tables, ScopeOf(options, has_captures));
  if (options.are_figures_long) {
    for (auto& figure : figures) figure.name = "long_" + figure.name;
  }
  FillBlocksOf(options.block_files, figures);
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
