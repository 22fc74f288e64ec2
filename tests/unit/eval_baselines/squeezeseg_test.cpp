#include "lab/eval/baselines/squeezeseg.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/support/files.hpp"
#include "tests/unit/eval_baselines/labels.hpp"
#include "tests/unit/learned/weights_test.hpp"

namespace lookout::eval {
namespace {

using namespace test;

// All weights are 0 but the biases of the last convolution: every return is of one class.
std::shared_ptr<const learned::Network> Always(learned::Class wanted) {
  auto weights = learned::test::AnyWeights();
  std::ranges::fill(weights.values, 0.0F);
  constexpr std::size_t kCompatibilities = 2UL * learned::kNumClasses * learned::kNumClasses;
  weights.values[weights.values.size() - kCompatibilities - learned::kNumClasses + static_cast<std::size_t>(wanted)] = 5.0F;
  return std::make_shared<const learned::Network>(weights);
}

Labelling Segment(const segmenter::Scan& scan, learned::Class wanted) {
  return Peer("SqueezeSeg", {}, SizeLimits{}, SqueezeSegGrouping(Always(wanted), {1.0, 1})).Segment(scan);
}

segmenter::Scan TwoThings() {
  auto scan = Turn();
  SetPatch(scan, -3, 3, 0, 2, 10.0);
  SetPatch(scan, 90, 92, 1, 1, 20.0);
  return scan;
}

TEST(SqueezeSeg, MakesInstancesOfAClassByDistance) {
  const auto scan = TwoThings();
  for (const auto wanted : {learned::Class::kThing, learned::Class::kLand}) {
    const auto labelling = Segment(scan, wanted);
    EXPECT_EQ(labelling.is_sure.size(), 2U);
    EXPECT_EQ(LabelAt(scan, labelling, 0, 1), LabelAt(scan, labelling, 357, 2));
    EXPECT_NE(LabelAt(scan, labelling, 0, 1), LabelAt(scan, labelling, 91, 1));
  }
}

TEST(SqueezeSeg, LeavesClutterOut) {
  const auto scan = TwoThings();
  const auto labelling = Segment(scan, learned::Class::kClutter);
  EXPECT_TRUE(labelling.is_sure.empty());
  EXPECT_EQ(labelling.label, std::vector<std::int32_t>(scan.num_cells(), 0));
}

TEST(SqueezeSeg, NamesItsStagesAndTakesAnEmptyScan) {
  const auto labelling = Segment(Turn(), learned::Class::kThing);
  EXPECT_TRUE(labelling.is_sure.empty());
  ASSERT_EQ(labelling.stages.size(), 5U);
  EXPECT_EQ(labelling.stages[1].first, "image");
  EXPECT_EQ(labelling.stages[2].first, "network");
  EXPECT_EQ(labelling.stages[3].first, "clusters");
}

// Weights of the published size: NAME.json, and zeros.
void WriteWeights(const std::filesystem::path& folder, const std::string& name, const std::string& trained_on) {
  const std::string payload(2 * learned::test::kNumWeights, '\0');
  support::WriteFile(folder / (name + ".f16"), payload);
  auto about = learned::test::AboutOf(payload);
  const std::string of_test = R"("beach", "rough")";
  support::WriteFile(folder / (name + ".json"), about.replace(about.find(of_test), of_test.size(), trained_on));
}

TEST(SqueezeSegLeftOut, TakesWeightsThatDoNotKnowTheScene) {
  const support::TempDir folder;
  EXPECT_THROW(LearnedWeights{folder.path()}, std::runtime_error) << "there are none";
  WriteWeights(folder.path(), "all", R"("beach", "rough", "canal")");
  WriteWeights(folder.path(), "without_1", R"("rough", "canal")");
  WriteWeights(folder.path(), "without_2", R"("beach", "canal")");
  const LearnedWeights weights(folder.path());
  EXPECT_NE(weights.Without("beach"), nullptr);
  EXPECT_NE(weights.Without("beach"), weights.OfAll());
  EXPECT_NE(weights.Without("beach"), weights.Without("rough"));
  EXPECT_EQ(weights.Without("canal"), nullptr);
  SqueezeSegLeftOut method(weights, {}, {"beach", "rough"});
  EXPECT_TRUE(method.BeginScan({"beach", 101, 0}));
  EXPECT_TRUE(method.Segment(Turn()).is_sure.empty());
  EXPECT_TRUE(method.BeginScan({"a scene of another world", 101, 0}));
  EXPECT_THROW(SqueezeSegLeftOut(weights, {}, {"canal"}), std::runtime_error) << "all weights know it";
}

// What is committed is whole, and no weights but those of all families know every family.
TEST(LearnedWeights, OfTheSourcesAreThereForEachFamily) {
  const LearnedWeights weights(support::kSources / "lab/learned/weights");
  EXPECT_NE(weights.OfAll(), nullptr);
  for (const auto& entry : std::filesystem::directory_iterator(support::kSources / "config/scenes/families")) {
    EXPECT_NE(weights.Without(entry.path().stem().string()), nullptr) << entry.path();
  }
}

}  // namespace
}  // namespace lookout::eval
