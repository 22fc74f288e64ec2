#include "common/io/stop_signal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>

namespace lookout::io {

namespace {

std::atomic<int> stop_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free, "it is set by a signal handler");

constexpr unsigned kKickPeriodS = 1;

// A signal that comes between the look at the flag and a call that blocks interrupts nothing: an alarm does, again and again until the program ends.
extern "C" void OnStopSignal(int signal) {
  int none = 0;
  stop_signal.compare_exchange_strong(none, signal);
  alarm(kKickPeriodS);
}

// The next signal ends a program that does not look. Not the second at once: some senders (timeout) send each signal twice.
extern "C" void OnAlarm(int /*signal*/) {
  const int error_number = errno;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler != OnStopSignal) continue;
    action.sa_handler = SIG_DFL;
    sigaction(signal, &action, nullptr);
  }
  errno = error_number;
  alarm(kKickPeriodS);
}

// Without SA_RESTART: calls that block end with EINTR. A program may be started with signals blocked.
void Catch(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, signal);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

// An output would get the number of a standard stream that is closed, and the program's own lines would be written into it. The descriptor that is
// opened instead lets input and output fail, as the closed one did; lines for people go nowhere.
void OpenStandardStreams() {
  constexpr std::array<int, 3> kModes{O_WRONLY, O_RDONLY, O_WRONLY};
  for (int i = 0; i < static_cast<int>(kModes.size()); ++i) {
    if (fcntl(i, F_GETFD) < 0 && errno == EBADF) open("/dev/null", kModes.at(static_cast<std::size_t>(i)));  // the lowest number that is free: this
  }
}

}  // namespace

bool IsIgnored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

void CatchStopSignals() {
  OpenStandardStreams();
  Catch(SIGALRM, OnAlarm);
  Catch(SIGINT, OnStopSignal);
  Catch(SIGTERM, OnStopSignal);
  if (!IsIgnored(SIGHUP)) Catch(SIGHUP, OnStopSignal);
  Catch(SIGPIPE, SIG_IGN);
  Catch(SIGXFSZ, SIG_IGN);
}

bool IsStopAsked() { return stop_signal != 0; }

void ThrowIfStopAsked() {
  if (const int signal = stop_signal; signal != 0) throw Stopped(std::string("stopped by SIG") + sigabbrev_np(signal));
}

}  // namespace lookout::io
