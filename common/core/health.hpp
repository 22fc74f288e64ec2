// What a service says of itself once a second; the shell adds rates, latency, cpu and memory and sends it as HEALTH.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lookout {

/// A named count since the start of the process. Each kind of refusal has its own.
struct Counter {
  std::string_view name;  // snake_case, a literal
  std::int64_t count = 0;
};

enum class HealthState { kOk = 0, kDegraded = 1, kFailed = 2 };

struct HealthReport {
  HealthState state = HealthState::kOk;
  std::string reason;  // why it is not OK
  std::vector<Counter> counters;
};

}  // namespace lookout
