#include "tests/unit/learned/weights_test.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/support/files.hpp"

namespace lookout::learned {
namespace {

using namespace test;

const std::string kOneAndMinusTwo("\x00\x3c\x00\xc0", 4);

std::string ReasonOf(const std::string& about, const std::string& payload) {
  try {
    ParseWeights(about, payload);
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(Weights, AreFloatsOfSixteenBits) {
  const auto weights = ParseWeights(AboutOf(kOneAndMinusTwo), kOneAndMinusTwo);
  EXPECT_EQ(weights.values, (std::vector{1.0F, -2.0F}));
  EXPECT_EQ(weights.deviation[4], 18.0F);
  EXPECT_EQ(weights.trained_on, (std::set<std::string>{"beach", "rough"}));
}

TEST(Weights, AreRefusedWithTheReason) {
  const auto about = AboutOf(kOneAndMinusTwo);
  EXPECT_NE(ReasonOf(about, kOneAndMinusTwo + kOneAndMinusTwo).find("their digest is another"), std::string::npos);
  EXPECT_NE(ReasonOf("{", kOneAndMinusTwo).find("parse error"), std::string::npos);
  EXPECT_NE(ReasonOf("[]", kOneAndMinusTwo), "");
  EXPECT_NE(ReasonOf(R"({"mean": 3})", kOneAndMinusTwo), "");
  EXPECT_NE(ReasonOf(AboutOf(kOneAndMinusTwo, "[1, 2, 3, 4]"), kOneAndMinusTwo), "") << "four deviations";
  EXPECT_NE(ReasonOf(AboutOf(kOneAndMinusTwo, "[1, 0, 3, 4, 5]"), kOneAndMinusTwo).find("greater than 0"), std::string::npos);
  EXPECT_NE(ReasonOf(AboutOf(kOneAndMinusTwo, "[1, 1e300, 3, 4, 5]"), kOneAndMinusTwo).find("not finite"), std::string::npos);
  const std::string infinity("\x00\x7c", 2);
  EXPECT_NE(ReasonOf(AboutOf(infinity), infinity).find("not finite"), std::string::npos);
}

TEST(Weights, OfAFileNameTheFile) {
  const support::TempDir folder;
  try {
    ReadWeights(folder.path() / "none.json");
    FAIL() << "read what is not there";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("none.json: cannot be read"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lookout::learned
