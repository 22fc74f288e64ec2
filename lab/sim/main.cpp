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
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/progress.hpp"
#include "lab/sim/faulty_network.hpp"
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
  if (sigaction(SIGHUP, nullptr, &hangup) != 0 || hangup.sa_handler != SIG_IGN) sigaddset(&stop_signals, SIGHUP);  // nohup: it goes on
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

void Run(const sim::Options& options) {
  const auto boat = config::LoadBoat(options.config_folder);
  const auto scene_file = sim::FindScene(options.scene, options.config_folder);
  auto scene = sim::LoadScene(scene_file, options.simulation.seed);
  scene.effects.MergeFrom(options.effects);
  const auto params = ToParams(options);

  // Outputs before all work.
  io::OutputOptions outputs;
  outputs.force = options.force;
  outputs.inputs = io::FilesIn(options.config_folder);
  outputs.inputs.emplace_back(scene_file);
  outputs.tell = [](const std::string& line) { std::cerr << "lookout-sim: " << line << '\n'; };
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
