#include "common/runtime/process.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <pthread.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <spdlog/pattern_formatter.h>
#include <spdlog/spdlog.h>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/health.hpp"
#include "common/runtime/version.hpp"

namespace lookout::runtime {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kHealthPeriod(1000);
// How late messages that are held for a second publisher's sake may be handed out.
constexpr std::chrono::milliseconds kReleasePeriod(100);
// Memory of a burst, as when a process stood still or a disk was slow, goes back to the system: a large block when it is freed (glibc would raise the
// size from which it does so), pages between small blocks now and then. Otherwise each process keeps its worst burst.
constexpr int kLargeBlockBytes = 64 * 1024;
constexpr std::chrono::seconds kTrimPeriod(10);
// Messages handled before sockets and timers get their turn again.
constexpr int kMaxMessagesPerRound = 64;

sigset_t StopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGHUP);
  return signals;
}

// At the end arrived messages are still handled, until nothing comes for a moment: the publishers may have ended just before this process, and their
// last messages are on their way through a thread of LCM. Other publishers may go on, so it is bounded.
constexpr std::chrono::milliseconds kLastSilence(20);
constexpr std::chrono::milliseconds kLastTime(300);

// Goes before anything that starts a thread (LCM does): threads inherit the blocked signals.
std::string Prepared(const std::string& lcm_url) {
  BlockStopSignals();
  mallopt(M_MMAP_THRESHOLD, kLargeBlockBytes);
  std::signal(SIGPIPE, SIG_IGN);  // a log that nobody reads any more does not end a look-out
  return lcm_url;
}

// A terminal that controls this process, and is still there.
bool HasTerminal() {
  const int descriptor = open("/dev/tty", O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor >= 0) close(descriptor);
  return descriptor >= 0;
}

class PrintableText final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    const auto text = PrintableLines(std::string_view(message.payload.data(), message.payload.size()));
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<PrintableText>(); }
};

}  // namespace

void BlockStopSignals() {
  const sigset_t signals = StopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

Utime HostNow() { return std::chrono::time_point_cast<std::chrono::microseconds>(std::chrono::system_clock::now()); }

std::chrono::steady_clock::time_point SteadyNow() { return Clock::now(); }

std::string HostName() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

struct Process::Implementation {
  struct Timer {
    Clock::duration period;
    Clock::time_point next;
    std::function<void()> handler;
  };
  struct Readable {
    int file_descriptor;
    std::function<void()> handler;
  };

  std::string name;
  int signals = -1;
  bool is_stopping = false;
  bool is_report_due = false;
  bool had_terminal = HasTerminal();
  bool is_hangup_ignored = io::IsIgnored(SIGHUP);
  std::vector<Timer> timers;
  std::vector<Readable> readables;
  std::function<void()> on_hangup;

  void OnSignal(const signalfd_siginfo& info) {
    const bool is_hangup = info.ssi_signo == SIGHUP;
    if (is_hangup && is_hangup_ignored) return;  // blocked signals come even so
    // A shell passes the hangup of its terminal on to its jobs: that is no request either.
    const bool is_terminal_gone = info.ssi_code == SI_KERNEL || (had_terminal && !HasTerminal());
    if (is_hangup && !is_terminal_gone && on_hangup) {
      on_hangup();
      return;
    }
    spdlog::info("stops on signal {}", info.ssi_signo);
    is_stopping = true;
  }

  std::chrono::milliseconds UntilNextTimer() const {
    auto next = Clock::now() + std::chrono::seconds(1);
    for (const auto& timer : timers) next = std::min(next, timer.next);
    return std::max(std::chrono::milliseconds(0), std::chrono::ceil<std::chrono::milliseconds>(next - Clock::now()));
  }

  void RunTimers() {
    for (auto& timer : timers) {
      const auto now = Clock::now();
      if (now < timer.next) continue;
      timer.next = std::max(timer.next + timer.period, now);
      timer.handler();
    }
  }
};

Process::Process(const std::string& name, const std::string& lcm_url) : bus_(Prepared(lcm_url)), implementation_(std::make_unique<Implementation>()) {
  bus_.GuardStreams([] { return Clock::now().time_since_epoch(); });
  const sigset_t signals = StopSignals();
  implementation_->name = name;
  implementation_->signals = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
  if (implementation_->signals < 0) throw std::runtime_error("signalfd failed");
}

Process::~Process() {
  if (implementation_->signals >= 0) close(implementation_->signals);
}

void Process::OnReadable(int file_descriptor, std::function<void()> handler) {
  implementation_->readables.push_back({file_descriptor, std::move(handler)});
}

void Process::Every(std::chrono::milliseconds period, std::function<void()> handler) {
  implementation_->timers.push_back({period, Clock::now() + period, std::move(handler)});
}

void Process::OnHangup(std::function<void()> handler) { implementation_->on_hangup = std::move(handler); }

void Process::ReportNow() { implementation_->is_report_due = true; }

void Process::Stop() { implementation_->is_stopping = true; }

void Process::Run(const std::function<HealthReport()>& report) {
  auto& self = *implementation_;
  HealthReporter reporter(self.name);
  Every(kHealthPeriod, [&] {
    const auto health = reporter.Make(HostNow(), report(), bus_);
    bus::Publish(bus_, bus::kHealth, health);
    NotifyAlive(health);
  });
  Every(kReleasePeriod, [this] { bus_.ReleaseHeld(); });
  Every(kTrimPeriod, [] { malloc_trim(0); });
  NotifyReady();
  spdlog::info("starts, version {}", Version());
  while (!self.is_stopping) {
    std::vector<pollfd> descriptors{{self.signals, POLLIN, 0}, {bus_.file_descriptor(), POLLIN, 0}};
    for (const auto& readable : self.readables) descriptors.push_back({readable.file_descriptor, POLLIN, 0});
    if (poll(descriptors.data(), descriptors.size(), static_cast<int>(self.UntilNextTimer().count())) < 0 && errno != EINTR) {
      throw std::runtime_error("poll failed");
    }
    if (descriptors[0].revents != 0) {
      signalfd_siginfo info{};
      if (read(self.signals, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
        self.OnSignal(info);
      }
    }
    for (std::size_t i = 0; i < self.readables.size() && !self.is_stopping; ++i) {
      if (descriptors[i + 2].revents != 0) self.readables[i].handler();
    }
    for (int i = 0; i < kMaxMessagesPerRound && descriptors[1].revents != 0 && !self.is_stopping; ++i) {
      if (!bus_.HandleOnce(std::chrono::milliseconds(0))) break;
    }
    if (!self.is_stopping) self.RunTimers();
    if (std::exchange(self.is_report_due, false)) bus::Publish(bus_, bus::kHealth, reporter.MakeBetween(HostNow(), report()));
  }
  const auto end = Clock::now() + kLastTime;
  while (Clock::now() < end && bus_.HandleOnce(kLastSilence)) {
  }
  bus_.ReleaseHeld(true);
  const auto last_report = report();
  for (const auto& counter : last_report.counters) {
    if (counter.count > 0) spdlog::info("{}: {}", counter.name, counter.count);
  }
}

void SetLogPattern(const std::string& pattern, bool is_utc) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>(is_utc ? spdlog::pattern_time_type::utc : spdlog::pattern_time_type::local);
  formatter->add_flag<PrintableText>('v').set_pattern(pattern);
  spdlog::set_formatter(std::move(formatter));
}

int RunMain(const std::string& name, const std::function<void()>& body) try {
  SetLogPattern("%Y-%m-%dT%H:%M:%S.%eZ %^%l%$ " + name + ": %v", true);
  body();
  std::cout.flush();
  if (!std::cout || std::fflush(stdout) != 0) throw std::runtime_error("standard output could not be written");
  return EXIT_SUCCESS;
} catch (const config::ConfigError& error) {
  for (const auto& fault : error.faults()) spdlog::critical("{}", fault);
  return 2;
} catch (const std::exception& error) {
  spdlog::critical("{}", error.what());
  return EXIT_FAILURE;
}

}  // namespace lookout::runtime
