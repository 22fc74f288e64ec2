// What tests of live processes share: a folder to work in, the processes, and waiting.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/log_file.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace lookout::support {

/// Payloads of a log by channel, in their order.
using Payloads = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;
inline Payloads ReadLog(const std::filesystem::path& log) {
  Payloads payloads;
  bus::LogReader reader(log);
  while (auto event = reader.Next()) payloads[event->channel].push_back(std::move(event->bytes));
  EXPECT_EQ(reader.num_damaged(), 0) << log;
  return payloads;
}

/// @return the first recording in a folder; empty when there is none
inline std::filesystem::path FirstLogIn(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".lcmlog") return entry.path();
  }
  return {};
}

/// The test works in a folder of its own, which holds a copy of config/demo; the recorder makes its logs/ there. Processes end with the test.
class LiveTest : public ::testing::Test {
 protected:
  LiveTest() {
    std::filesystem::copy(kDemoConfig, folder_ / "config");
    std::filesystem::current_path(folder_);
  }
  ~LiveTest() override { std::filesystem::current_path(start_folder_); }
  void TearDown() override { children_.clear(); }

  std::string Config() const { return (folder_ / "config").string(); }
  /// Where a process prints to.
  std::string Output(const std::string& name) const { return (folder_ / (name + ".out")).string(); }

  /// Starts lookout-NAME with the copy of config/demo.
  void Start(const std::string& name, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {Bin(name), "--config", Config()});
    children_[name] = std::make_unique<Child>(options, Output(name));
  }

  template <typename Condition>
  static bool WaitUntil(const Condition& is_true, std::chrono::seconds timeout = std::chrono::seconds(30)) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!is_true() && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return is_true();
  }

  TempDir folder_;
  std::filesystem::path start_folder_ = std::filesystem::current_path();
  std::map<std::string, std::unique_ptr<Child>> children_;
};

}  // namespace lookout::support
