// lookout-top: the bus on one screen of a terminal.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <stdexcept>
#include <string>

#include "common/bus/lcm_bus.hpp"
#include "common/core/printable.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/version.hpp"
#include "tools/top/board.hpp"
#include "tools/top/screen.hpp"
#include "tools/top/terminal.hpp"

namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  bool once = false;
  double once_s = 3.0;  // the last three of HEALTH, thirty scans
  bool sure_only = false;
  bool shows_obstacles = false;
  std::string lcm_url;
};

Options ParseOptions(int argc, char** argv) {
  Options options;
  CLI::App app("Shows channels, processes and the nearest obstacles in a terminal. Keys: q quits, s shows sure obstacles only or all, c counts anew.",
               "lookout-top");
  app.add_flag("--once", options.once, "listen for --seconds, print one screen as text, exit");
  app.add_option("--seconds", options.once_s, "how long --once listens (1 to 3600)")->check(CLI::Range(1.0, 3600.0))->capture_default_str();
  app.add_flag("--obstacles", options.shows_obstacles, "obstacles of the latest scan, also where there is a tracker");
  app.add_flag("--sure", options.sure_only, "only obstacles that the segmenter is sure of");
  app.add_option("--lcm-url", options.lcm_url, "LCM address (else the environment's LCM_DEFAULT_URL, else this computer only)");
  app.set_version_flag("--version", "lookout-top " + lookout::runtime::Version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : 2);
  }
  if (options.lcm_url.empty()) options.lcm_url = lookout::bus::DefaultLcmUrl();
  if (const auto fault = lookout::bus::LcmUrlFault(options.lcm_url); !fault.empty()) {
    std::cerr << "lookout-top: " << fault << "\n";
    std::exit(2);
  }
  return options;
}

// Stop signals as a descriptor.
class StopSignals {
 public:
  StopSignals() {
    lookout::runtime::BlockStopSignals();
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    descriptor_ = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
    if (descriptor_ < 0) throw std::runtime_error("signalfd failed");
  }
  ~StopSignals() { close(descriptor_); }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

// A bus and its messages.
class Listener {
 public:
  explicit Listener(const std::string& lcm_url) : bus_(lcm_url), board_(Clock::now()) {
    bus_.SubscribeAll([this](std::string_view channel, lookout::Bytes bytes) { board_.Take(channel, bytes, Clock::now()); });
  }

  /// Waits for messages, stop signals and (where asked) keys, at most for so long, and handles the messages that are there.
  /// @return false when it is to stop
  bool Wait(const StopSignals& signals, bool with_keys, std::chrono::milliseconds timeout) {
    std::array<pollfd, 3> descriptors{
        {{signals.descriptor(), POLLIN, 0}, {bus_.file_descriptor(), POLLIN, 0}, {with_keys ? STDIN_FILENO : -1, POLLIN, 0}}};
    // A signal that was not blocked (a terminal of another size) ends the wait early, as a message does.
    if (poll(descriptors.data(), descriptors.size(), static_cast<int>(timeout.count())) < 0) return errno == EINTR;
    if (descriptors[0].revents != 0 || (descriptors[2].revents & (POLLHUP | POLLERR)) != 0) return false;
    // Not for ever: keys must be read whatever the load.
    constexpr int kMaxMessages = 256;
    for (int i = 0; i < kMaxMessages && descriptors[1].revents != 0; ++i) {
      if (!bus_.HandleOnce(std::chrono::milliseconds(0))) break;
    }
    return true;
  }

  void CountAnew() { board_.CountAnew(); }
  const lookout::top::Board& board() const { return board_; }

 private:
  lookout::bus::LcmBus bus_;
  lookout::top::Board board_;
};

std::string Title(const std::string& lcm_url) {
  const auto now = std::chrono::system_clock::to_time_t(lookout::runtime::HostNow());
  return fmt::format("lookout-top {}   {:%Y-%m-%d %H:%M:%S} UTC   {}", lookout::runtime::Version(), fmt::gmtime(now), lookout::Printable(lcm_url));
}

void PrintOnce(const Options& options) {
  const StopSignals signals;
  Listener listener(options.lcm_url);
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.once_s));
  while (Clock::now() < end) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    if (!listener.Wait(signals, false, std::max(left, std::chrono::milliseconds(0)))) return;
  }
  const auto rows = lookout::top::DrawScreen(listener.board(), Title(options.lcm_url), Clock::now(),
                                             {.sure_only = options.sure_only, .has_tracks = !options.shows_obstacles});
  fmt::print("{}", lookout::top::PlainText(rows));
}

void Watch(const Options& options) {
  constexpr std::chrono::milliseconds kFramePeriod(250);  // as fast as one can read
  const StopSignals signals;
  Listener listener(options.lcm_url);
  lookout::top::Terminal terminal;
  bool sure_only = options.sure_only;
  bool has_tracks = !options.shows_obstacles;
  auto next_frame = Clock::now();
  while (true) {
    bool is_changed = false;
    for (int key = terminal.Key(); key != 0; key = terminal.Key()) {
      if (key == 'q' || key == 'Q') return;
      if (key == 'c') listener.CountAnew();
      if (key == 's') sure_only = !sure_only;
      if (key == 't') has_tracks = !has_tracks;
      is_changed = true;
    }
    if (is_changed || Clock::now() >= next_frame) {
      terminal.Show(lookout::top::DrawScreen(listener.board(), Title(options.lcm_url), Clock::now(),
                                             {terminal.width(), terminal.height(), sure_only, has_tracks}));
      next_frame = Clock::now() + kFramePeriod;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_frame - Clock::now());
    if (!listener.Wait(signals, true, std::max(left, std::chrono::milliseconds(0)))) return;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = ParseOptions(argc, argv);
  // The screen goes to stdout, all else to stderr.
  spdlog::set_default_logger(spdlog::stderr_color_st("top"));
  return lookout::runtime::RunMain("top", [&options] {
    lookout::runtime::SetLogPattern("%^%l%$ lookout-top: %v");
    options.once ? PrintOnce(options) : Watch(options);
  });
}
