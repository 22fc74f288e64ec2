// What a live run did that its inputs do not tell: replay does the same.
#pragma once

#include <map>
#include <vector>

#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/gatherer.hpp"

namespace lookout::tracker {

struct Script {
  /// Of one process, from its start to its end.
  struct Run {
    ScanKey first;
    ScanKey last;  // that is known
  };
  std::vector<Run> runs;  // in their order; at least one
  /// Taken with a scan, in their order.
  std::map<ScanKey, std::vector<Acknowledgement>> acknowledged;
};

}  // namespace lookout::tracker
