#include "lab/sim/fault_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lookout::sim {
namespace {

constexpr double kMaxSeconds = 86400.0;  // the longest run

std::optional<double> ToNumber(std::string_view text) {
  double number = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

bool IsShare(const TimedFault& fault) { return fault.kind <= TimedFaultKind::kSwap; }

bool Overlap(const TimedFault& a, const TimedFault& b) { return a.begin < b.end && b.begin < a.end; }

}  // namespace

TimedFault ParseTimedFault(std::string_view text) {
  const auto refuse = [&](const std::string& why) -> std::invalid_argument {
    return std::invalid_argument("fault '" + std::string(text) + "': " + why);
  };
  const auto form = std::ranges::find(kTimedFaultForms, text.substr(0, text.find(':')), &TimedFaultForm::name);
  if (form == kTimedFaultForms.end()) {
    std::vector<std::string_view> names;
    names.reserve(kTimedFaultForms.size());
    for (const auto& known : kTimedFaultForms) names.push_back(known.name);
    throw refuse(fmt::format("no such kind (there are: {})", fmt::join(names, ", ")));
  }
  std::vector<std::string_view> parts;  // not by std::views::split, which Clang 14 does not compile
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (parts.size() < 3 || parts.size() > 4) throw refuse("must be KIND:BEGIN:END or KIND:BEGIN:END:VALUE");

  TimedFault fault;
  fault.kind = static_cast<TimedFaultKind>(form - kTimedFaultForms.begin());
  const auto begin_s = ToNumber(parts[1]);
  const auto end_s = ToNumber(parts[2]);
  if (!begin_s || *begin_s < 0.0 || *begin_s > kMaxSeconds) throw refuse("BEGIN must be seconds since the start, 0 to 86400");
  if (!end_s || *end_s <= *begin_s || *end_s > kMaxSeconds) throw refuse("END must be seconds since the start, after BEGIN, up to 86400");
  fault.begin = std::chrono::microseconds(std::llround(*begin_s * 1e6));
  fault.end = std::chrono::microseconds(std::llround(*end_s * 1e6));
  if (fault.begin == fault.end) throw refuse("must last a microsecond at least");

  if (parts.size() == 3) {
    if (!form->unit.empty() && !form->default_value) throw refuse("wants a VALUE: " + std::string(form->unit));
    fault.value = form->default_value.value_or(0.0);
    return fault;
  }
  if (form->unit.empty()) throw refuse("takes no VALUE");
  const auto value = ToNumber(parts[3]);
  if (!value || *value < form->min_value || *value > form->max_value) {
    throw refuse(fmt::format("VALUE ({}) must be a number from {} to {}", form->unit, form->min_value, form->max_value));
  }
  if (fault.kind == TimedFaultKind::kWrongHour && *value != std::floor(*value)) throw refuse("VALUE must be whole hours");
  fault.value = *value;
  return fault;
}

FaultPlan::FaultPlan(std::vector<TimedFault> faults, Utime start) : faults_(std::move(faults)), start_(start) {
  std::ranges::stable_sort(faults_, {}, &TimedFault::begin);
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const auto& fault = faults_[i];
    double share = IsShare(fault) ? fault.value : 0.0;
    for (std::size_t j = 0; j < i; ++j) {
      if (!Overlap(faults_[j], fault)) continue;
      if (faults_[j].kind == fault.kind) throw std::invalid_argument("two faults '" + std::string(FormOf(fault.kind).name) + "' overlap");
      if (IsShare(fault) && IsShare(faults_[j])) share += faults_[j].value;
    }
    if (share > 1.0) throw std::invalid_argument("faults drop, double and swap: together they must not be more than 1");
  }
}

const TimedFault* FaultPlan::LastBegun(TimedFaultKind kind, Utime time) const {
  const TimedFault* last = nullptr;
  for (const auto& fault : faults_) {
    if (fault.kind == kind && Begin(fault) <= time) last = &fault;
  }
  return last;
}

// Faults of a kind do not overlap, so only the last that has begun can be on.
const TimedFault* FaultPlan::At(TimedFaultKind kind, Utime time) const {
  const auto* last = LastBegun(kind, time);
  return last != nullptr && time < End(*last) ? last : nullptr;
}

double FaultPlan::ValueAt(TimedFaultKind kind, Utime time) const {
  const auto* fault = At(kind, time);
  return fault != nullptr ? fault->value : 0.0;
}

}  // namespace lookout::sim
