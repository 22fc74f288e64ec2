// Programs under test as child processes, ended when the test ends.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

extern char** environ;

namespace lookout::support {

class Child {
 public:
  /// Starts a program; what it prints goes to `output_file`.
  Child(const std::vector<std::string>& command, std::string output_file) : output_file_(std::move(output_file)) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, output_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    std::vector<char*> arguments;
    for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    // Whatever started the tests may ignore signals (nohup, a shell's background).
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGHUP, SIGINT, SIGTERM}) sigaddset(&signals, signal);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    if (posix_spawnp(&pid_, arguments[0], &actions, &attributes, arguments.data(), environ) != 0) pid_ = -1;
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (IsRunning()) {
      kill(pid_, SIGKILL);
      Wait(std::chrono::seconds(5));
    }
  }

  void Signal(int signal) const {
    if (pid_ > 0 && !exit_code_) kill(pid_, signal);
  }

  pid_t pid() const { return pid_; }

  bool IsRunning() { return pid_ > 0 && !Wait(std::chrono::milliseconds(0)); }

  /// @return the exit code, 128 + signal when a signal ended it; nullopt when it runs on
  std::optional<int> Wait(std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (pid_ > 0 && !exit_code_) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      } else if (std::chrono::steady_clock::now() >= deadline) {
        return std::nullopt;
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    }
    return exit_code_;
  }

  /// SIGTERM and wait.
  std::optional<int> Terminate() {
    Signal(SIGTERM);
    return Wait(std::chrono::seconds(20));
  }

  std::string Output() const {
    std::ifstream in(output_file_);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }

 private:
  std::string output_file_;
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

/// Runs a program to its end, at most two minutes.
struct RunResult {
  int exit_code;
  std::string output;
};
inline RunResult RunProgram(const std::vector<std::string>& command, const std::string& output_file) {
  Child child(command, output_file);
  const auto exit_code = child.Wait(std::chrono::seconds(120));
  return {exit_code.value_or(-1), child.Output()};
}

}  // namespace lookout::support
