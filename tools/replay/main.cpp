// lookout-replay: a capture or an lcm-log in, an lcm-log with everything computed again out.
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/core/log_time.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/run_info.hpp"
#include "common/runtime/version.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "services/lidar/params.hpp"
#include "services/navigator/params.hpp"
#include "tools/log/log_output.hpp"
#include "tools/log/other_type.hpp"
#include "tools/log/pose_counts.hpp"
#include "tools/log/run_marks.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"
#include "tools/replay/lacks.hpp"
#include "tools/replay/message_hashes.hpp"
#include "tools/replay/plan.hpp"

namespace {

namespace fs = std::filesystem;
using lookout::replay::Chain;

struct Options {
  fs::path config_folder;
  bool check_only = false;
  std::vector<fs::path> inputs;
  fs::path output;
  bool force = false;
  lookout::replay::Request request;
  bool shows_progress = false;
  fs::path hashes;
  std::optional<std::chrono::sys_days> day = {};
};

Options ParseOptions(int argc, char** argv) {
  Options options;
  std::string day;
  CLI::App app("Runs captures or lcm-logs through all services, or some, in one process and writes an lcm-log. Same input, same bytes.",
               "lookout-replay");
  app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
  app.add_flag("--check", options.check_only, "check the config, print the values in force, exit");
  app.add_option("--in", options.inputs, "pcap, pcapng, text log of NMEA 0183 or lcm-log; several are read in their order")->check(CLI::ExistingPath);
  app.add_option("--out", options.output, "lcm-log to write: as FILE.partial until it is whole; one that exists is refused");
  app.add_flag("--force", options.force, "replace an existing --out");
  app.add_option("--from", options.request.from,
                 "channel to read from the log; the service that publishes it, and those before that, do not run (several)")
      ->check(CLI::IsMember(lookout::replay::FromNames()));
  app.add_option("--only", options.request.only, "service to run, and no other; its inputs are read from the log (several)")
      ->check(CLI::IsMember(lookout::replay::ServiceNames()));
  app.add_flag("--progress", options.shows_progress,
               "show progress as on a terminal; without it, where standard error is none, a line comes each minute");
  app.add_option("--hashes", options.hashes, "CSV file to write: channel, number, time and hash of each computed message");
  app.add_option("--date", day,
                 "day of the first time in a text log in which no sentence tells a date (GGA and GLL alone), as 2026-07-01; without it 1970-01-01")
      ->check([](const std::string& text) { return lookout::navigator::ParseDay(text) ? std::string() : "'" + text + "' is no day as 2026-07-01"; });
  app.set_version_flag("--version", "lookout-replay " + lookout::runtime::Version());
  try {
    app.parse(argc, argv);
    if (!options.check_only && (options.inputs.empty() || options.output.empty()))
      throw CLI::RequiredError("--in and --out are required", CLI::ExitCodes::RequiredError);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : 2);
  }
  options.day = lookout::navigator::ParseDay(day);
  return options;
}

void PrintDigests(Chain& chain, std::FILE* out) {
  for (const auto& channel : lookout::bus::kChannels) {
    const auto entry = chain.digests().find(channel.name);
    if (entry == chain.digests().end()) continue;
    fmt::print(out, "{:<14} {:>8} {}\n", entry->first, entry->second.count, entry->second.sha256.Finish());
  }
}

std::int64_t CountOf(Chain& chain, const lookout::bus::Channel& channel) {
  const auto entry = chain.digests().find(channel.name);
  return entry == chain.digests().end() ? 0 : entry->second.count;
}

// RUN_INFO of the result: the config in force, and why results may differ from those of the whole chain with the config of the input.
lookout::run_info_t RunInfoOf(const Options& options, const lookout::replay::Inspection& inspection) {
  auto run_info = lookout::runtime::MakeRunInfo("replay", options.config_folder);
  std::string text = IsWhole(inspection.plan) ? "" : InWords(inspection.plan);
  if (inspection.recorded) {
    const auto differing = lookout::replay::DifferingConfigFiles(*inspection.recorded, run_info);
    if (!differing.empty()) {
      const auto names = fmt::format("{}", fmt::join(differing, ", "));
      spdlog::info("what if: the config is not that of the input, it differs in {}", names);
      text += "config differs from that of the input: " + names + "\n";
    }
  }
  if (text.empty()) return run_info;
  run_info.file_name.emplace_back("lookout-replay");
  run_info.file_text.push_back(text);
  run_info.num_files = static_cast<std::int32_t>(run_info.file_name.size());
  return run_info;
}

void PrintSummary(const lookout::replay::InputSummary& summary, const Chain& chain, std::int64_t num_scans) {
  for (const auto& [channel, count] : summary.left) spdlog::info("not read: {} {}", channel, count);
  for (const auto& [reason, count] : summary.refused) spdlog::warn("{}: {}", reason, count);
  for (const auto& [name, count] : chain.Counters()) {
    spdlog::info("{}: {}", name, count);
    if (name == "lidar.beams_of_log") spdlog::warn("the lidar's beams in the input are not those of the config: those of the input are used");
  }
  for (const auto& [channel, count] : chain.Gaps()) {
    spdlog::warn("{}: {} messages are missing in the input; what follows a gap need not equal the live run", channel, count);
  }
  for (const auto& [service, seconds] : chain.StageTimes()) {
    spdlog::info("{}: {:.3f} s{}", service, seconds,
                 num_scans > 0 ? fmt::format(", {:.3f} ms a scan", 1e3 * seconds / static_cast<double>(num_scans)) : "");
  }
}

// Two publishers of one channel.
void PrintInterleavings(const std::vector<lookout::log::Interleaving>& interleavings) {
  for (const auto& interleaving : interleavings) {
    spdlog::warn(
        "{} has two publishers from event {} of the input on, {}: {} messages of the second are left out; what is computed from there on "
        "stands outside the proof and need not equal the live run",
        interleaving.channel, interleaving.event, lookout::TimeText(interleaving.time), interleaving.num_messages);
  }
}

// Whether the logs hold a run from its start to its end, and the consequence where they do not.
void PrintMarks(const lookout::log::RunMarks& marks, std::int64_t num_left_out) {
  const auto warn = [](const std::vector<std::string>& channels, const char* meaning) {
    if (!channels.empty()) spdlog::warn("{}: the input {}", fmt::join(channels, ", "), meaning);
  };
  warn(marks.WithoutStart(), "begins without a start mark, in the middle of a run; what is computed first need not equal the live run");
  warn(marks.WithoutEnd(), "ends without an end mark: it was cut there, and nothing is computed for the scan and the poses that were under way");
  warn(marks.CutInside(), "holds a run without an end mark and another behind it; what is computed where it was cut need not equal the live run");
  if (num_left_out > 0) {
    spdlog::warn("{} messages of SEGMENTS at the end waited for a POSE that the input does not hold: no OBSTACLES are computed of them",
                 num_left_out);
  }
}

// The report at the end.
struct Watched {
  lookout::log::PoseCounts poses;
  std::map<std::string, std::int64_t, std::less<>> num_of_other_type;  // by channel that is read and not computed
  std::int64_t num_sentences = 0;

  void Add(std::string_view channel, lookout::Bytes bytes) {
    const auto* const known = lookout::bus::FindChannel(channel);
    if (known != nullptr && lookout::log::IsOfOtherType(*known, bytes)) ++num_of_other_type[std::string(channel)];
    if (channel == lookout::bus::kPose.name) {
      if (const auto pose = lookout::bus::Decode<lookout::pose_t>(bytes)) poses.Add(*pose);
    } else if (channel == lookout::bus::kNavRaw.name) {
      const auto item = lookout::bus::Decode<lookout::nav_raw_t>(bytes);
      num_sentences += item && item->kind == lookout::nav_raw_t::KIND_SENTENCE ? 1 : 0;
    }
  }
};

lookout::replay::Seen SeenIn(const Options& options, const lookout::replay::Inspection& inspection, Chain& chain, const Watched& watched) {
  using lookout::replay::Seen;
  Seen seen;
  seen.input = inspection.is_logs ? Seen::Input::kLog : inspection.is_text_logs ? Seen::Input::kTextLog : Seen::Input::kCapture;
  const auto& plan = inspection.plan;
  seen.wants_scans = plan.Publishes(lookout::bus::kLidarScan);
  seen.wants_poses = plan.Publishes(lookout::bus::kPose);
  seen.wants_tracks = plan.Publishes(lookout::bus::kTracks);
  seen.data_port = lookout::lidar::LoadParams(options.config_folder).data_port;
  for (const auto& [port, source] : lookout::navigator::LoadParams(options.config_folder).source_of_port) seen.sentence_ports.push_back(port);
  const auto* const lidar = chain.FindPublisher(lookout::bus::kLidarScan);
  seen.num_lidar_packets = inspection.is_logs || lidar == nullptr ? CountOf(chain, lookout::bus::kLidarPackets) : lidar->num_measured();
  seen.num_sentences = watched.num_sentences;
  seen.num_scans = CountOf(chain, seen.wants_scans ? lookout::bus::kLidarClock : lookout::bus::kObstacles);
  for (const auto& [name, count] : chain.Counters()) {
    if (name == "georeferencer.obstacles_ok") seen.num_obstacles_placed = count;
    if (name == "georeferencer.obstacles_vessel_frame_only") seen.num_obstacles_unplaced = count;
  }
  seen.poses = watched.poses;
  seen.other_ports = chain.other_ports();
  return seen;
}

void Replay(const Options& options) {
  auto config_and_inputs = lookout::io::FilesIn(options.config_folder);
  config_and_inputs.insert(config_and_inputs.end(), options.inputs.begin(), options.inputs.end());
  // Before all work.
  lookout::log::LogOutput output(
      options.output, {.force = options.force, .inputs = config_and_inputs, .tell = [](const std::string& line) { spdlog::warn("{}", line); }});
  std::optional<lookout::replay::MessageHashes> hashes;
  if (!options.hashes.empty()) hashes.emplace(options.hashes, lookout::io::OutputOptions{.force = options.force, .inputs = config_and_inputs});
  const auto start = std::chrono::steady_clock::now();
  lookout::runtime::Progress looking("replay", lookout::runtime::OnlyTerminal(stderr));
  auto inspection = lookout::replay::Inspect(options.inputs, options.request,
                                             [&looking](double share) { looking.Update(share, [] { return "looking what the logs hold"; }); });
  looking.Clear();
  inspection.day = options.day;
  auto run_info = RunInfoOf(options, inspection);
  Watched watched;
  Chain chain(options.config_folder, inspection.plan, [&](lookout::Utime time, std::string_view channel, lookout::Bytes bytes) {
    if (output.num_events() == 0) {  // RUN_INFO first, with the time of the first event
      run_info.utime_us = lookout::ToUtimeUs(time);
      output.Write(time, lookout::bus::kRunInfo.name, lookout::bus::Encode(run_info));
    }
    watched.Add(channel, bytes);
    if (hashes) hashes->Add(channel, bytes);
    output.Write(time, channel, bytes);
  });

  lookout::replay::InputSummary summary;
  std::int64_t num_left_out = 0;
  {
    const bool is_terminal = options.shows_progress || isatty(STDERR_FILENO) != 0;
    lookout::runtime::Progress progress("replay", stderr, is_terminal);
    summary = lookout::replay::Feed(options.inputs, inspection, chain, progress);
    num_left_out = lookout::replay::Finish(summary, inspection, chain);
  }
  const double digest_s = lookout::ToSeconds(chain.digest_time());
  const double elapsed_s = lookout::ToSeconds(std::chrono::steady_clock::now() - start) - digest_s;

  const bool has_clock =
      chain.digests().contains(lookout::bus::kLidarClock.name);  // LIDAR_CLOCK comes once a scan; without it the results count the scans
  const auto num_scans = CountOf(chain, has_clock ? lookout::bus::kLidarClock : lookout::bus::kSegments);
  PrintSummary(summary, chain, num_scans);
  PrintInterleavings(summary.interleavings);
  PrintMarks(summary.marks, num_left_out);
  spdlog::info("{} events, {} scans, {:.3f} s in {:.3f} s: {:.0f} times real time; digests {:.3f} s more", summary.num_events, num_scans,
               lookout::ToSeconds(chain.span()), elapsed_s, lookout::ToSeconds(chain.span()) / elapsed_s, digest_s);

  const auto* const lidar = chain.FindPublisher(lookout::bus::kLidarScan);
  const auto* const navigation = chain.FindPublisher(lookout::bus::kPose);
  if (!inspection.is_logs && CountOf(chain, lookout::bus::kLidarPackets) == 0 && (navigation == nullptr || navigation->num_measured() == 0)) {
    const auto ports = lookout::replay::PortsText(chain.other_ports());
    throw std::runtime_error("the input holds no lidar packet and no sentence on the ports of the config" +
                             (ports.empty() ? "" : "; datagrams came to " + ports));
  }
  if (lidar != nullptr && lidar->num_measured() > 0 && num_scans == 0) {
    throw std::runtime_error("no scan came out of the lidar's packets, see the counts above. " + lidar->Report().reason);
  }
  for (const auto& [channel, count] : watched.num_of_other_type) {
    const auto& known = *lookout::bus::FindChannel(channel);
    spdlog::warn("{}{}", lookout::log::OtherTypeText(known, count), lookout::log::IsMadeAnew(known) ? ", without --from and --only" : "");
  }
  for (const auto& line : lookout::replay::Lacks(SeenIn(options, inspection, chain, watched))) spdlog::warn("{}", line);
  std::FILE* const out = output.IsStandardOutput() ? stderr : stdout;  // a log that goes there is not mixed with lines
  output.Commit();
  if (hashes) hashes->Commit();
  PrintDigests(chain, out);  // last, so that the log is complete whether or not anybody reads the digests
}

// Memory that is returned to the system is requested again at the next scan: page faults took a tenth of the time.
void KeepMemory() {
  constexpr int kKeptBytes = 256 * 1024 * 1024;
  constexpr int kHeapBytes = 32 * 1024 * 1024;  // the greatest that mallopt takes; no message is so large
  constexpr int kStepBytes = 4 * 1024 * 1024;
  mallopt(M_TRIM_THRESHOLD, kKeptBytes);
  mallopt(M_MMAP_THRESHOLD, kHeapBytes);
  mallopt(M_TOP_PAD, kStepBytes);
}

}  // namespace

int main(int argc, char** argv) {
  KeepMemory();
  lookout::io::CatchStopSignals();
  const Options options = ParseOptions(argc, argv);
  // Tables go to stdout, all else to stderr.
  spdlog::set_default_logger(spdlog::stderr_color_st("replay"));
  return lookout::runtime::RunMain("replay", [&options] {
    lookout::runtime::SetLogPattern("%^%l%$ replay: %v");
    lookout::replay::CheckConfig(options.config_folder);
    if (options.check_only) {
      fmt::print("{}", lookout::runtime::EffectiveConfig(options.config_folder));
      return;
    }
    try {
      Replay(options);
    } catch (const lookout::replay::RequestError& error) {
      throw lookout::config::ConfigError({error.what()});  // a wrong command line ends as a wrong config does
    }
  });
}
