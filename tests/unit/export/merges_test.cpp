// --table merges: why pieces of a scan are one or two, as it is written and as it is drawn.
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "services/segmenter/params.hpp"
#include "services/segmenter/wire.hpp"
#include "tests/unit/export/export_logs.hpp"
#include "tests/unit/segmenter/message_maker.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"
#include "tools/export/merge_rounds.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {
namespace {

using Row = std::map<std::string, double>;

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

class MergesTest : public ExportTest {
 protected:
  /// A lake with a shore, boats and buoys, in three parts.
  static segmenter::Scan Lake(std::uint64_t seed) {
    auto scan = segmenter::test::EmptyScan({});
    segmenter::test::Look(scan, segmenter::test::Lake(seed), 0.02, seed);
    return scan;
  }
  void AddScan(const segmenter::Scan& scan, std::int64_t seq) {
    for (const auto& part : segmenter::test::ScanMessages(scan, seq, 3)) Add(bus::kLidarScan, part);
  }
  int ExportMerges(const std::string& format = "csv", std::optional<std::int64_t> scan = std::nullopt, bool all_scans = false) {
    return Export(Request{.inputs = {log_},
                          .table = "merges",
                          .format = format,
                          .output = folder_ / "out",
                          .force = true,
                          .scan = scan,
                          .all_scans = all_scans,
                          .config = config_});
  }
  std::vector<Row> Numbers() const {
    const auto names = Cells(std::string(MergesHeader()));
    std::vector<Row> rows;
    for (const auto& line : Rows()) {
      const auto cells = Cells(line);
      EXPECT_EQ(cells.size(), names.size()) << line;
      Row& row = rows.emplace_back();
      for (std::size_t i = 0; i < cells.size(); ++i) row[names[i]] = std::stod(cells[i]);
    }
    return rows;
  }

  std::filesystem::path config_ = support::kDemoConfig;
};

TEST_F(MergesTest, TermsOfThePairAndTheBaseAreItsLogOdds) {
  AddScan(Lake(1), 0);
  ASSERT_EQ(ExportMerges(), kExitFine) << errors_;
  EXPECT_EQ(text_.substr(0, text_.find('\n')), MergesHeader());
  const auto rows = Numbers();
  ASSERT_FALSE(rows.empty());
  for (const auto& row : rows) {
    double sum = row.at("base");
    for (const auto name : segmenter::kPairFeatureNames) sum += row.at(std::string(name) + "_adds");
    ASSERT_NEAR(sum, row.at("log_odds"), 0.01);  // numbers of four decimals, 33 of them, and single precision
    ASSERT_GE(row.at("gap_m"), 0.0);
  }
  EXPECT_EQ(errors_, "");
}

TEST_F(MergesTest, PiecesGoFromRoundToRoundAndEndInTheSegmentsOfTheSegmenter) {
  const auto scan = Lake(2);
  AddScan(scan, 0);
  ASSERT_EQ(ExportMerges(), kExitFine) << errors_;
  std::map<double, std::map<double, double>> segment_of_piece;  // by round
  std::set<double> is_merged;
  std::map<std::pair<double, double>, double> becomes;  // of round and piece
  for (const auto& row : Numbers()) {
    is_merged.insert(row.at("is_merged"));
    ASSERT_EQ(row.at("is_merged") == 1.0, row.at("becomes_1") == row.at("becomes_2"));
    if (row.at("is_merged") == 1.0) {
      ASSERT_EQ(row.at("segment_id_1"), row.at("segment_id_2"));
    }
    if (row.at("round") == 3.0) {
      ASSERT_EQ(row.at("is_merged") == 1.0, row.at("segment_id_1") == row.at("segment_id_2"));
    }
    for (const std::string end : {"_1", "_2"}) {
      const double round = row.at("round");
      const auto& segment = segment_of_piece[round].try_emplace(row.at("piece" + end), row.at("segment_id" + end)).first->second;
      ASSERT_EQ(segment, row.at("segment_id" + end)) << "a piece is of one segment";
      becomes[{round, row.at("piece" + end)}] = row.at("becomes" + end);
      ASSERT_GE(row.at("returns" + end), 1.0);
    }
  }
  EXPECT_EQ(is_merged, (std::set<double>{0.0, 1.0})) << "a lake has both";
  int num_followed = 0;
  for (const auto& [piece, next] : becomes) {
    const auto later = segment_of_piece.find(piece.first + 1.0);
    if (later == segment_of_piece.end() || !later->second.contains(next)) continue;  // it had no pair there
    ++num_followed;
    EXPECT_EQ(later->second.at(next), segment_of_piece.at(piece.first).at(piece.second));
  }
  EXPECT_GT(num_followed, 0);
  // Where a piece lies in the middle of its own returns, the segment that the segmenter gives is there, too.
  const auto segments = segmenter::SegmentScan(scan, segmenter::LoadParams(config_));
  MergeRecorder recorder(segmenter::LoadParams(config_));
  ScanMessages messages;
  for (const auto& part : segmenter::test::ScanMessages(scan, 0, 3)) messages.scans.emplace(part.part_index, part);
  const auto merged = recorder.Merge(messages);
  ASSERT_TRUE(merged);
  std::vector<std::int16_t> label;
  for (const auto& [part_index, part] : merged->segments) label.insert(label.end(), part.label.begin(), part.label.end());
  EXPECT_EQ(label, segments.label);
  for (const auto& round : merged->rounds) {
    std::int32_t num_returns = 0;
    for (const auto& piece : round.pieces) num_returns += piece.num_returns;
    EXPECT_EQ(static_cast<std::size_t>(num_returns), merged->returns_m.size());
  }
}

TEST_F(MergesTest, AreOfTheLastWholeScanOfOneOrOfAll) {
  AddScan(Lake(1), 4);
  AddScan(Lake(2), 5);
  const auto half = segmenter::test::ScanMessages(Lake(3), 6, 3);
  Add(bus::kLidarScan, half[0]);
  const auto seqs = [this] {
    std::set<double> found;
    for (const auto& row : Numbers()) found.insert(row.at("seq"));
    return found;
  };
  ASSERT_EQ(ExportMerges(), kExitFine);
  EXPECT_EQ(seqs(), (std::set<double>{5.0}));
  EXPECT_EQ(errors_, "");
  ASSERT_EQ(ExportMerges("csv", 4), kExitFine);
  EXPECT_EQ(seqs(), (std::set<double>{4.0}));
  ASSERT_EQ(ExportMerges("csv", std::nullopt, true), kExitFine);
  EXPECT_EQ(seqs(), (std::set<double>{4.0, 5.0}));
  EXPECT_NE(errors_.find("1 scans lack a part"), std::string::npos) << errors_;
  for (const std::string format : {"csv", "svg"}) {
    EXPECT_EQ(ExportMerges(format, 6), kExitFailed);
    EXPECT_NE(errors_.find("scan 6 lacks a part"), std::string::npos) << errors_;
  }
  EXPECT_EQ(ExportMerges("csv", 9), kExitFailed);
  EXPECT_NE(errors_.find("no scan 9"), std::string::npos) << errors_;
}

TEST_F(MergesTest, SaysWhereTheLogWasSegmentedInAnotherWay) {
  const auto scan = Lake(1);
  AddScan(scan, 0);
  auto other = segmenter::LoadParams(config_);
  const auto parts = segmenter::test::ScanMessages(scan, 0, 3);
  auto heard = *segmenter::ToScan(parts);
  for (const auto& message : segmenter::ToMessages(heard, segmenter::SegmentScan(heard, other), bus::kMaxMessageBytes)) Add(bus::kSegments, message);
  ASSERT_EQ(ExportMerges(), kExitFine);
  EXPECT_EQ(errors_, "") << "by the same config";
  other.min_segment_points = 50;
  heard.head.seq = 1;
  AddScan(scan, 1);
  for (const auto& message : segmenter::ToMessages(heard, segmenter::SegmentScan(heard, other), bus::kMaxMessageBytes)) Add(bus::kSegments, message);
  ASSERT_EQ(ExportMerges(), kExitFine);
  EXPECT_NE(errors_.find("SEGMENTS of 1 scans in the log are others than --config gives"), std::string::npos) << errors_;
}

TEST_F(MergesTest, ThePictureHasALineForEachPairOfTheLastRoundAndAReasonForEachSegment) {
  const auto scan = Lake(1);
  AddScan(scan, 0);
  ASSERT_EQ(ExportMerges(), kExitFine);
  int num_pairs = 0;
  for (const auto& row : Numbers()) num_pairs += row.at("round") == 3.0 ? 1 : 0;
  ASSERT_GT(num_pairs, 0);
  ASSERT_EQ(ExportMerges("svg"), kExitFine) << errors_;
  const auto count = [this](const std::string& part) {
    int found = 0;
    for (auto at = text_.find(part); at != std::string::npos; at = text_.find(part, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<title>pieces "), num_pairs);
  const auto num_segments = segmenter::SegmentScan(scan, segmenter::LoadParams(config_)).segments.size();
  EXPECT_EQ(static_cast<std::size_t>(count("<title>segment ")), num_segments) << "each says why it is land, and a thing";
  EXPECT_NE(text_.find("pairs of the last round: green one, red two"), std::string::npos);
  EXPECT_NE(text_.find("bow up"), std::string::npos) << "the mounting is that of --config";
}

TEST_F(MergesTest, NeedAConfigOfTheMethodThatMergesPairs) {
  AddScan(Lake(1), 0);
  EXPECT_EQ(Export("merges"), kExitUsage);
  EXPECT_NE(errors_.find("--table merges needs --config"), std::string::npos) << errors_;
  EXPECT_EQ(Export(Request{.inputs = {log_}, .table = "returns", .output = folder_ / "out", .config = config_}), kExitUsage);
  EXPECT_EQ(ExportMerges("ply"), kExitUsage);
  EXPECT_EQ(ExportMerges("svg", std::nullopt, true), kExitUsage);

  std::filesystem::copy(config_, folder_ / "config");
  config_ = folder_ / "config";
  support::ReplaceIn(config_ / "segmenter.txtpb", "method: LOOKOUT", "method: PAPER");
  EXPECT_EQ(ExportMerges(), kExitUsage);
  EXPECT_NE(errors_.find("segmenter.txtpb:5: method: PAPER merges no pairs"), std::string::npos) << errors_;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

}  // namespace
}  // namespace lookout::exporter
