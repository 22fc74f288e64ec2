// State, reason and counters of a service, once a second; the shell adds rates, latency, cpu and memory and sends them as HEALTH.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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

/// Counts that are known by their names in HEALTH.
///
/// @tparam kNames  a std::array of names, in the order in which HEALTH shows them. Another name in [] does not compile.
template <const auto& kNames>
class Counts {
 public:
  struct Name {
    consteval Name(const char* name) : index(std::ranges::find(kNames, std::string_view(name)) - kNames.begin()) { kNames.at(index); }
    std::size_t index;
  };

  std::int64_t& operator[](Name name) { return counts_[name.index]; }
  std::int64_t operator[](Name name) const { return counts_[name.index]; }

  /// @param name  one of kNames
  void Add(std::string_view name) { ++counts_.at(static_cast<std::size_t>(std::ranges::find(kNames, name) - kNames.begin())); }

  void AppendTo(std::vector<Counter>& counters) const {
    for (std::size_t i = 0; i < kNames.size(); ++i) counters.push_back({kNames[i], counts_[i]});
  }

 private:
  std::array<std::int64_t, kNames.size()> counts_{};
};

enum class HealthState { kOk = 0, kDegraded = 1, kFailed = 2 };

struct HealthReport {
  HealthState state = HealthState::kOk;
  std::string reason;  // why it is not OK
  std::vector<Counter> counters;

  /// One more reason why it is degraded. A failed service stays failed.
  void Degrade(std::string_view why, std::string_view separator = "; ") {
    state = std::max(state, HealthState::kDegraded);
    if (!reason.empty()) reason += separator;
    reason += why;
  }
};

}  // namespace lookout
