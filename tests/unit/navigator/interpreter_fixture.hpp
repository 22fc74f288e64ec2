// An interpreter of sentences, and what it counts.
#pragma once

#include <chrono>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <string_view>

#include "services/navigator/core/interpreter.hpp"
#include "tests/support/counters.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {

inline InterpreterParams TestParams() {
  InterpreterParams params;
  params.max_sentence_latency = std::chrono::milliseconds(500);
  params.position_sd_m = 2.5;
  return params;
}

class InterpreterTest : public ::testing::Test {
 protected:
  void Configure(const SourceParams& source) {
    auto params = TestParams();
    params.sources.push_back(source);
    interpreter_ = Interpreter(params);
  }
  Reading Read(double time_s, const std::string& line, const char* source = "nav") {
    return interpreter_.Read({NoonPlus(time_s), seq_++, ItemKind::kSentence, source, line});
  }
  std::int64_t Count(std::string_view name) const { return support::CountOf(interpreter_, name); }

  Interpreter interpreter_{TestParams()};
  std::int64_t seq_ = 0;
};

}  // namespace lookout::navigator
