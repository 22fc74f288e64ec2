// lookout-sim: the boat, its sensors and the water around it, as datagrams in a capture or on the network.
#include <pthread.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "common/config/text_config.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "config/schema/navigator.pb.h"
#include "config/schema/vlp16.pb.h"
#include "tools/sim/pcap_sink.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/udp_sink.hpp"

namespace {

using namespace lookout;

constexpr int kExitUsage = 2;

// 2026-06-15 14:10:00 UTC: any date serves, as long as it is always the same.
constexpr std::int64_t kDefaultStartUtimeUs = 1'781'532'600'000'000;

struct Options {
  std::filesystem::path config_folder;
  std::string scene;
  std::uint64_t seed = 1;
  double seconds = 0.0;
  std::string pcap_file;
  std::string udp_host;
  std::string truth_folder;
  std::int64_t start_utime_us = kDefaultStartUtimeUs;
  sim::LidarParams lidar;
  sim::NavigationParams navigation;
};

std::string JoinedSceneNames() {
  std::string names;
  for (const auto name : sim::SceneNames()) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

// Exits here for --help, --version, --list-scenes and wrong lines.
Options ParseOptions(int argc, char** argv) {
  Options options;
  std::string config_folder;
  bool has_no_heading = false;
  std::string mode = "strongest";
  CLI::App app("Sends what the sensors of a simulated boat send: VLP-16 packets and NMEA 0183.", "lookout-sim");
  app.add_option("--config", config_folder, "folder of the boat's *.txtpb files")->required()->check(CLI::ExistingDirectory);
  app.add_option("--scene", options.scene, "one of: " + JoinedSceneNames())->required();
  app.add_option("--seed", options.seed, "of all that is random")->required();
  app.add_option("--seconds", options.seconds, "length")->required()->check(CLI::Range(0.001, 86400.0));
  auto* pcap = app.add_option("--pcap", options.pcap_file, "write a capture");
  auto* udp = app.add_option("--udp", options.udp_host, "send to this host in real time; times are those of now");
  pcap->excludes(udp);
  app.add_option("--truth", options.truth_folder, "write the truth as CSV files to this folder");
  app.add_option("--start-utime-us", options.start_utime_us, "with --pcap: time of the first shot")
      ->check(CLI::Range(std::int64_t{0}, kMaxUtimeUs))
      ->excludes(udp)
      ->capture_default_str();
  app.add_option("--return-mode", mode, "strongest, last or dual")->check(CLI::IsMember({"strongest", "last", "dual"}))->capture_default_str();
  app.add_option("--rpm", options.lidar.rotation_rpm, "turns of the lidar per minute")
      ->check(CLI::Range(vlp16::format::kMinRpm, vlp16::format::kMaxRpm))
      ->capture_default_str();
  app.add_option("--strays", options.lidar.stray_probability, "stray returns per shot that meets nothing")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--rate", options.navigation.gnss_rate_hz, "RMC, GGA and VTG per second")
      ->check(CLI::IsMember({1, 2, 4, 5, 10, 20}))
      ->capture_default_str();
  app.add_option("--gnss-sd", options.navigation.gnss_sd_m, "standard deviation of a position, metres per axis")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_flag("--no-heading", has_no_heading, "a boat with a GNSS receiver alone: no HDT, no PASHR");
  app.add_flag_callback(
      "--list-scenes",
      [] {
        for (const auto name : sim::SceneNames()) std::cout << name << '\n';
        throw CLI::Success();
      },
      "print the names of the scenes and exit");
  app.set_version_flag("--version", "lookout-sim " + runtime::Version());
  try {
    app.parse(argc, argv);
    if (options.pcap_file.empty() == options.udp_host.empty()) throw CLI::RequiredError("either --pcap FILE or --udp HOST");
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  options.config_folder = config_folder;
  options.navigation.has_heading = !has_no_heading;
  options.lidar.mode = mode == "dual" ? sim::ReturnMode::kDual : mode == "last" ? sim::ReturnMode::kLast : sim::ReturnMode::kStrongest;
  return options;
}

// Waits until `time` by an undisturbed clock. @return whether SIGINT or SIGTERM came
bool WaitUntil(std::chrono::steady_clock::time_point time, const sigset_t& stop_signals) {
  for (;;) {
    const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(time - std::chrono::steady_clock::now());
    const auto wait = std::max(rest, std::chrono::nanoseconds(0));
    const timespec timeout{wait.count() / 1'000'000'000, wait.count() % 1'000'000'000};
    if (sigtimedwait(&stop_signals, nullptr, &timeout) > 0) return true;
    if (rest <= std::chrono::nanoseconds(0)) return false;
  }
}

// The start is set by the first datagram's deadline; each has a deadline of its own, so delays do not add up.
void Pace(sim::Simulation& simulation, sim::UdpSink& sink, Utime start) {
  sigset_t stop_signals;
  sigemptyset(&stop_signals);
  sigaddset(&stop_signals, SIGINT);
  sigaddset(&stop_signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop_signals, nullptr);
  const auto base = std::chrono::steady_clock::now() + (start - runtime::HostNow());
  while (const auto datagram = simulation.Next()) {
    if (WaitUntil(base + (datagram->time - start), stop_signals)) break;
    sink.Send(*datagram);
  }
  if (sink.num_refused() > 0) std::cerr << "lookout-sim: the network did not take " << sink.num_refused() << " datagrams\n";
}

void Run(const Options& options) {
  const auto boat = config::LoadBoat(options.config_folder);
  const auto vlp16 = config::Load<config::Vlp16>(options.config_folder, "vlp16.txtpb");
  const auto navigator = config::Load<config::Navigator>(options.config_folder, "navigator.txtpb");
  const auto scene = sim::MakeScene(options.scene, options.seed);
  if (!scene) throw std::invalid_argument("--scene: no such scene: " + options.scene + " (there are: " + JoinedSceneNames() + ")");

  sim::SimulationParams params;
  params.lidar = options.lidar;
  params.lidar.use_vertical_origin_offsets = vlp16.use_vertical_origin_offsets();
  params.navigation = options.navigation;
  params.navigation.nmea_port = navigator.nmea_port();
  params.navigation.position_port = vlp16.position_port();
  params.navigation.heading_offset_deg = navigator.heading_offset_deg();
  params.navigation.pitch_offset_deg = navigator.pitch_offset_deg();
  params.navigation.roll_offset_deg = navigator.roll_offset_deg();
  params.data_port = vlp16.data_port();
  const bool is_live = !options.udp_host.empty();
  params.start = is_live ? runtime::HostNow() : Utime(std::chrono::microseconds(options.start_utime_us));
  params.duration = std::chrono::microseconds(std::llround(options.seconds * 1e6));
  params.seed = options.seed;

  std::unique_ptr<sim::TruthWriter> truth;
  if (!options.truth_folder.empty()) truth = std::make_unique<sim::TruthWriter>(options.truth_folder, *scene, boat, params.start);
  sim::Simulation simulation(*scene, boat, params, truth.get());
  if (is_live) {
    sim::UdpSink sink(options.udp_host);
    Pace(simulation, sink, params.start);
  } else {
    sim::PcapSink sink(options.pcap_file, {params.data_port, params.navigation.position_port});
    while (const auto datagram = simulation.Next()) sink.Send(*datagram);
    sink.Close();
  }
  if (truth) truth->Close();
}

}  // namespace

int main(int argc, char** argv) try {
  Run(ParseOptions(argc, argv));
  return EXIT_SUCCESS;
} catch (const std::invalid_argument& error) {
  std::cerr << "lookout-sim: " << error.what() << '\n';
  return kExitUsage;
} catch (const config::ConfigError& error) {
  std::cerr << error.what() << '\n';
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "lookout-sim: " << error.what() << '\n';
  return EXIT_FAILURE;
}
