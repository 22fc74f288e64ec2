#include "common/bus/wire_description.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/schema.hpp"

namespace lookout::bus {
namespace {

std::vector<std::string> OwnTexts() {
  std::vector<std::string> texts;
  for (const auto& type : TypeTexts()) texts.push_back(type.text);
  return texts;
}

TEST(WireDescription, HasTheFingerprintsOfTheGeneratedHeaders) {
  const WireTypes types(OwnTexts());
  EXPECT_TRUE(types.faults().empty()) << ::testing::PrintToString(types.faults());
  EXPECT_EQ(types.types().size(), TypeFingerprints().size());
  for (const auto& [type, fingerprint] : TypeFingerprints()) {
    const auto* found = types.Find(fingerprint);
    ASSERT_NE(found, nullptr) << type;
    EXPECT_EQ(found->name, type);
  }
}

TEST(WireDescription, KnowsMembersDimensionsAndCounts) {
  const WireTypes types({R"(package a; /* struct x { */ struct part_t { double x, y[2]; }
    struct whole_t { const int32_t ONE = 1, TWO = 2; int16_t num; a.part_t part[num][3]; string name; // boolean no;
    })"});
  ASSERT_TRUE(types.faults().empty()) << types.faults().front();
  ASSERT_EQ(types.types().size(), 2U);
  const auto& whole = types.types()[1];
  EXPECT_EQ(whole.name, "whole_t");
  ASSERT_EQ(whole.members.size(), 3U);
  EXPECT_TRUE(whole.members[0].is_count);
  EXPECT_EQ(whole.members[1].kind, WireKind::kStruct);
  EXPECT_EQ(whole.members[1].type, 0U);
  ASSERT_EQ(whole.members[1].dimensions.size(), 2U);
  EXPECT_EQ(whole.members[1].dimensions[0].count_member, 0U);
  EXPECT_EQ(whole.members[1].dimensions[1].length, 3);
  EXPECT_EQ(whole.members[2].kind, WireKind::kString);
  EXPECT_EQ(whole.min_size_bytes, 2U + 5U);
  EXPECT_EQ(types.types()[0].members[1].dimensions[0].length, 2);
}

TEST(WireDescription, LeavesOutWhatItCannotReadAndSaysSo) {
  const WireTypes types({"struct good_t { int8_t a; }", "struct torn_t { int8_t a;", "struct lacks_t { nowhere_t a; }", "struct self_t { self_t a; }",
                         "struct late_t { double x[num]; int32_t num; }", "struct empty_t { }", "struct many_t { int32_t num; empty_t a[num]; }",
                         "struct needs_t { lacks_t a; }", "enum old_t { A, B }", "struct odd_t { double x[3z]; }", "@"});
  EXPECT_EQ(types.types().size(), 2U) << "good_t and empty_t";
  EXPECT_EQ(types.faults().size(), 9U) << ::testing::PrintToString(types.faults());
}

TEST(WireDescription, DoesNotTakeLongOverTypesThatDoubleWithEachNesting) {
  std::string text;
  for (int i = 0; i < 100; ++i) {
    const auto part = "t" + std::to_string(i + 1);
    text += "struct t" + std::to_string(i) + " { " + part + " a; " + part + " b; }\n";
  }
  text += "struct t100 { int8_t a; }";
  const WireTypes types({text});
  EXPECT_FALSE(types.faults().empty()) << "nested too deep";
}

}  // namespace
}  // namespace lookout::bus
