// Counters by their names, wherever they stand.
#pragma once

#include <cstdint>
#include <gtest/gtest.h>
#include <string_view>

namespace lookout::support {

template <typename T>
concept IsHealth = requires(const T& message) {
  message.num_counters;
};

/// @return the count of the counter of this name in HEALTH; -1 where there is none, as before HEALTH has come
std::int64_t CountOf(const IsHealth auto& health, std::string_view name) {
  for (const auto& counter : health.counters) {
    if (counter.name == name) return counter.count;
  }
  return -1;
}

/// The same of counters, of a HealthReport, or of whatever has counters() or makes a Report(); that there is none fails the test.
template <typename T>
requires(!IsHealth<T>) std::int64_t CountOf(T&& of, std::string_view name) {
  if constexpr (requires { of.Report(); }) {
    return CountOf(of.Report(), name);
  } else if constexpr (requires { of.counters(); }) {
    return CountOf(of.counters(), name);
  } else if constexpr (requires { of.counters; }) {
    return CountOf(of.counters, name);
  } else {
    for (const auto& counter : of) {
      if (counter.name == name) return counter.count;
    }
    ADD_FAILURE() << "no counter " << name;
    return -1;
  }
}

}  // namespace lookout::support
