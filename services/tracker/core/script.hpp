// Actions of a live run that its inputs do not tell: replay does the same.
#pragma once

#include <map>
#include <vector>

#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/order.hpp"

namespace lookout::tracker {

struct Script {
  /// Scans that one process used while time went on. A process has another stretch where time goes back.
  struct Stretch {
    ScanKey begin;  // at which the process began
    ScanKey first;
    ScanKey last;  // that is known
  };
  std::vector<Stretch> stretches;  // in their order; at least one
  /// Taken with a scan, in their order.
  std::map<ScanKey, std::vector<Acknowledgement>> acknowledged;
  std::map<ScanKey, std::vector<Order>> orders;
};

}  // namespace lookout::tracker
