#include "lab/sim/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>

#include "common/config/boat_folder.hpp"
#include "common/core/log_time.hpp"
#include "common/runtime/version.hpp"
#include "lab/sim/heads.hpp"
#include "lab/sim/scene_file.hpp"

namespace lookout::sim {
namespace {

constexpr int kExitUsage = 2;

// CLI::Range lets NaN pass, which is neither below nor above.
CLI::Validator Within(double min, double max) {
  const CLI::Range range(min, max);
  const auto check = [range](std::string& text) -> std::string {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && std::isnan(value)) return "must be a number (is " + text + ")";
    return range(text);
  };
  return {check, range.get_description(), ""};
}

// UTC as microseconds since 1970. Text that is no UTC stays, for later checks.
std::string ToMicroseconds(std::string& text) {
  const auto given = ParseGivenTime(text);
  if (given && given->kind == GivenTime::Kind::kUtc) text = std::to_string(given->value.count());
  return {};
}

std::string FaultHelp() {
  std::string help = "KIND:BEGIN:END[:VALUE], seconds since the start; again for more. Kinds:";
  for (const auto& form : kTimedFaultForms) {
    help += "\n  " + std::string(form.name);
    if (!form.unit.empty()) help += " (VALUE: " + std::string(form.unit) + ")";
  }
  return help;
}

// @throws CLI::ValidationError
Sector ToFieldOfView(const std::vector<double>& from_to_deg) {
  Sector field_of_view;
  if (from_to_deg.empty() || (from_to_deg[0] == 0.0 && from_to_deg[1] == 360.0)) return field_of_view;
  field_of_view.start_rad = DegToRad(from_to_deg[0]);
  field_of_view.width_rad = WrapTo2Pi(DegToRad(from_to_deg[1] - from_to_deg[0]));
  if (field_of_view.width_rad < kMinFieldOfViewRad) throw CLI::ValidationError("--field-of-view: must be 2 degrees wide at least");
  return field_of_view;
}

void AddRun(CLI::App& app, Options& options) {
  app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
  app.add_option("--scene", options.scene, "name of a scene (--list-scenes), or path of a file that ends in .txtpb")->required();
  app.add_option("--seed", options.simulation.seed, "of all that is random")->required();
  app.add_option("--seconds", options.seconds, "length")->required()->check(Within(0.001, 86400.0));
  auto* pcap = app.add_option("--pcap", options.pcap_file, "write a capture: as FILE.partial until it is whole; one that exists is refused");
  auto* udp = app.add_option("--udp", options.udp_host, "send to this host in real time; times are those of now");
  auto* log = app.add_option("--out", options.log_file, "of a head without packets: write an lcm-log of its LIDAR_SCAN and of NAV_RAW");
  pcap->excludes(udp)->excludes(log);
  udp->excludes(log);
  app.add_option("--truth", options.truth_folder, "write the truth to this folder; files in it that exist are refused");
  app.add_flag("--force", options.force, "replace existing files of --pcap, --out and --truth");
  app.add_option("--start-utime-us", options.start_utime_us,
                 "with --pcap and --out: time of the first shot, in microseconds since 1970 or as UTC (2026-08-29T10:00:00Z)")
      ->transform(CLI::Validator(ToMicroseconds, ""))
      ->check(CLI::Range(std::int64_t{0}, kMaxUtimeUs))
      ->excludes(udp)
      ->capture_default_str();
  app.add_option("--speed", options.speed, "with --udp: so many times real time; 0 = without waiting")
      ->check(Within(0.0, 1000.0))
      ->needs(udp)
      ->capture_default_str();
  const auto list_scenes = [&options] {
    for (const auto& scene : ListScenes(options.config_folder)) fmt::print("{:<16} {}\n", scene.name, scene.description);
    for (const auto& family : ListFamilies(options.config_folder)) fmt::print("{:<16} {}\n", family.name, family.description);
    throw CLI::Success();
  };
  app.add_flag_callback("--list-scenes", list_scenes, "print the names of the scenes, and what they are for, and exit");
}

void AddLidar(CLI::App& app, Options& options) {
  auto& lidar = options.simulation.lidar;
  const auto set_mode = [&options](const std::string& mode) {
    options.effects.set_return_mode(mode == "dual" ? config::Scene::DUAL : mode == "last" ? config::Scene::LAST : config::Scene::STRONGEST);
  };
  app.add_option_function<std::string>("--return-mode", set_mode, "strongest, last or dual; else as the scene says")
      ->check(CLI::IsMember({"strongest", "last", "dual"}));
  app.add_option("--rpm", lidar.rotation_rpm, "revolutions of the lidar per minute")
      ->check(Within(vlp16::format::kMinRpm, vlp16::format::kMaxRpm))
      ->capture_default_str();
  const auto set_strays = [&options](double probability) { options.effects.set_stray_probability(probability); };
  app.add_option_function<double>("--strays", set_strays, "stray returns per shot that meets nothing; else as the scene says")
      ->check(Within(0.0, 1.0));
  auto* head = app.add_option("--lidar", options.lidar, "the head; else as the scene says, vlp16. Packets (--pcap, --udp): of vlp16 and hi-res alone")
                   ->check(CLI::IsMember(HeadNames()));
  app.add_option("--model", options.lidar, "the same, of vlp16 and hi-res (Puck Hi-Res)")->check(CLI::IsMember({"vlp16", "hi-res"}))->excludes(head);
  const auto set_field = [&lidar](const std::vector<double>& from_to_deg) { lidar.field_of_view = ToFieldOfView(from_to_deg); };
  app.add_option_function<std::vector<double>>("--field-of-view", set_field, "lasers fire from this azimuth clockwise to that one, degrees")
      ->expected(2)
      ->type_name("FROM TO")
      ->check(Within(0.0, 360.0));
}

void AddNavigation(CLI::App& app, Options& options) {
  auto& navigation = options.simulation.navigation;
  // Before the others in time, so that they override it.
  const auto set_all = [&navigation](const std::string& set) { navigation = set == "rtk" ? NavigationParams{} : StandaloneNavigation(); };
  app.add_option_function<std::string>("--navigation", set_all, "rtk (0.02 m, 0.2 deg) or standalone (1.5 m, 2 deg)")
      ->check(CLI::IsMember({"rtk", "standalone"}))
      ->trigger_on_parse()
      ->default_str("rtk");
  app.add_option("--rate", navigation.gnss_rate_hz, "RMC, GGA, VTG and GST per second")
      ->check(CLI::IsMember({1, 2, 4, 5, 10, 20}))
      ->capture_default_str();
  app.add_option("--gnss-sd", navigation.gnss_sd_m, "standard deviation of a position, metres per axis; else as --navigation says")
      ->check(Within(0.0, 100.0));
  app.add_flag_callback(
      "--no-heading", [&navigation] { navigation.has_heading = false; }, "a boat with a GNSS receiver alone: no HDT, ROT, PASHR, VNIMU");
}

std::vector<TimedFault> ToFaults(const std::vector<std::string>& texts, double seconds) {
  std::vector<TimedFault> faults;
  for (const auto& text : texts) {
    faults.push_back(ParseTimedFault(text));
    if (ToSeconds(faults.back().begin) >= seconds) throw std::invalid_argument("fault '" + text + "': begins when the run has ended");
  }
  return faults;
}

}  // namespace

Options ParseOptions(int argc, char** argv) {
  Options options;
  std::vector<std::string> faults;
  CLI::App app("Sends what the sensors of a simulated boat send: VLP-16 packets, NMEA 0183 and IMU samples.", "lookout-sim");
  AddRun(app, options);
  AddLidar(app, options);
  AddNavigation(app, options);
  auto& network = options.network;
  app.add_option("--drop", network.drop_share, "share of the data packets that are lost")->check(Within(0.0, 1.0))->capture_default_str();
  app.add_option("--double", network.double_share, "share of them that come twice")->check(Within(0.0, 1.0))->capture_default_str();
  app.add_option("--swap", network.swap_share, "share of them that come after the next")->check(Within(0.0, 1.0))->capture_default_str();
  app.add_option("--fault", faults, FaultHelp());
  app.set_version_flag("--version", "lookout-sim " + runtime::Version());
  try {
    app.parse(argc, argv);
    if (options.pcap_file.empty() && options.udp_host.empty() && options.log_file.empty())
      throw CLI::RequiredError("one of --pcap FILE, --udp HOST, --out LOG");
    if (network.drop_share + network.double_share + network.swap_share > 1.0) {
      throw CLI::ValidationError("--drop, --double and --swap: together they must not be more than 1");
    }
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  options.network.timed = options.simulation.faults = ToFaults(faults, options.seconds);
  return options;
}

}  // namespace lookout::sim
