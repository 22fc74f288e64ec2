// Which target has which of the hundred numbers that NMEA 0183 and NMEA 2000 have.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// A target keeps its number as long as it lives. The number of a lost target is given to no other for a while, so that a plotter does not connect
/// the ways of two targets. The last kReserved numbers are for dangerous targets, so that a crowded berth does not use up all.
///
/// Time is host time passed, as of PassedTime.
class TargetNumbers {
 public:
  static constexpr int kNumbers = 100;
  static constexpr int kReserved = 20;

  explicit TargetNumbers(std::chrono::microseconds quarantine) : quarantine_(quarantine) {}

  /// Gives numbers to all targets that have none, as long as numbers are free.
  /// @param targets  present targets, the most dangerous first; lost targets have been released
  void Assign(std::span<const Target> targets, std::chrono::microseconds now);

  /// Ends the target: its number is in quarantine from now on.
  void Release(std::int64_t target_id, std::chrono::microseconds now);

  /// @return 0 to 99; nullopt: the target has no number
  std::optional<int> Of(std::int64_t target_id) const;

  /// Targets that got none in the last Assign.
  int num_without() const { return static_cast<int>(without_.size()); }
  /// Times that a target began to be without a number.
  std::int64_t num_overflows() const { return num_overflows_; }
  int num_used() const { return static_cast<int>(number_of_.size()); }

 private:
  std::optional<int> Free(int end, std::chrono::microseconds now) const;

  struct Slot {
    bool is_used = false;
    std::optional<std::chrono::microseconds> released;
  };
  std::chrono::microseconds quarantine_;
  std::array<Slot, kNumbers> slots_{};
  std::map<std::int64_t, int> number_of_;
  std::set<std::int64_t> without_;
  std::int64_t num_overflows_ = 0;
};

}  // namespace lookout::plotter
