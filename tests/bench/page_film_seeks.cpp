// How long a page waits for a log: the index made, the index read, and moments anywhere in it.
//   film_page LOG...: prints a table; writes LOG.index beside each log, in the place of one that is there
// The logs are put out of the memory of the kernel before the index is made, and before the moments are asked for.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "services/page/film/film.hpp"
#include "services/page/film/index_file.hpp"

namespace {

using namespace lookout;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kMoments = 200;

double SecondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// Resident now, and at most since the start.
long StatusKb(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return std::strtol(line.c_str() + key.size(), nullptr, 10);
  }
  return -1;
}

void Forget(const std::vector<fs::path>& files) {
  for (const auto& file : files) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) continue;
    fdatasync(descriptor);
    posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
    close(descriptor);
  }
}

std::unique_ptr<page::Film> Open(const std::vector<fs::path>& logs, const char* what) {
  const auto begin = Clock::now();
  page::FilmOptions options;
  options.logs = logs;
  auto film = std::make_unique<page::Film>(options);
  film->Wait();
  std::printf("| %s | %.3f s |\n", what, SecondsSince(begin));
  return film;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<fs::path> logs(argv + 1, argv + argc);
  if (logs.empty()) return 2;
  for (const auto& log : logs) fs::remove(page::IndexFileOf(log));
  Forget(logs);
  Open(logs, "index made");
  Forget(logs);
  const auto film = Open(logs, "index read");
  page::At request;
  for (std::size_t i = 0; i < bus::kChannels.size(); ++i) request.channels.push_back(static_cast<page::ChannelIndex>(i));
  request.scan_time = Utime(std::chrono::microseconds(kMinUtimeUs));
  const auto first = film->Find(request);
  request.scan_time = Utime(std::chrono::microseconds(kMaxUtimeUs));
  const auto last = film->Find(request);
  request.scan_time.reset();
  std::minstd_rand random(1);
  std::vector<double> times;
  std::size_t num_bytes = 0;
  for (int i = 0; i < kMoments; ++i) {
    const auto share = static_cast<double>(random()) / static_cast<double>(std::minstd_rand::max());
    request.time = first.time + std::chrono::microseconds(static_cast<std::int64_t>(share * static_cast<double>((last.time - first.time).count())));
    const auto begin = Clock::now();
    const auto answer = film->Find(request);
    times.push_back(SecondsSince(begin));
    for (const auto& message : answer.messages) num_bytes += message.bytes.size();
  }
  std::ranges::sort(times);
  std::printf("| moment, median of %d | %.4f s |\n| moment, slowest | %.4f s |\n", kMoments, times[kMoments / 2], times.back());
  std::printf("| messages of a moment | %.0f kB |\n| scans | %lld |\n", static_cast<double>(num_bytes) / kMoments / 1e3,
              static_cast<long long>(last.num_scans));
  page::StripRequest strip;
  strip.from = first.time;
  strip.to = last.time;
  strip.num_buckets = 1000;
  const auto begin = Clock::now();
  const auto text = film->Strip(strip);
  std::printf("| strip of the whole, 1000 buckets, %zu kB | %.4f s |\n", text.size() / 1000, SecondsSince(begin));
  std::printf("| resident, at most | %ld MB, %ld MB |\n", StatusKb("VmRSS:") / 1024, StatusKb("VmHWM:") / 1024);
  return 0;
}
