// A lidar's datagrams at a given rate into a live lookout-lidar: does it take every one, and what does that cost? Run by ./dev bench in a
// network namespace. Exit code 1 when its counters differ from what was sent.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <sstream>

#include "tests/support/counters.hpp"
#include "tests/system/ingestion.hpp"

namespace {

using namespace lookout;
using namespace lookout::system_test;

// User and system time of a process so far. proc(5): utime and stime are the 14th and 15th word of stat; the second is a name in brackets.
double CpuSeconds(int pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(in, text);
  std::istringstream words(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string word;
  for (int i = 3; i < 14; ++i) words >> word;
  double user_ticks = 0.0;
  double system_ticks = 0.0;
  words >> user_ticks >> system_ticks;
  return (user_ticks + system_ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

// Greatest resident size so far, in MB; 0 when the process is gone.
double PeakMegabytes(int pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) * 1024.0 / 1e6;
  }
  return 0.0;
}

int Run(const std::filesystem::path& folder, double packets_per_s, double seconds) {
  LiveVlp16 vlp16(folder);
  const auto before = vlp16.NextHealth();
  if (!before) {
    std::fprintf(stderr, "lookout-lidar does not report: %s\n", vlp16.process().Output().c_str());
    return EXIT_FAILURE;
  }
  const double cpu_before_s = CpuSeconds(before->pid);
  const auto started = std::chrono::steady_clock::now();
  const auto sent = SendDataPackets(packets_per_s, seconds, [&vlp16] { vlp16.Poll(); });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started;
  const double cpu_s = CpuSeconds(before->pid) - cpu_before_s;
  const double peak_megabytes = PeakMegabytes(before->pid);
  const auto after = vlp16.HealthAtRest();
  if (!after) {
    std::fprintf(stderr, "lookout-lidar reports no more: %s\n", vlp16.process().Output().c_str());
    return EXIT_FAILURE;
  }
  const auto count = [&after](std::string_view name) { return static_cast<long long>(support::CountOf(*after, name)); };
  std::printf(
      "%.0f packets/s for %.0f s: sent %lld, received %lld, lost %lld, reordered %lld, kernel drops %lld; cpu %.2f %%, peak memory %.1f MB; "
      "the sender was at worst %.1f ms late\n",
      packets_per_s, seconds, static_cast<long long>(sent.num_sent), count("data_packets_whole"), count("data_lost"), count("data_reordered"),
      count("data_kernel_drops"), 100.0 * cpu_s / elapsed.count(), peak_megabytes, std::chrono::duration<double, std::milli>(sent.latest).count());
  bool is_exact = sent.num_refused == 0;
  if (!is_exact) std::printf("the network did not take %lld packets\n", static_cast<long long>(sent.num_refused));
  for (const auto& [name, expected] : CountersOfACleanRun(sent.num_sent)) {
    if (count(name) == expected) continue;
    is_exact = false;
    std::printf("%s: %lld, should be %lld\n", std::string(name).c_str(), count(name), static_cast<long long>(expected));
  }
  return is_exact ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  double packets_per_s = 1e9 / static_cast<double>(vlp16::format::kPacketPeriodSingle.count());
  double seconds = 60.0;
  CLI::App app("Sends data packets of a VLP-16 to a lookout-lidar that it starts, and holds its counters against what was sent.");
  app.add_option("--rate", packets_per_s, "packets a second")->check(CLI::Range(1.0, 1e6))->capture_default_str();
  app.add_option("--seconds", seconds, "length")->check(CLI::Range(0.1, 86400.0))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const auto folder = std::filesystem::temp_directory_path() / ("lookout_lidar_load_" + std::to_string(getpid()));
  const int exit_code = Run(folder, packets_per_s, seconds);
  std::filesystem::remove_all(folder);
  return exit_code;
}
