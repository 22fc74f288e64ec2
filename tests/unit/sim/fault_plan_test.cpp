#include "lab/sim/fault_plan.hpp"

#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;
using Kind = TimedFaultKind;

const Utime kPlanStart = Utime(1'781'532'600s);

std::string WhyNot(std::string_view text) {
  try {
    ParseTimedFault(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TimedFault, IsReadWithItsTimesAndItsValue) {
  const auto fault = ParseTimedFault("gnss_jump:2.5:10:-3.25");
  EXPECT_EQ(fault.kind, Kind::kGnssJump);
  EXPECT_EQ(fault.begin, 2500ms);
  EXPECT_EQ(fault.end, 10s);
  EXPECT_EQ(fault.value, -3.25);
}

TEST(TimedFault, EveryKindIsReadAndHasItsDefaultOrWantsAValue) {
  for (std::size_t i = 0; i < kTimedFaultForms.size(); ++i) {
    const auto& form = kTimedFaultForms[i];
    const std::string text = std::string(form.name) + ":0:1";
    if (form.unit.empty() || form.default_value) {
      const auto fault = ParseTimedFault(text);
      EXPECT_EQ(fault.kind, static_cast<Kind>(i)) << form.name;
      EXPECT_EQ(fault.value, form.default_value.value_or(0.0)) << form.name;
      EXPECT_EQ(FormOf(fault.kind).name, form.name);
    } else {
      EXPECT_NE(WhyNot(text).find("wants a VALUE"), std::string::npos) << form.name;
    }
  }
}

TEST(TimedFault, SaysWhatIsWrong) {
  const auto expect = [](std::string_view text, std::string_view reason) {
    const auto why = WhyNot(text);
    EXPECT_NE(why.find("fault '" + std::string(text) + "'"), std::string::npos) << why;
    EXPECT_NE(why.find(reason), std::string::npos) << why;
  };
  expect("", "no such kind (there are: drop, ");
  expect("gnss", "no such kind");
  expect("GNSS_GAP:1:2", "no such kind");
  expect("gnss_gap", "must be KIND:BEGIN:END");
  expect("gnss_gap:1", "must be KIND:BEGIN:END");
  expect("gnss_jump:1:2:3:4", "must be KIND:BEGIN:END");
  expect("gnss_gap:-1:2", "BEGIN must be");
  expect("gnss_gap:x:2", "BEGIN must be");
  expect("gnss_gap::2", "BEGIN must be");
  expect("gnss_gap:nan:2", "BEGIN must be");
  expect("gnss_gap:2:2", "END must be");
  expect("gnss_gap:2:inf", "END must be");
  expect("gnss_gap:2:2.0000001", "must last a microsecond at least");
  expect("gnss_gap:2:86401", "END must be");
  expect("gnss_gap:2:3 ", "END must be");
  expect("gnss_gap:1:2:3", "takes no VALUE");
  expect("gnss_gap:1:2:", "takes no VALUE");
  expect("gnss_jump:1:2:", "VALUE (metres to the east) must be a number from -1000 to 1000");
  expect("drop:1:2:1.01", "must be a number from 0 to 1");
  expect("wrong_hour:1:2:0.5", "whole hours");
}

TEST(FaultPlan, IsEmptyWithoutFaults) {
  const FaultPlan plan;
  EXPECT_EQ(plan.At(Kind::kGnssGap, kPlanStart), nullptr);
  EXPECT_EQ(plan.LastBegun(Kind::kGnssGap, kPlanStart), nullptr);
  EXPECT_EQ(plan.ValueAt(Kind::kGnssJump, kPlanStart), 0.0);
}

TEST(FaultPlan, AFaultBeginsWithItsBeginAndIsOverAtItsEnd) {
  const FaultPlan plan({ParseTimedFault("gnss_jump:6:8:2"), ParseTimedFault("gnss_jump:1:2:7"), ParseTimedFault("gnss_gap:2:3")}, kPlanStart);
  const auto jump_m = [&](auto since_start) { return plan.ValueAt(Kind::kGnssJump, kPlanStart + since_start); };
  EXPECT_EQ(jump_m(999'999us), 0.0);
  EXPECT_EQ(jump_m(1s), 7.0);
  EXPECT_EQ(jump_m(1'999'999us), 7.0);
  EXPECT_EQ(jump_m(2s), 0.0);
  EXPECT_EQ(jump_m(6s), 2.0);
  EXPECT_EQ(jump_m(8s), 0.0);
  EXPECT_EQ(plan.LastBegun(Kind::kGnssJump, kPlanStart), nullptr);
  EXPECT_EQ(plan.LastBegun(Kind::kGnssJump, kPlanStart + 5s)->value, 7.0);
  EXPECT_EQ(plan.LastBegun(Kind::kGnssJump, kPlanStart + 9s)->value, 2.0);
  EXPECT_EQ(plan.Begin(plan.faults()[0]), kPlanStart + 1s);
  EXPECT_EQ(plan.End(plan.faults()[0]), kPlanStart + 2s);
}

TEST(FaultPlan, RefusesTwoOfAKindAtATimeAndSharesOfMoreThanOne) {
  const auto make = [](std::vector<TimedFault> faults) { return FaultPlan(std::move(faults), kPlanStart); };
  EXPECT_THROW(make({ParseTimedFault("gnss_gap:1:3"), ParseTimedFault("gnss_gap:2:4")}), std::invalid_argument);
  EXPECT_NO_THROW(make({ParseTimedFault("gnss_gap:1:3"), ParseTimedFault("gnss_gap:3:4"), ParseTimedFault("imu_stop:1:4")}));
  EXPECT_THROW(make({ParseTimedFault("drop:1:3:0.6"), ParseTimedFault("swap:2:4:0.5")}), std::invalid_argument);
  EXPECT_NO_THROW(make({ParseTimedFault("drop:1:3:0.6"), ParseTimedFault("swap:3:4:0.5")}));
}

}  // namespace
}  // namespace lookout::sim
