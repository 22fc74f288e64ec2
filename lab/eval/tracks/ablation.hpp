// Ablation: the same runs with each part of the boat's tracker left out.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/memory_bus.hpp"
#include "common/core/bytes.hpp"
#include "services/tracker/service.hpp"

namespace lookout::eval {

struct Ablation {
  std::string name;  // in tables: "without ledger"
  tracker::Without without;
};

/// One for each part.
std::vector<Ablation> Ablations();

/// The tracker process without some of its parts, beside a chain of all services: it reads the messages of the chain's bus, and publishes for itself.
class AblatedTracker {
 public:
  /// @param on_tracks  called with each message of TRACKS
  AblatedTracker(tracker::Params params, const tracker::Without& without, std::function<void(Bytes)> on_tracks);

  /// A message of the chain. Its own messages that follow are handed out before this returns.
  void Add(std::string_view channel, Bytes bytes);
  /// End of input.
  void Finish();

 private:
  void HandleAll();

  bus::MemoryBus bus_;
  tracker::Service service_;
};

}  // namespace lookout::eval
