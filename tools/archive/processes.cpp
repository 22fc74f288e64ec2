#include "tools/archive/processes.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <thread>

#include "common/io/output_file.hpp"

namespace lookout::archive {

namespace {

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (auto& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> EnvironmentWith(const std::map<std::string, std::string>& added) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text(*entry);
    if (!added.contains(text.substr(0, text.find('=')))) all.push_back(text);
  }
  for (const auto& [name, value] : added) {
    all.push_back(name);
    all.back().append("=").append(value);
  }
  return all;
}

}  // namespace

Processes::~Processes() {
  for (const auto process : running_) ::kill(-process, SIGTERM);
  for (const auto process : running_) {
    while (::waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

void Processes::Start(const std::vector<std::string>& arguments, const std::map<std::string, std::string>& environment) {
  auto words = arguments;
  auto variables = EnvironmentWith(environment);
  const auto word_pointers = Pointers(words);
  const auto variable_pointers = Pointers(variables);
  const auto parent = ::getpid();
  const auto child = ::fork();
  if (child < 0) throw std::runtime_error("a process cannot be started: " + io::ErrnoText());
  if (child == 0) {
    constexpr int kNoProgram = 127;
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int none = ::open("/dev/null", O_RDONLY);
    if (::getppid() == parent && none >= 0 && ::dup2(none, STDIN_FILENO) >= 0)
      ::execve(word_pointers[0], word_pointers.data(), variable_pointers.data());
    ::_exit(kNoProgram);
  }
  ::setpgid(child, child);  // here too: the child may not have come so far when it is to end
  running_.push_back(child);
}

void Processes::WaitForOne(std::chrono::milliseconds at_most) {
  constexpr std::chrono::milliseconds kStep(5);
  const auto end = std::chrono::steady_clock::now() + at_most;
  do {
    const auto before = running_.size();
    std::erase_if(running_, [](pid_t process) { return ::waitpid(process, nullptr, WNOHANG) > 0; });
    if (running_.size() < before) return;
    std::this_thread::sleep_for(kStep);
  } while (std::chrono::steady_clock::now() < end);
}

}  // namespace lookout::archive
