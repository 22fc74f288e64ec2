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
#include "tools/sim/faults.hpp"
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
  sim::FaultParams faults;
  double speed = 1.0;
};

std::string JoinedSceneNames() {
  std::string names;
  for (const auto name : sim::SceneNames()) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

// @throws CLI::ValidationError
Sector ToFieldOfView(const std::vector<double>& from_to_deg) {
  Sector field_of_view;
  if (from_to_deg.empty() || (from_to_deg[0] == 0.0 && from_to_deg[1] == 360.0)) return field_of_view;
  field_of_view.start_rad = DegToRad(from_to_deg[0]);
  field_of_view.width_rad = WrapTo2Pi(DegToRad(from_to_deg[1] - from_to_deg[0]));
  if (field_of_view.width_rad < sim::kMinFieldOfViewRad) throw CLI::ValidationError("--field-of-view: must be 2 degrees wide at least");
  return field_of_view;
}

// Exits here for --help, --version, --list-scenes and wrong lines.
Options ParseOptions(int argc, char** argv) {
  Options options;
  std::string config_folder;
  bool has_no_heading = false;
  std::string mode = "strongest";
  std::string model = "vlp16";
  std::vector<double> field_of_view_deg;
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
  app.add_option("--model", model, "vlp16 or hi-res (Puck Hi-Res)")->check(CLI::IsMember({"vlp16", "hi-res"}))->capture_default_str();
  app.add_option("--field-of-view", field_of_view_deg, "lasers fire from this azimuth clockwise to that one, degrees")
      ->expected(2)
      ->type_name("FROM TO")
      ->check(CLI::Range(0.0, 360.0));
  const auto share = CLI::Range(0.0, 1.0);
  app.add_option("--drop", options.faults.drop_share, "share of the data packets that never come")->check(share)->capture_default_str();
  app.add_option("--double", options.faults.double_share, "share of them that come twice")->check(share)->capture_default_str();
  app.add_option("--swap", options.faults.swap_share, "share of them that come after the next")->check(share)->capture_default_str();
  app.add_option("--speed", options.speed, "with --udp: so many times real time; 0 = without waiting")
      ->check(CLI::Range(0.0, 1000.0))
      ->needs(udp)
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
    if (options.faults.drop_share + options.faults.double_share + options.faults.swap_share > 1.0) {
      throw CLI::ValidationError("--drop, --double and --swap: together they must not be more than 1");
    }
    options.lidar.field_of_view = ToFieldOfView(field_of_view_deg);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  options.config_folder = config_folder;
  options.navigation.has_heading = !has_no_heading;
  options.lidar.mode = mode == "dual" ? sim::ReturnMode::kDual : mode == "last" ? sim::ReturnMode::kLast : sim::ReturnMode::kStrongest;
  options.lidar.model = model == "vlp16" ? sim::LidarModel::kVlp16 : sim::LidarModel::kPuckHiRes;
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
void Pace(sim::FaultyNetwork& network, sim::UdpSink& sink, Utime start, double speed) {
  sigset_t stop_signals;
  sigemptyset(&stop_signals);
  sigaddset(&stop_signals, SIGINT);
  sigaddset(&stop_signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop_signals, nullptr);
  const auto base = std::chrono::steady_clock::now() + (start - runtime::HostNow());
  while (const auto datagram = network.Next()) {
    const std::chrono::duration<double, std::micro> wait(speed > 0.0 ? static_cast<double>((datagram->time - start).count()) / speed : 0.0);
    if (WaitUntil(base + std::chrono::duration_cast<std::chrono::nanoseconds>(wait), stop_signals)) break;
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
  sim::FaultyNetwork network([&] { return simulation.Next(); },
                             [&](const sim::Fault& fault) {
                               if (truth) truth->AddFault(fault);
                             },
                             options.faults, params.data_port, params.start, params.start + params.duration, params.seed);
  if (is_live) {
    sim::UdpSink sink(options.udp_host);
    Pace(network, sink, params.start, options.speed);
  } else {
    sim::PcapSink sink(options.pcap_file, {params.data_port, params.navigation.position_port});
    while (const auto datagram = network.Next()) sink.Send(*datagram);
    sink.Close();
  }
  if (truth) truth->Close();
  const auto& totals = network.totals();
  std::cout << "data packets made " << totals.num_made << ", sent " << totals.num_sent << ", dropped " << totals.num_dropped << ", doubled "
            << totals.num_doubled << ", swapped " << totals.num_swapped << '\n';
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
