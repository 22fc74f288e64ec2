// Actions of a live run that its inputs do not tell. A replay reads them in ALERTS, and does the same.
#pragma once

#include <map>
#include <vector>

#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/order.hpp"

namespace lookout::tracker {

struct Script {
  /// Scans that one process used while time went on. Where time goes back, a process has another stretch.
  struct Stretch {
    ScanKey begin;  // the first scan that the process used
    ScanKey first;  // of the stretch
    ScanKey last;   // of the stretch, as far as the log tells
  };
  std::vector<Stretch> stretches;  // in their order; at least one
  /// Applied with that scan, in their order.
  std::map<ScanKey, std::vector<Acknowledgement>> acknowledged;
  std::map<ScanKey, std::vector<Order>> orders;
};

}  // namespace lookout::tracker
