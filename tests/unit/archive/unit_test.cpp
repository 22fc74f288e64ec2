// Keys of units, and units as lines of a list.
#include <gtest/gtest.h>
#include <set>
#include <stdexcept>

#include "tests/unit/archive/support.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/plan.hpp"

namespace {

using namespace lookout;
using archive::KeyOf;
using archive_test::AnyRecipe;

TEST(ArchiveKey, ChangesWithEachThingThatDecidesAboutTheResult) {
  std::set<std::string> keys{KeyOf(AnyRecipe())};
  const auto add = [&keys](const auto& change) {
    auto recipe = AnyRecipe();
    change(recipe);
    EXPECT_TRUE(keys.insert(KeyOf(recipe)).second);
  };
  add([](auto& recipe) { recipe.run_digest = "ab"; });
  add([](auto& recipe) { recipe.run_kind = "capture"; });
  add([](auto& recipe) { recipe.from_us = 0; });
  add([](auto& recipe) { recipe.to_us = 0; });
  add([](auto& recipe) { recipe.truth_digest = "dd"; });
  add([](auto& recipe) { recipe.config_digest = "bc"; });
  add([](auto& recipe) { recipe.programs_digest = "cd"; });
  add([](auto& recipe) { recipe.program_version = "0.1.1"; });
  add([](auto& recipe) { recipe.tables = {"tracks"}; });
  add([](auto& recipe) { recipe.tables = {"tracks,pose"}; });
  EXPECT_EQ(keys.size(), 11U);
  EXPECT_EQ(KeyOf(AnyRecipe()), KeyOf(AnyRecipe()));
}

archive::Unit AnyUnit() {
  archive::Unit unit;
  unit.recipe = AnyRecipe();
  unit.recipe.from_us = 5;
  unit.key = KeyOf(unit.recipe);
  unit.run = "a run";
  unit.inputs = {{"/logs/new\nline %\xff.lcmlog", 7, 8}, {"/logs/'\"$(x).lcmlog", 9, 10}};
  unit.truth = "/logs/x.truth";
  unit.programs = "/usr/bin";
  return unit;
}

TEST(ArchiveUnit, IsTheSameBehindItsLine) {
  const auto unit = AnyUnit();
  const auto line = archive::UnitLine(unit);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const auto again = archive::UnitOfLine(line);
  EXPECT_EQ(again.key, unit.key);
  EXPECT_EQ(again.recipe, unit.recipe);
  ASSERT_EQ(again.inputs.size(), 2U);
  EXPECT_EQ(again.inputs[0].path, unit.inputs[0].path);
  EXPECT_EQ(again.inputs[1].path, unit.inputs[1].path);
  EXPECT_EQ(again.inputs[1].modified_ns, 10);
}

TEST(ArchiveUnit, IsRefusedWhereItsKeyIsNotThatOfItsRecipe) {
  auto line = archive::UnitLine(AnyUnit());
  line.replace(line.find("\"bb\""), 4, "\"bc\"");
  EXPECT_THROW(archive::UnitOfLine(line), std::runtime_error);
  EXPECT_THROW(archive::UnitOfLine("{}"), std::runtime_error);
  EXPECT_THROW(archive::UnitOfLine(line.substr(0, line.size() / 2)), std::runtime_error);
}

TEST(ArchivePath, IsTheSameBehindItsTextWhateverBytesItHolds) {
  std::string all = "/";
  for (int byte = 1; byte < 256; ++byte) all += static_cast<char>(byte);
  const auto text = archive::PathText(all);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_EQ(archive::PathOfText(text), std::filesystem::path(all));
  EXPECT_EQ(archive::PathText("/boot ö/100%"), "/boot ö/100%25");
  EXPECT_FALSE(archive::PathOfText("a%2"));
  EXPECT_FALSE(archive::PathOfText("a%00b"));
  EXPECT_FALSE(archive::PathOfText("a%zz"));
}

TEST(ArchiveParts, AreAsLongAsAskedAndEndWithTheRun) {
  constexpr std::int64_t kMinute = 60'000'000;
  const std::vector<std::int64_t> cuts{10 * kMinute, 35 * kMinute, 50 * kMinute, 70 * kMinute};
  const auto parts = archive::PartsOf(0, cuts, 30);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_FALSE(parts[0].from_us);
  EXPECT_EQ(parts[0].to_us, 35 * kMinute);
  EXPECT_EQ(parts[1].from_us, 35 * kMinute);
  EXPECT_EQ(parts[1].to_us, 70 * kMinute);
  EXPECT_EQ(parts[2].from_us, 70 * kMinute);
  EXPECT_FALSE(parts[2].to_us);
  EXPECT_EQ(archive::PartsOf(0, cuts, 0).size(), 1U);
  EXPECT_EQ(archive::PartsOf(0, {}, 30).size(), 1U);
}

}  // namespace
