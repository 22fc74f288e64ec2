// lookout-eval: how good the obstacles of a log are, against the truth of a simulation, and what the machine lost and took.
#include <CLI/CLI.hpp>
#include <concepts>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/runtime/options.hpp"
#include "tools/eval/report.hpp"

namespace {

using namespace lookout;

constexpr int kExitUsage = 2;

struct Options {
  std::string log_file;
  std::string truth_folder;
  int min_num_returns = 3;
};

// Exits here for --help, --version and wrong lines.
Options ParseOptions(int argc, char** argv) {
  Options options;
  CLI::App app("Holds a log against the truth of lookout-sim; without --truth tells what the log holds.", "lookout-eval");
  app.add_option("--in", options.log_file, "lcm-log with OBSTACLES")->required();
  app.add_option("--truth", options.truth_folder, "folder that lookout-sim --truth wrote");
  app.add_option("--min-returns", options.min_num_returns, "an object with fewer returns in a turn does not count for recall")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.set_version_flag("--version", "lookout-eval " + runtime::Version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

// Decodes and hands on. @return whether the message could be used
template <typename Message, typename Taker>
bool Take(const bus::LogEvent& event, Taker& taker) {
  auto message = bus::Decode<Message>(event.bytes);
  if (!message) return false;
  if constexpr (requires {
                  { taker.Add(std::move(*message)) } -> std::same_as<bool>;
                }) {
    return taker.Add(std::move(*message));
  } else {
    taker.Add(*message);
    return true;
  }
}

int Run(const Options& options) {
  std::unique_ptr<eval::Truth> truth;
  if (!options.truth_folder.empty()) truth = std::make_unique<eval::Truth>(options.truth_folder);
  eval::Evaluation evaluation(truth.get(), options.min_num_returns);
  eval::Machine machine;
  eval::TurnCollector collector([&evaluation](const eval::Turn& turn) { evaluation.Add(turn); });

  bus::LogReader reader(options.log_file);
  std::int64_t num_unusable = 0;
  while (const auto event = reader.Next()) {
    bool is_taken = true;
    if (event->channel == bus::kObstacles.name) {
      is_taken = Take<obstacles_t>(*event, collector);
    } else if (event->channel == bus::kLidarClock.name) {
      is_taken = Take<lidar_clock_t>(*event, machine);
    } else if (event->channel == bus::kHealth.name) {
      is_taken = Take<health_t>(*event, machine);
    } else if (truth && event->channel == bus::kLidarScan.name) {
      is_taken = Take<lidar_scan_t>(*event, collector);
    } else if (truth && event->channel == bus::kSegments.name) {
      is_taken = Take<segments_t>(*event, collector);
    } else if (truth && event->channel == bus::kPose.name) {
      is_taken = Take<pose_t>(*event, evaluation);
    }
    if (!is_taken) ++num_unusable;
  }
  if (evaluation.num_turns == 0) {
    std::cerr << options.log_file << ": no turn of OBSTACLES\n";
    return EXIT_FAILURE;
  }

  eval::PrintObstacles(std::cout, evaluation, truth != nullptr);
  if (truth) {
    eval::PrintAccuracy(std::cout, evaluation);
    eval::PrintSegmentation(std::cout, evaluation, options.min_num_returns);
  }
  eval::PrintMachine(std::cout, machine);
  if (num_unusable > 0) std::cout << num_unusable << " messages of the log could not be used\n";
  if (collector.num_incomplete() > 0) std::cout << collector.num_incomplete() << " turns lack a part of OBSTACLES\n";
  if (reader.num_damaged() > 0) std::cout << reader.num_damaged() << " stretches of the log are damaged\n";
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) try { return Run(ParseOptions(argc, argv)); } catch (const std::exception& error) {
  std::cerr << "lookout-eval: " << error.what() << '\n';
  return EXIT_FAILURE;
}
