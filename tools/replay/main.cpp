// lookout-replay: a capture or an lcm-log in, an lcm-log with everything computed again out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/config/text_config.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"

namespace {

namespace fs = std::filesystem;
using lookout::replay::Chain;

struct Options {
  fs::path config_folder;
  bool check_only = false;
  std::vector<fs::path> inputs;
  fs::path output;
};

Options ParseOptions(int argc, char** argv) {
  Options options;
  std::string config_folder;
  std::vector<std::string> inputs;
  std::string output;
  CLI::App app("Runs a capture or an lcm-log through all services in one process and writes an lcm-log. Same input, same bytes.", "lookout-replay");
  app.add_option("--config", config_folder, "folder of the boat's *.txtpb files")->required()->check(CLI::ExistingDirectory);
  app.add_flag("--check", options.check_only, "check the config, print the values in force, exit");
  app.add_option("--in", inputs, "pcap, pcapng or lcm-log; several are read in their order")->check(CLI::ExistingFile);
  app.add_option("--out", output, "lcm-log to write; an older one is replaced");
  app.set_version_flag("--version", "lookout-replay " + lookout::runtime::Version());
  try {
    app.parse(argc, argv);
    if (!options.check_only && (inputs.empty() || output.empty())) throw CLI::RequiredError("--in and --out");
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : 2);
  }
  options.config_folder = config_folder;
  options.inputs.assign(inputs.begin(), inputs.end());
  options.output = output;
  return options;
}

// The log, begun when the time of the first event is known, so that RUN_INFO stands first.
class Output {
 public:
  Output(const Options& options, lookout::run_info_t run_info) : writer_(options.output, true), run_info_(std::move(run_info)) {}

  void Write(lookout::Utime time, std::string_view channel, lookout::Bytes bytes) {
    if (!has_begun_) {
      has_begun_ = true;
      run_info_.utime_us = lookout::ToUtimeUs(time);
      writer_.Write(time, lookout::bus::kRunInfo.name, lookout::bus::Encode(run_info_));
    }
    writer_.Write(time, channel, bytes);
  }
  void Flush() { writer_.Flush(); }

 private:
  lookout::bus::LogWriter writer_;
  lookout::run_info_t run_info_;
  bool has_begun_ = false;
};

void PrintDigests(Chain& chain) {
  for (const auto& channel : lookout::bus::kChannels) {
    const auto entry = chain.digests().find(channel.name);
    if (entry == chain.digests().end()) continue;
    fmt::print("{:<14} {:>8} {}\n", entry->first, entry->second.count, entry->second.sha256.Finish());
  }
}

std::int64_t CountOf(Chain& chain, const lookout::bus::Channel& channel) {
  const auto entry = chain.digests().find(channel.name);
  return entry == chain.digests().end() ? 0 : entry->second.count;
}

void Replay(const Options& options) {
  std::error_code error;
  for (const auto& input : options.inputs) {
    if (fs::equivalent(input, options.output, error)) throw std::runtime_error(options.output.string() + ": is an input");
  }
  const auto raw_input = lookout::replay::Inspect(options.inputs);
  std::optional<Output> output;
  Chain chain(options.config_folder, raw_input,
              [&output](lookout::Utime time, std::string_view channel, lookout::Bytes bytes) { output->Write(time, channel, bytes); });
  output.emplace(options, lookout::runtime::MakeRunInfo("replay", options.config_folder));

  const auto start = std::chrono::steady_clock::now();
  const auto summary = lookout::replay::Feed(options.inputs, chain);
  chain.Finish();
  output->Flush();
  const double elapsed_s = lookout::ToSeconds(std::chrono::steady_clock::now() - start);

  for (const auto& [reason, count] : summary.refused) spdlog::warn("{}: {}", reason, count);
  for (const auto& [name, count] : chain.Counters()) spdlog::info("{}: {}", name, count);
  const auto num_turns = CountOf(chain, lookout::bus::kLidarClock);
  for (const auto& stage : chain.StageTimes()) {
    spdlog::info("{}: {:.3f} s{}", stage.service, stage.seconds,
                 num_turns > 0 ? fmt::format(", {:.3f} ms a turn", 1e3 * stage.seconds / static_cast<double>(num_turns)) : "");
  }
  spdlog::info("{} events, {} turns in {:.3f} s", summary.num_events, num_turns, elapsed_s);
  PrintDigests(chain);

  const bool is_capture = raw_input.lidar == lookout::vlp16::Input::kOutside;
  if (is_capture && CountOf(chain, lookout::bus::kLidarPackets) == 0 && chain.num_nmea_datagrams() == 0) {
    throw std::runtime_error("the input holds no lidar packet and no sentence on the ports of the config");
  }
  if (chain.num_data_datagrams() > 0 && num_turns == 0) {
    throw std::runtime_error("no turn came out of the lidar's packets, see the counts above. " + chain.LidarComplaint());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = ParseOptions(argc, argv);
  // Tables go to stdout, all else to stderr.
  spdlog::set_default_logger(spdlog::stderr_color_st("replay"));
  return lookout::runtime::RunMain("replay", [&options] {
    spdlog::set_pattern("%^%l%$ replay: %v");
    if (options.check_only) {
      fmt::print("{}", lookout::runtime::EffectiveConfig(options.config_folder));
      return;
    }
    Replay(options);
  });
}
