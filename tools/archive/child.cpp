#include "tools/archive/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "common/core/printable.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"

namespace lookout::archive {

namespace {

constexpr std::size_t kMostOutBytes = 1024UL * 1024;
constexpr std::size_t kMostErrorBytes = 64UL * 1024;
constexpr int kExitNotStarted = 127;
constexpr std::size_t kMostStopLetters = 200;  // most letters of a line that says which signal ended a program

struct Pipe {
  int read_end = -1;
  int write_end = -1;
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("a pipe cannot be made: " + io::ErrnoText());
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    Close(read_end);
    Close(write_end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  static void Close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
};

// In the child: calls of the system alone.
[[noreturn]] void Become(char* const* arguments, const char* folder, const Pipe& out, const Pipe& error, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kExitNotStarted);
  const int none = ::open("/dev/null", O_RDONLY);
  if (none < 0 || ::dup2(none, STDIN_FILENO) < 0 || ::dup2(out.write_end, STDOUT_FILENO) < 0 || ::dup2(error.write_end, STDERR_FILENO) < 0 ||
      ::chdir(folder) != 0) {
    ::_exit(kExitNotStarted);
  }
  ::execv(arguments[0], arguments);
  constexpr std::string_view kWhy = "the program cannot be started\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kWhy.data(), kWhy.size());
  ::_exit(kExitNotStarted);
}

// @return false at its end
bool ReadSome(int descriptor, std::string& text, std::size_t most_bytes, bool keeps_end) {
  std::array<char, 16384> piece{};
  const auto size = ::read(descriptor, piece.data(), piece.size());
  if (size < 0) return errno == EINTR;
  if (size == 0) return false;
  text.append(piece.data(), static_cast<std::size_t>(size));
  if (text.size() > most_bytes) {
    if (keeps_end) {
      text.erase(0, text.size() - most_bytes);
    } else {
      text.resize(most_bytes);
    }
  }
  return true;
}

void ReadBoth(Pipe& out, Pipe& error, ChildEnd& end) {
  constexpr int kLookMs = 200;  // for signals
  while (out.read_end >= 0 || error.read_end >= 0) {
    io::ThrowIfStopAsked();
    std::array<pollfd, 2> waited{{{out.read_end, POLLIN, 0}, {error.read_end, POLLIN, 0}}};
    if (::poll(waited.data(), waited.size(), kLookMs) <= 0) continue;
    if (waited[0].revents != 0 && !ReadSome(out.read_end, end.out, kMostOutBytes, false)) Pipe::Close(out.read_end);
    if (waited[1].revents != 0 && !ReadSome(error.read_end, end.error, kMostErrorBytes, true)) Pipe::Close(error.read_end);
  }
}

double Seconds(const timeval& time) {
  constexpr double kUsPerS = 1e6;
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / kUsPerS;
}

void Wait(pid_t child, ChildEnd& end) {
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0) {
    if (errno != EINTR) throw std::runtime_error("a child cannot be waited for: " + io::ErrnoText());
  }
  if (WIFSIGNALED(status)) {
    end.signal = WTERMSIG(status);
  } else {
    end.exit_code = WEXITSTATUS(status);
  }
  constexpr std::int64_t kBytesPerKb = 1024;
  end.cpu_s = Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
  end.peak_bytes = usage.ru_maxrss * kBytesPerKb;
}

}  // namespace

bool ChildEnd::WasKilled() const { return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGXCPU; }

std::string ChildEnd::StoppedBy() const {
  static const std::regex kForm("(?:^|.*[: ])stopped by (SIG[A-Z0-9]+) *");
  if (exit_code == 0) return "";
  std::istringstream lines(error);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() <= kMostStopLetters && std::regex_match(line, match, kForm)) return match[1];
  }
  return "";
}

std::string ChildEnd::LastLine() const {
  std::string_view text(error);
  while (!text.empty()) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
    const auto begin = text.find_last_of('\n');
    const auto line = begin == std::string_view::npos ? text : text.substr(begin + 1);
    if (!line.empty()) return PrintableLines(line);
    text = begin == std::string_view::npos ? std::string_view() : text.substr(0, begin);
  }
  return "";
}

std::string ChildEnd::FaultOfComputer() const {
  if (exit_code == kExitNotStarted) return "a program of --programs cannot be started";
  for (const auto* text : {"No space left on device", "Disk quota exceeded", "Input/output error", "Stale file handle", "Cannot allocate memory",
                           "bad_alloc", "Too many open files", "Transport endpoint is not connected", "Read-only file system", "Permission denied",
                           "Connection timed out", "Remote I/O error", "File too large"}) {
    if (error.find(text) != std::string::npos) return text;
  }
  return "";
}

ChildEnd RunChild(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  std::vector<std::string> words(arguments);
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  Pipe out;
  Pipe error;
  const auto begin = std::chrono::steady_clock::now();
  const auto parent = ::getpid();
  const auto child = ::fork();
  if (child < 0) throw std::runtime_error("a child cannot be started: " + io::ErrnoText());
  if (child == 0) Become(pointers.data(), folder.c_str(), out, error, parent);
  Pipe::Close(out.write_end);
  Pipe::Close(error.write_end);
  ChildEnd end;
  try {
    ReadBoth(out, error, end);
  } catch (...) {
    ::kill(child, SIGKILL);
    Wait(child, end);
    throw;
  }
  Wait(child, end);
  end.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return end;
}

}  // namespace lookout::archive
