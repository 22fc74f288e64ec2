// What is said to be lost, gained and different between two results.
#include "tools/archive/comparison.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/unit/archive/support.hpp"
#include "tools/archive/compare.hpp"
#include "tools/archive/csv_reader.hpp"
#include "tools/archive/fail_if.hpp"

namespace {

using namespace lookout;
using support::WriteFile;

class ArchiveComparison : public ::testing::Test {
 protected:
  support::TempDir dir_;
  std::filesystem::path a_ = dir_.path() / "a";
  std::filesystem::path b_ = dir_.path() / "b";
};

TEST_F(ArchiveComparison, NamesTheChannelThatDiffersFirstAndWhere) {
  std::filesystem::create_directories(a_);
  std::filesystem::create_directories(b_);
  WriteFile(a_ / "channels.csv", "channel,count,sha256\nPOSE,2,p\nSEGMENTS,2,s\nTRACKS,2,t\n");
  WriteFile(b_ / "channels.csv", "channel,count,sha256\nPOSE,2,p\nSEGMENTS,2,s2\nTRACKS,3,t2\n");
  WriteFile(a_ / "messages.csv", "channel,number,utime_us,xxh3\nTRACKS,0,20,1\nTRACKS,1,30,2\nSEGMENTS,0,10,5\nSEGMENTS,1,15,6\nPOSE,0,1,1\n");
  WriteFile(b_ / "messages.csv", "channel,number,utime_us,xxh3\nTRACKS,0,20,1\nTRACKS,1,30,9\nTRACKS,2,40,9\nSEGMENTS,0,10,5\nSEGMENTS,1,15,7\n");
  const auto differences = archive::DifferingChannels(a_, b_);
  ASSERT_EQ(differences.size(), 2U);
  EXPECT_EQ(differences[0].channel, "SEGMENTS");
  EXPECT_EQ(differences[0].first_number, 1);
  EXPECT_EQ(differences[0].first_utime_us, 15);
  EXPECT_EQ(differences[1].channel, "TRACKS");
  EXPECT_EQ(differences[1].num_different, 2);
  EXPECT_EQ(differences[1].first_utime_us, 30);
  EXPECT_EQ(differences[1].num_b, 3);
}

std::string TrackRow(int time, int id, double latitude, const char* status = "confirmed") {
  return std::to_string(time) + "," + std::to_string(id) + "," + std::to_string(latitude) + ",2.0," + status + "\n";
}

TEST_F(ArchiveComparison, TakesTracksForOneByTheirPlacesWhateverTheirNumbers) {
  const std::string header = "utime_us,track_id,latitude_deg,longitude_deg,status\n";
  constexpr double kFar = 41.001;  // 111 m
  WriteFile(dir_.path() / "a.csv",
            header + TrackRow(1, 7, 41) + TrackRow(2, 7, 41) + TrackRow(1, 8, kFar) + TrackRow(2, 8, kFar) + TrackRow(1, 9, 41.01, "tentative"));
  WriteFile(dir_.path() / "b.csv", header + TrackRow(1, 3, 41.00001) + TrackRow(2, 3, 41.00001) + TrackRow(2, 4, 41.02));
  std::optional<std::int64_t> first_us;
  const auto balance = archive::CompareTracks(dir_.path() / "a.csv", dir_.path() / "b.csv", first_us);
  EXPECT_EQ(balance.num_a, 2);
  EXPECT_EQ(balance.num_b, 2);
  EXPECT_EQ(balance.num_lost, 1);
  EXPECT_EQ(balance.num_gained, 1);
  EXPECT_EQ(first_us, 1);
}

TEST_F(ArchiveComparison, CountsSureObstaclesScanByScan) {
  const std::string header = "scan_utime_us,latitude_deg,longitude_deg,confidence\n";
  WriteFile(dir_.path() / "a.csv", header + "1,41,2,sure\n1,41.001,2,sure\n1,41.5,2,tentative\n2,41,2,sure\n4,41,2,sure\n");
  WriteFile(dir_.path() / "b.csv", header + "1,41.00001,2,sure\n2,41,2,sure\n3,41,2,sure\n4,,,sure\n");
  const auto balance = archive::CompareObstacles(dir_.path() / "a.csv", dir_.path() / "b.csv");
  EXPECT_EQ(balance.num_a, 4);
  EXPECT_EQ(balance.num_b, 3);
  EXPECT_EQ(balance.num_lost, 2);
  EXPECT_EQ(balance.num_gained, 1);
}

TEST_F(ArchiveComparison, ComparesPlacesInTheMapWhereTheEarthIsNotKnown) {
  const std::string header = "scan_utime_us,latitude_deg,longitude_deg,confidence,east_m,north_m\n";
  WriteFile(dir_.path() / "a.csv", header + "1,,,sure,10,20\n1,,,sure,50,20\n2,41,2,sure,10,20\n3,,,sure,,\n");
  WriteFile(dir_.path() / "b.csv", header + "1,,,sure,11,20\n2,,,sure,10,20\n");
  const auto balance = archive::CompareObstacles(dir_.path() / "a.csv", dir_.path() / "b.csv");
  EXPECT_EQ(balance.num_a, 3);
  EXPECT_EQ(balance.num_b, 2);
  EXPECT_EQ(balance.num_lost, 2) << "one is far, and one is of a place that B does not know on the earth";
  EXPECT_EQ(balance.num_gained, 1);
  const std::string tracks = "utime_us,track_id,latitude_deg,longitude_deg,status,east_m,north_m\n";
  WriteFile(dir_.path() / "a.csv", tracks + "1,7,,,confirmed,10,20\n1,8,,,confirmed,90,20\n");
  WriteFile(dir_.path() / "b.csv", tracks + "1,3,,,confirmed,12,20\n");
  std::optional<std::int64_t> first_us;
  const auto of_tracks = archive::CompareTracks(dir_.path() / "a.csv", dir_.path() / "b.csv", first_us);
  EXPECT_EQ(of_tracks.num_a, 2);
  EXPECT_EQ(of_tracks.num_lost, 1);
  EXPECT_EQ(of_tracks.num_gained, 0);
}

TEST_F(ArchiveComparison, TakesATableThatOneVersionHasNothingOfForEmpty) {
  std::filesystem::create_directories(a_);
  std::filesystem::create_directories(b_);
  WriteFile(a_ / "channels.csv", "channel,count,sha256\nTRACKS,2,t\nALERTS,1,x\n");
  WriteFile(b_ / "channels.csv", "channel,count,sha256\nALERTS,1,y\n");
  WriteFile(a_ / "messages.csv", "channel,number,utime_us,xxh3\nTRACKS,0,20,1\nALERTS,0,20,1\n");
  WriteFile(b_ / "messages.csv", "channel,number,utime_us,xxh3\nALERTS,0,20,2\n");
  WriteFile(a_ / "tracks.csv", "utime_us,track_id,latitude_deg,longitude_deg,status\n" + TrackRow(1, 7, 41));
  WriteFile(a_ / "alerts.csv", "alert_id,cause,raised_utime_us\n1,guard_zone,1000000\n");
  auto comparison = archive::CompareUnit(a_, b_);
  ASSERT_TRUE(comparison.tracks);
  EXPECT_EQ(comparison.tracks->num_lost, 1);
  EXPECT_FALSE(comparison.obstacles) << "neither has it";
  EXPECT_FALSE(comparison.alerts) << "B does not export it";
  comparison = archive::CompareUnit(b_, a_);
  EXPECT_EQ(comparison.tracks->num_gained, 1);
}

TEST_F(ArchiveComparison, CountsAndRanksUnitsWhoseTruthIsMissingUnderOneVersion) {
  std::vector<archive::ComparedUnit> units(3);
  units[0].comparison.truth_a = {{"scans", 10}, {"miou", 90}, {"recall", 80}};
  units[0].comparison.truth_b = {{"scans", 10}, {"miou", 90}};
  units[1].comparison.truth_a = {{"scans", 10}, {"miou", 90}};
  const auto figures = archive::FiguresOf(units);
  EXPECT_EQ(figures.at("truth_missing_b"), 2);
  EXPECT_EQ(figures.at("truth_missing_a"), 0);
  EXPECT_TRUE(archive::Holds(archive::ParseCondition("truth_missing_b > 0"), figures));
  EXPECT_GE(units[0].Badness(), 1000);
  EXPECT_EQ(units[2].Badness(), 0);
}

TEST_F(ArchiveComparison, PairsAlertsByCauseAndTime) {
  const std::string header = "alert_id,cause,raised_utime_us\n";
  WriteFile(dir_.path() / "a.csv", header + "1,guard_zone,1000000\n1,guard_zone,1000000\n2,closest_approach,5000000\n");
  WriteFile(dir_.path() / "b.csv", header + "5,guard_zone,2500000\n6,guard_zone,2600000\n");
  std::optional<std::int64_t> first_us;
  const auto balance = archive::CompareAlerts(dir_.path() / "a.csv", dir_.path() / "b.csv", first_us);
  EXPECT_EQ(balance.num_a, 2);
  EXPECT_EQ(balance.num_lost, 1);
  EXPECT_EQ(balance.num_gained, 1);
  EXPECT_EQ(first_us, 5'000'000);
}

TEST_F(ArchiveComparison, RefusesATableWithAWordInThePlaceOfATime) {
  WriteFile(dir_.path() / "a.csv", "alert_id,cause,raised_utime_us\n1,x,soon\n");
  std::optional<std::int64_t> first_us;
  EXPECT_THROW(archive::CompareAlerts(dir_.path() / "a.csv", dir_.path() / "b.csv", first_us), std::runtime_error);
}

TEST_F(ArchiveComparison, WeighsTruthByScansAndLeavesOutWhatOneVersionLacks) {
  std::vector<archive::ComparedUnit> units(3);
  units[0].comparison.truth_a = {{"scans", 10}, {"miou", 90}};
  units[0].comparison.truth_b = {{"scans", 10}, {"miou", 80}};
  units[1].comparison.truth_a = {{"scans", 30}, {"miou", 70}};
  units[1].comparison.truth_b = {{"scans", 30}, {"miou", 70}};
  units[2].comparison.truth_a = {{"scans", 1000}, {"miou", 1}};
  const auto figures = archive::FiguresOf(units);
  EXPECT_DOUBLE_EQ(figures.at("miou_a").value(), 75);
  EXPECT_DOUBLE_EQ(figures.at("miou_drop").value(), 2.5);
  EXPECT_FALSE(figures.at("mota_a").has_value());
  EXPECT_FALSE(figures.at("tracks_lost").has_value());
}

TEST_F(ArchiveComparison, PutsWhatIsNotDoneAnyMoreFirst) {
  archive::ComparedUnit lost;
  lost.a.state = archive::Standing::State::kDone;
  lost.b.state = archive::Standing::State::kFailed;
  archive::ComparedUnit worse;
  worse.comparison.truth_a = {{"miou", 90}};
  worse.comparison.truth_b = {{"miou", 85}};
  worse.comparison.alerts = archive::Balance{1, 1, 1, 1};
  EXPECT_GT(lost.Badness(), worse.Badness());
  EXPECT_DOUBLE_EQ(worse.Badness(), 54);
}

TEST(ArchiveFailIf, ReadsAFigureARelationAndANumber) {
  const archive::Figures figures{{"miou_drop", 0.5}, {"mota_a", std::nullopt}};
  const auto holds = [&figures](const char* text) { return archive::Holds(archive::ParseCondition(text), figures); };
  EXPECT_FALSE(holds("miou_drop > 0.5"));
  EXPECT_TRUE(holds("miou_drop >= 0.5"));
  EXPECT_TRUE(holds("  miou_drop<+1e0 "));
  EXPECT_TRUE(holds("miou_drop == .5"));
  EXPECT_FALSE(holds("miou_drop != 0.5"));
  EXPECT_TRUE(holds("miou_drop > -1"));
  for (const auto* wrong :
       {"", "miou_drop", "miou_drop > x", "miou_drop > 0.5; rm", "> 1", "miou_drop > 1e", "nix > 1", "mota_a > 1", "miou_drop => 1"}) {
    EXPECT_THROW(holds(wrong), std::invalid_argument) << wrong;
  }
}

TEST(ArchiveCsv, ReadsQuotedCellsAndFillsShortRows) {
  support::TempDir dir;
  WriteFile(dir.path() / "x.csv", "a,b,c\n\"1,\"\"x\"\"\n2\",,3\n4\r\n5,6,7,8");
  archive::CsvReader reader(dir.path() / "x.csv");
  EXPECT_EQ(reader.header(), (archive::CsvReader::Row{"a", "b", "c"}));
  archive::CsvReader::Row row;
  ASSERT_TRUE(reader.Next(row));
  EXPECT_EQ(row, (archive::CsvReader::Row{"1,\"x\"\n2", "", "3"}));
  ASSERT_TRUE(reader.Next(row));
  EXPECT_EQ(row, (archive::CsvReader::Row{"4", "", ""}));
  ASSERT_TRUE(reader.Next(row));
  EXPECT_EQ(row, (archive::CsvReader::Row{"5", "6", "7"}));
  EXPECT_FALSE(reader.Next(row));
}

}  // namespace
