// A process that shows tracks and alerts, on a live bus with a scene on it.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "lookout/alert_ack_t.hpp"
#include "lookout/health_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/plotter_scene.hpp"

namespace lookout::support {

class LiveScene : public ::testing::Test {
 protected:
  LiveScene() {
    std::filesystem::copy(kDemoConfig, folder_ / "config");
    bus::Subscribe<health_t>(bus_, bus::kHealth, [this](const health_t& message) { health_ = message; });
    bus::Subscribe<alert_ack_t>(bus_, bus::kAlertAck, [this](const alert_ack_t& message) { acknowledged_.push_back(message); });
  }

  /// Starts lookout-NAME with the copy of config/demo; what it prints goes to a file of this name.
  void Start(const std::string& name, const std::string& output = "out") {
    child_ = std::make_unique<Child>(std::vector<std::string>{Bin(name), "--config", (folder_ / "config").string()}, (folder_ / output).string());
  }
  /// A scan every 100 ms, until it is so.
  template <typename Condition>
  bool Until(const Condition& is_so, std::chrono::seconds longest = std::chrono::seconds(30)) {
    return SendUntil(
        bus_, is_so, [this] { scene_.SendScan(); }, longest);
  }
  bool Runs() {
    return Until([this] { return health_.pid != 0; });
  }

  TempDir folder_;
  bus::LcmBus bus_{bus::DefaultLcmUrl()};
  PlotterScene scene_{bus_};
  health_t health_{};
  std::vector<alert_ack_t> acknowledged_;
  std::unique_ptr<Child> child_;
};

}  // namespace lookout::support
