#include "services/segmenter/core/lookout/evidence.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "services/segmenter/evidence_text.hpp"
#include "services/segmenter/params.hpp"
#include "tests/support/files.hpp"

namespace lookout::segmenter {
namespace {

constexpr std::array<std::string_view, 3> kFeatures{"gap", "range_m", "width_m"};
constexpr EvidenceLayout kLayout{"merge", kFeatures};

// Near and narrow: 1. Near and wide: 2. Far and narrow: 4. Far and wide: 8.
constexpr NamedTree kRangeAndWidth{{{{"range_m", 10.0F}, {"width_m", 3.0F}}}, {1.0F, 4.0F, 2.0F, 8.0F}};
constexpr NamedTree kGap{{{{"gap", 2.0F}}}, {0.5F, -0.25F}};

Evidence Make(const std::vector<NamedTree>& trees, float bias = 0.0F) { return {{"merge", kFeatures, bias, trees}, kLayout}; }

TEST(Evidence, AddsTheBiasAndALeafOfEachTree) {
  const auto evidence = Make({kRangeAndWidth, kGap}, 100.0F);
  EXPECT_EQ(evidence.Of(std::array{0.0F, 5.0F, 1.0F}), 101.5F);
  EXPECT_EQ(evidence.Of(std::array{0.0F, 5.0F, 4.0F}), 102.5F);
  EXPECT_EQ(evidence.Of(std::array{0.0F, 11.0F, 1.0F}), 104.5F);
  EXPECT_EQ(evidence.Of(std::array{3.0F, 11.0F, 4.0F}), 107.75F);
}

TEST(Evidence, IsNotAboveWhatItEquals) { EXPECT_EQ(Make({kGap}).Of(std::array{2.0F, 0.0F, 0.0F}), 0.5F); }

TEST(Evidence, OfNothingIsNothing) {
  EXPECT_EQ(Evidence().Of(std::span<const float>()), 0.0F);
  EXPECT_EQ(Make({NamedTree{{}, {7.0F}}}).Of(std::array{1.0F, 2.0F, 3.0F}), 7.0F);
}

TEST(Evidence, TermsSayWhichFeatureAddedWhat) {
  const auto evidence = Make({kGap}, 1.0F);
  std::array<float, 3> terms{};
  evidence.Terms(std::array{3.0F, 0.0F, 0.0F}, terms);
  EXPECT_EQ(evidence.Base(), 1.125F);
  EXPECT_EQ(terms, (std::array{-0.375F, 0.0F, 0.0F}));
}

TEST(Evidence, TermsAndTheBaseAreTheSum) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-3.0F, 3.0F);
  std::vector<NamedTree> trees(100);
  for (std::size_t i = 0; i < trees.size(); ++i) {
    for (std::size_t k = 0; k < i % (kTreeDepth + 1); ++k) trees[i].splits[k] = {kFeatures[random() % kFeatures.size()], uniform(random)};
    for (auto& leaf : trees[i].log_odds) leaf = uniform(random);
  }
  const auto evidence = Make(trees, 0.5F);
  for (int i = 0; i < 1000; ++i) {
    const std::array features{uniform(random), uniform(random), uniform(random)};
    std::array<float, 3> terms{};
    evidence.Terms(features, terms);
    EXPECT_NEAR(std::accumulate(terms.begin(), terms.end(), evidence.Base()), evidence.Of(features), 1e-4);
  }
}

TEST(Evidence, RefusesAFeatureThatTheMethodDoesNotHave) {
  EXPECT_THROW(Make({NamedTree{{{{"colour", 1.0F}}}, {0.0F, 1.0F}}}), std::invalid_argument);
  EXPECT_THROW(DefaultEvidence({"no such sum", kFeatures}), std::invalid_argument);
}

// What CMake compiles in and what the loader reads are one.
TEST(Evidence, CompiledInIsThatOfTheFile) {
  std::vector<EvidenceLayout> layouts;
  std::vector<Evidence> compiled_in;
  for (const auto& sum : DefaultSums()) {
    layouts.push_back({sum.name, sum.features});
    compiled_in.push_back(DefaultEvidence(layouts.back()));
  }
  EXPECT_EQ(LoadEvidence(support::kSources / "config/evidence/lookout.txtpb", layouts), compiled_in);
}

class EvidenceText : public ::testing::Test {
 protected:
  std::vector<Evidence> Load(const std::string& text, const std::vector<EvidenceLayout>& layouts = {kLayout}) {
    const auto file = std::filesystem::path(::testing::TempDir()) / "evidence.txtpb";
    std::ofstream(file) << text;
    return LoadEvidence(file, layouts);
  }

  // The faults, without the name of the file.
  std::string FaultsOf(const std::string& text, const std::vector<EvidenceLayout>& layouts = {kLayout}) {
    try {
      Load(text, layouts);
    } catch (const config::ConfigError& error) {
      std::string faults;
      for (const auto& fault : error.faults()) faults += fault.substr(fault.find(".txtpb:") + 7) + "\n";
      return faults;
    }
    return "none";
  }
};

constexpr const char* kHead = "sum {\n  name: \"merge\"\n  feature: \"gap\"\n  feature: \"width_m\"\n  feature: \"range_m\"\n  bias: 1\n";

TEST_F(EvidenceText, IsReadInAnyOrderOfTheFeatures) {
  const auto evidence =
      Load(std::string(kHead) +
           "  tree {\n    split { feature: \"range_m\" above: 10 }\n    split { feature: \"width_m\" above: 3 }\n"
           "    log_odds: [1, 4, 2, 8]\n  }\n  tree {\n    split { feature: \"gap\" above: 2 }\n    log_odds: [0.5, -0.25]\n  }\n}\n");
  EXPECT_EQ(evidence.front(), Make({kRangeAndWidth, kGap}, 1.0F));
}

// segmenter.txtpb names a file beside it.
TEST(EvidenceOfParams, IsThatOfTheFileThatTheConfigNames) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "config_with_evidence";
  std::filesystem::create_directories(folder);
  std::filesystem::copy(support::kSources / "config/demo/boat.txtpb", folder, std::filesystem::copy_options::overwrite_existing);
  std::filesystem::copy(support::kSources / "config/evidence/lookout.txtpb", folder, std::filesystem::copy_options::overwrite_existing);
  std::ofstream(folder / "segmenter.txtpb") << "evidence: \"lookout.txtpb\"\n";
  EXPECT_EQ(LoadParams(folder).lookout.evidence, LookoutParams().evidence);
  std::ofstream(folder / "lookout.txtpb") << "sum { name: \"land\" bias: 1 }\n";
  EXPECT_THROW(LoadParams(folder), config::ConfigError);
  std::ofstream(folder / "segmenter.txtpb") << "evidence: \"no_such_file.txtpb\"\n";
  EXPECT_THROW(LoadParams(folder), config::ConfigError);
}

TEST_F(EvidenceText, WithFaultsIsRefusedWithTheirLines) {
  EXPECT_EQ(FaultsOf(""), "1: sum: there is none of the name merge\n");
  EXPECT_EQ(FaultsOf("sum {\n  name: \"split\"\n  bias: 1\n}\n"),
            "2: sum.name: the method asks for no split\n1: sum: there is none of the name merge\n");
  EXPECT_EQ(FaultsOf("sum {\n  name: \"merge\"\n  feature: \"gap\"\n  feature: \"colour\"\n  bias: 1\n}\n"),
            "4: sum.feature: merge: there is no feature colour\n");
  EXPECT_EQ(FaultsOf("sum {\n  name: \"merge\"\n  feature: \"gap\"\n  feature: \"range_m\"\n  bias: 1\n}\n"),
            "4: sum.feature: merge: lacks width_m\n");
  EXPECT_EQ(
      FaultsOf(std::string(kHead) + "  tree {\n    log_odds: 1\n  }\n  tree {\n    split { feature: \"hue\" above: 2 }\n    log_odds: [1]\n  }\n}\n"),
      "12: sum.tree.log_odds: 1 splits make 2 leaves, not 1\n11: sum.tree.split.feature: merge: there is no feature hue\n");
  EXPECT_EQ(FaultsOf(std::string(kHead) + "  tree {\n    log_odds: nan\n  }\n}\n"), "8: sum.tree.log_odds: must be a finite number (is nan)\n");
  EXPECT_EQ(FaultsOf(std::string(kHead) + "}\n" + kHead + "}\n"), "9: sum.name: merge is there twice\n");
}

TEST_F(EvidenceText, WithAFeatureTwiceOrNoneIsRefusedWithItsLine) {
  const std::string tree = "  tree {\n    split { feature: \"gap\" above: 2 }\n    log_odds: [1, 2]\n  }\n}\n";
  const std::string named = "sum {\n  name: \"merge\"\n  bias: 1\n";
  EXPECT_EQ(FaultsOf(named + "  feature: \"gap\"\n  feature: \"range_m\"\n  feature: \"gap\"\n" + tree), "6: sum.feature: merge: has gap twice\n");
  EXPECT_EQ(FaultsOf(named + "  feature: \"gap\"\n  feature: \"range_m\"\n" + tree), "5: sum.feature: merge: lacks width_m\n");
  EXPECT_EQ(FaultsOf(named + tree), "2: sum.name: merge: lacks gap\n");
}

// Else a text of nonsense would hold the process for hours.
TEST_F(EvidenceText, OfNonsenseTellsAHundredFaults) {
  std::string text = kHead;
  for (int i = 0; i < 1000; ++i) text += "  tree { log_odds: [1, 2] }\n";
  const auto faults = FaultsOf(text + "}\n");
  EXPECT_EQ(std::ranges::count(faults, '\n'), 101);
  EXPECT_TRUE(faults.ends_with("1: text: and 900 faults more\n")) << faults.substr(faults.size() - 100);
}

// What is not read counts where a later fault stands.
TEST_F(EvidenceText, FaultsBehindASumThatIsThereTwiceHaveTheirLines) {
  const std::string tree = "  tree {\n    split { feature: \"gap\" above: 2 }\n    log_odds: [1, 2]\n  }\n";
  const auto faults = FaultsOf(kHead + tree + "}\n" + kHead + tree + "}\nsum {\n  name: \"land\"\n  feature: \"gap\"\n  bias: 1\n  tree {\n" +
                                   "    split { feature: \"hue\" above: 2 }\n    log_odds: [1]\n  }\n}\n",
                               {kLayout, {"land", std::span(kFeatures).first(1)}});
  EXPECT_EQ(faults,
            "13: sum.name: merge is there twice\n29: sum.tree.log_odds: 1 splits make 2 leaves, not 1\n"
            "28: sum.tree.split.feature: land: there is no feature hue\n");
}

}  // namespace
}  // namespace lookout::segmenter
