// lookout-sim: the boat, its sensors and the water around it, as datagrams in a capture or on the network.
#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/progress.hpp"
#include "lab/sim/faulty_network.hpp"
#include "lab/sim/head_simulation.hpp"
#include "lab/sim/heads.hpp"
#include "lab/sim/log_sink.hpp"
#include "lab/sim/options.hpp"
#include "lab/sim/scene_file.hpp"
#include "lab/sim/simulation.hpp"
#include "lab/sim/sinks.hpp"
#include "lab/sim/truth.hpp"

namespace {

using namespace lookout;

constexpr int kExitUsage = 2;

// Waits until `time` by an undisturbed clock. @return whether SIGINT, SIGTERM or SIGHUP came
bool WaitUntil(std::chrono::steady_clock::time_point time, const sigset_t& stop_signals) {
  for (;;) {
    const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(time - std::chrono::steady_clock::now());
    const auto wait = std::max(rest, std::chrono::nanoseconds(0));
    const timespec timeout{wait.count() / 1'000'000'000, wait.count() % 1'000'000'000};
    if (sigtimedwait(&stop_signals, nullptr, &timeout) > 0 || io::IsStopAsked()) return true;
    if (rest <= std::chrono::nanoseconds(0)) return false;
  }
}

void Pace(sim::FaultyNetwork& network, sim::UdpSink& sink, Utime start, double speed) {
  sigset_t stop_signals;
  sigemptyset(&stop_signals);
  sigaddset(&stop_signals, SIGINT);
  sigaddset(&stop_signals, SIGTERM);
  struct sigaction hangup {};
  if (sigaction(SIGHUP, nullptr, &hangup) != 0 || hangup.sa_handler != SIG_IGN) sigaddset(&stop_signals, SIGHUP);  // under nohup the program goes on
  pthread_sigmask(SIG_BLOCK, &stop_signals, nullptr);
  sim::Schedule schedule(start, std::chrono::steady_clock::now() + (start - runtime::HostNow()), speed);
  while (const auto datagram = network.Next()) {
    if (WaitUntil(schedule.DueAt(datagram->time), stop_signals)) break;
    sink.Send(*datagram);
    if (const auto line = schedule.Report(datagram->time, std::chrono::steady_clock::now())) std::cerr << "lookout-sim: " << *line << '\n';
  }
  if (const auto summary = schedule.Summary(); !summary.empty()) std::cerr << "lookout-sim: " << summary << '\n';
  if (sink.num_refused() > 0) std::cerr << "lookout-sim: the network refused " << sink.num_refused() << " datagrams\n";
}

sim::SimulationParams ToParams(const sim::Options& options) {
  auto params = sim::ParamsOfConfig(options.config_folder, options.simulation);
  params.start = options.udp_host.empty() ? Utime(std::chrono::microseconds(options.start_utime_us)) : runtime::HostNow();
  params.duration = std::chrono::microseconds(std::llround(options.seconds * 1e6));
  return params;
}

// @throws std::invalid_argument where packets were asked of a head that has none here, or the other way round
void CheckOutputs(const sim::Options& options, const sim::Head* head) {
  if (head == nullptr) {
    if (!options.log_file.empty())
      throw std::invalid_argument("--out: is for heads without packets (--lidar); of a VLP-16 and a Puck Hi-Res --pcap has all that a log needs");
    return;
  }
  const std::string name(head->name);
  if (options.log_file.empty()) {
    throw std::invalid_argument(name + ": its packets are not simulated; --out LOG writes its scans as LIDAR_SCAN, at which a replay begins");
  }
  const auto& network = options.network;
  if (network.drop_share + network.double_share + network.swap_share > 0.0) {
    throw std::invalid_argument(name + ": its packets are not simulated: no --drop, --double, --swap");
  }
}

void RunHead(const sim::Options& options, const sim::Scene& scene, const config::BoatFacts& boat, const sim::Head& head,
             const sim::SimulationParams& params, const io::OutputOptions& outputs) {
  sim::LogSink log(options.log_file, options.config_folder, std::string(head.model),
                   "scene " + options.scene + ", seed " + std::to_string(params.seed) + ", lidar " + std::string(head.name), outputs);
  std::unique_ptr<sim::TruthWriter> truth;
  if (!options.truth_folder.empty()) truth = std::make_unique<sim::TruthWriter>(options.truth_folder, scene, boat, params.start, outputs);
  sim::HeadSimulation simulation(scene, boat, head, params, truth.get());
  if (truth) {
    for (const auto& fault : params.faults) truth->AddFault(fault);
  }
  runtime::Progress progress("lookout-sim", stderr);
  std::int64_t num_scans = 0;
  while (const auto event = simulation.Next()) {
    io::ThrowIfStopAsked();
    num_scans += std::holds_alternative<sim::HeadScan>(event->heard) ? 1 : 0;
    log.Send(*event);
    progress.Update(ToSeconds(event->time - params.start) / ToSeconds(params.duration));
  }
  std::vector<io::OutputFile*> files;
  if (truth) files = truth->Finish();
  files.push_back(&log.Finish());
  const bool is_log_on_stdout = files.back()->IsStandardOutput();
  io::CommitAll(files);
  (is_log_on_stdout ? std::cerr : std::cout) << "scans made " << num_scans << '\n';
}

void Run(const sim::Options& options) {
  const auto boat = config::LoadBoat(options.config_folder);
  const auto scene_file = sim::FindScene(options.scene, options.config_folder);
  auto scene = sim::LoadScene(scene_file, options.simulation.seed);
  scene.effects.MergeFrom(options.effects);
  if (!options.lidar.empty()) scene.lidar = options.lidar;
  const auto* head = sim::FindHead(scene.lidar);
  CheckOutputs(options, head);
  auto params = ToParams(options);
  if (scene.lidar == sim::kHiResName) params.lidar.model = vlp16::Model::kPuckHiRes;

  // Outputs before all work.
  io::OutputOptions outputs;
  outputs.force = options.force;
  outputs.inputs = io::FilesIn(options.config_folder);
  outputs.inputs.emplace_back(scene_file);
  outputs.tell = [](const std::string& line) { std::cerr << "lookout-sim: " << line << '\n'; };
  if (head != nullptr) return RunHead(options, scene, boat, *head, params, outputs);
  std::unique_ptr<sim::PcapSink> capture;
  if (options.udp_host.empty()) {
    capture = std::make_unique<sim::PcapSink>(options.pcap_file, std::vector<int>{params.data_port, params.navigation.position_port}, outputs);
  }
  std::unique_ptr<sim::TruthWriter> truth;
  if (!options.truth_folder.empty()) truth = std::make_unique<sim::TruthWriter>(options.truth_folder, scene, boat, params.start, outputs);
  sim::Simulation simulation(scene, boat, params, truth.get());
  sim::FaultyNetwork network([&] { return simulation.Next(); },
                             [&](const sim::Fault& fault) {
                               if (truth) truth->AddFault(fault);
                             },
                             options.network, params.data_port, params.start, params.start + params.duration, params.seed);
  if (truth) {
    for (const auto& fault : params.faults) truth->AddFault(fault);
  }
  if (capture) {
    runtime::Progress progress("lookout-sim", stderr);
    while (const auto datagram = network.Next()) {
      io::ThrowIfStopAsked();
      capture->Send(*datagram);
      progress.Update(ToSeconds(datagram->time - params.start) / ToSeconds(params.duration));
    }
  } else {
    sim::UdpSink sink(options.udp_host);
    std::cerr << "lookout-sim: live, begins at utime_us " << ToUtimeUs(params.start) << '\n';
    Pace(network, sink, params.start, options.speed);
  }
  std::vector<io::OutputFile*> files;
  if (truth) files = truth->Finish();
  if (capture) files.push_back(&capture->Finish());
  const bool is_capture_on_stdout = capture && files.back()->IsStandardOutput();
  io::CommitAll(files);
  const auto& totals = network.totals();
  auto& out = is_capture_on_stdout ? std::cerr : std::cout;
  out << "data packets made " << totals.num_made << ", sent " << totals.num_sent << ", dropped " << totals.num_dropped << ", doubled "
      << totals.num_doubled << ", swapped " << totals.num_swapped << '\n';
}

}  // namespace

int main(int argc, char** argv) try {
  io::CatchStopSignals();
  Run(sim::ParseOptions(argc, argv));
  return EXIT_SUCCESS;
} catch (const std::invalid_argument& error) {
  std::cerr << "lookout-sim: " << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const config::ConfigError& error) {
  std::cerr << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "lookout-sim: " << lookout::PrintableLines(error.what()) << '\n';
  return EXIT_FAILURE;
}
