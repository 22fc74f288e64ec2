// The index, and tables of results in SQL.
#include "tools/archive/index.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/unit/archive/support.hpp"
#include "tools/archive/result_table.hpp"
#include "tools/archive/results.hpp"

namespace {

using namespace lookout;

class ArchiveIndex : public ::testing::Test {
 protected:
  support::TempDir dir_;
  archive::ArchiveFolder folder_{dir_.path() / "archive"};
};

TEST_F(ArchiveIndex, OfAnotherFormatIsRefusedWithAdvice) {
  archive::OpenIndex(folder_).Execute("UPDATE meta SET value = '99' WHERE name = 'format'");
  for (const auto& open : {archive::OpenIndex, archive::ReadIndex}) {
    try {
      open(folder_);
      ADD_FAILURE() << "was opened";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("format 99"), std::string::npos) << error.what();
    }
  }
}

TEST_F(ArchiveIndex, ThatIsNoDatabaseIsRefused) {
  std::filesystem::create_directories(folder_.folder());
  support::WriteFile(folder_.Index(), std::string(5000, 'x'));
  EXPECT_THROW(archive::OpenIndex(folder_), std::runtime_error);
}

TEST_F(ArchiveIndex, TakesBackATransactionThatIsNotCommitted) {
  auto index = archive::OpenIndex(folder_);
  {
    archive::Transaction transaction(index);
    index.Execute("INSERT INTO result VALUES('k', 's', 'done', '')");
  }
  EXPECT_FALSE(index.Value("SELECT key FROM result"));
}

TEST_F(ArchiveIndex, ForgetsAResultThatDoesNotHoldAnyMore) {
  auto index = archive::OpenIndex(folder_);
  archive::Results results(folder_, index);
  const auto key = archive_test::WriteResult(folder_, archive_test::AnyRecipe(), "a\n1\n");
  EXPECT_TRUE(results.Of(key).is_valid);
  EXPECT_TRUE(index.Value("SELECT key FROM result"));
  EXPECT_TRUE(results.Of(key).is_done);
  support::WriteFile(folder_.Result(key) / "tracks.csv", "a\n2\n");
  EXPECT_FALSE(results.Of(key).is_valid);
  EXPECT_FALSE(index.Value("SELECT key FROM result"));
}

TEST_F(ArchiveIndex, ShowsFilesOfResultsAsOneTable) {
  auto index = archive::OpenIndex(folder_);
  support::WriteFile(dir_.path() / "1.csv", "cpa_m,word\n2.5,near\n,\"a,b\"\n");
  support::WriteFile(dir_.path() / "2.csv", "word,cpa_m\nfar,7\n");
  support::WriteFile(dir_.path() / "3.csv", "cpa_m,word\n");
  archive::AddResultTable(
      index, "tracks",
      {{"A", "r1", "rain", 0, dir_.path() / "1.csv"}, {"A", "r2", "fog", 1, dir_.path() / "3.csv"}, {"B", "r1", "rain", 0, dir_.path() / "2.csv"}});
  EXPECT_EQ(index.Value("SELECT count(*) FROM tracks"), "3");
  EXPECT_EQ(index.Value("SELECT word FROM tracks WHERE cpa_m = 7"), "far");
  EXPECT_EQ(index.Value("SELECT typeof(cpa_m) || typeof(word) FROM tracks WHERE cpa_m IS NULL"), "nulltext");
  EXPECT_EQ(index.Value("SELECT sum(cpa_m) FROM tracks WHERE scene = 'rain' AND version IN ('A', 'B')"), "9.5");
  EXPECT_EQ(index.Value("SELECT count(*) FROM tracks AS a JOIN tracks AS b ON a.run = b.run AND a.version = 'A' AND b.version = 'B'"), "2");
}

TEST_F(ArchiveIndex, TellsOfAFileOfAResultThatIsGone) {
  auto index = archive::OpenIndex(folder_);
  support::WriteFile(dir_.path() / "1.csv", "a\n1\n");
  archive::AddResultTable(index, "tracks", {{"A", "r", "s", 0, dir_.path() / "1.csv"}, {"A", "r", "s", 1, dir_.path() / "2.csv"}});
  EXPECT_THROW(index.Value("SELECT sum(a) FROM tracks"), std::runtime_error);
}

}  // namespace
