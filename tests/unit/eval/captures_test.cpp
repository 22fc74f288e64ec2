// Captures with truth: what is read is what was rendered, and what is wrong is told with file and line.
#include "lab/eval/methods/captures.hpp"

#include <algorithm>
#include <numeric>

#include "lab/data/xz_file.hpp"
#include "lab/eval/methods/method_comparison.hpp"
#include "lab/eval/methods/methods.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/eval/captures_fixture.hpp"

namespace lookout::eval::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Captures, GiveTheScansThatTheSimulatorRendersWithoutTheOwnVessel) {
  Make("sparse");
  std::vector<LabelledScan> rendered;
  RenderScans(scene_, boat_, kSeed, kSeconds, [&rendered](const LabelledScan& scan) { rendered.push_back(scan); });
  std::vector<LabelledScan> read;
  const auto report = Read([&read](const LabelledScan& scan) { read.push_back(scan); });

  ASSERT_EQ(read.size(), rendered.size());
  ASSERT_GE(read.size(), 2U);
  EXPECT_EQ(report.num_scans, static_cast<std::int64_t>(read.size()));
  EXPECT_EQ(report.num_unmatched, 0);
  EXPECT_GT(report.num_own_vessel, 0) << "the hull is in view";
  for (std::size_t i = 0; i < read.size(); ++i) {
    auto expected = rendered[i];
    for (std::size_t cell = 0; cell < expected.object.size(); ++cell) {
      if (expected.object[cell] != kOwnVesselObject) continue;
      expected.object[cell] = kNoTrueObject;
      expected.scan.columns.range[cell] = 0;
    }
    EXPECT_EQ(read[i].scan.columns.range, expected.scan.columns.range);
    EXPECT_EQ(read[i].object, expected.object);
    for (const auto& [id, object] : expected.objects) {
      EXPECT_EQ(read[i].objects.at(id).kind, object.kind);
      EXPECT_EQ(read[i].objects.at(id).is_in_water, object.is_in_water) << object.kind;
    }
  }
}

TEST_F(Captures, BothReturnsOfAShotHaveTheirTruth) {
  Make("dual");
  EXPECT_EQ(Read().num_unmatched, 0);
}

TEST_F(Captures, TheMountingIsThatOfTheBoatBesideThem) {
  Make("sparse");
  EXPECT_EQ(LoadBoatOfCaptures(folder_, kConfig).facts.name, LoadBoat(kConfig).facts.name) << "where there is none, of the config";
  Write("boat.txtpb",
        "name: \"other\" lidar { x_m: 0.5 y_m: 0 z_m: 2 roll_deg: 0 pitch_deg: 0 yaw_deg: 0 } gnss_antenna { x_m: 0 y_m: 0 z_m: 1 } "
        "reference_point_above_water_m: 0 own_vessel { min_x_m: -1 max_x_m: 1 min_y_m: -1 max_y_m: 1 min_z_m: -1 max_z_m: 1 }");
  const auto boat = LoadBoatOfCaptures(folder_, kConfig);
  EXPECT_EQ(boat.facts.name, "other");
  EXPECT_DOUBLE_EQ(boat.segmenter.filter.T_vessel_lidar.translation().z(), 2.0);
}

TEST_F(Captures, AFewReturnsWithoutTruthAreCountedAndManyRefused) {
  Make("sparse");
  const auto truth = truth_;
  const auto num_rows = std::ranges::count(truth, '\n') - 1;
  // Drops each row whose number is a multiple of `every`.
  const auto drop = [&](std::int64_t every) {
    std::istringstream in(truth);
    truth_.clear();
    std::int64_t number = 0;
    for (std::string line; std::getline(in, line); ++number) {
      if (number == 0 || number % every != 0) truth_ += line + "\n";
    }
    WriteAll();
  };
  drop(2000);
  const auto report = Read();
  EXPECT_GT(report.num_unmatched, 0);
  EXPECT_LE(report.num_unmatched, num_rows / 2000 + 1);
  drop(500);
  EXPECT_NE(Fault().find("sparse-7.truth.csv.xz: does not belong to sparse-7.pcap.xz: "), std::string::npos) << Fault();
}

TEST_F(Captures, TimesMatchWithinThreeMicrosecondsAndRangesToTheStep) {
  Make("sparse");
  const auto shifted = [this](std::int64_t time_us, int range_mm) {
    std::istringstream in(truth_);
    std::ostringstream out;
    std::string line;
    std::getline(in, line);
    out << line << '\n';
    while (std::getline(in, line)) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream row(line);
      std::int64_t utime_us = 0;
      int ring = 0;
      int return_index = 0;
      double range_m = 0.0;
      int object = 0;
      row >> utime_us >> ring >> return_index >> range_m >> object;
      out << utime_us + time_us << ',' << ring << ',' << return_index << ',' << range_m + range_mm / 1000.0 << ',' << object << '\n';
    }
    Write(name_ + ".truth.csv.xz", Pack(out.str()));
    return Fault();
  };
  EXPECT_EQ(shifted(2, 0), "");
  EXPECT_NE(shifted(5, 0), "");
  EXPECT_NE(shifted(0, 2), "");
}

TEST_F(Captures, WhatIsWrongWithTheTruthIsToldWithFileAndLine) {
  Make("sparse");
  const auto good = truth_;
  const auto header_end = good.find('\n') + 1;
  const auto second_row = good.find('\n', header_end) + 1;
  const auto with_row = [&](const std::string& row) {
    truth_ = good.substr(0, second_row) + row + "\n" + good.substr(second_row);
    WriteAll();
    return Fault();
  };
  const auto time = good.substr(header_end, good.find(',', header_end) - header_end);
  const std::string at = "sparse-7.truth.csv.xz:3: ";
  EXPECT_EQ(with_row(time + ",1,0,nan,0"), at + "range_m: not a finite number: nan");
  EXPECT_EQ(with_row(time + ",1,0,inf,0"), at + "range_m: not a finite number: inf");
  EXPECT_EQ(with_row(time + ",1,0,5.001,0"), at + "range_m: not a range of the sensor, in steps of 2 mm: 5.001");
  EXPECT_EQ(with_row(time + ",1,0,0,0"), at + "range_m: not a range of the sensor, in steps of 2 mm: 0");
  EXPECT_EQ(with_row(time + ",1,0,500,0"), at + "range_m: not a range of the sensor, in steps of 2 mm: 500");
  EXPECT_EQ(with_row(time + ",one,0,5,0"), at + "ring: not a whole number: one");
  EXPECT_EQ(with_row(time + ",128,0,5,0"), at + "ring: 128 is not within 0 to 127");
  EXPECT_EQ(with_row(time + ",1,2,5,0"), at + "return_index: 2 is not within 0 to 1");
  EXPECT_EQ(with_row(time + ",1,0,5,-2").substr(0, at.size() + 23), at + "object_id: -2 is not wi");
  EXPECT_EQ(with_row(time + ",1,0,5"), at + "4 columns, where the header has 5");
  EXPECT_EQ(with_row(""), at + "1 columns, where the header has 5");
  EXPECT_EQ(with_row("99999999999999999999,1,0,5,0"), at + "utime_us: not a whole number: 99999999999999999999");
  EXPECT_EQ(with_row("1,1,0,5,0"), at + "utime_us goes back");
  EXPECT_EQ(with_row(std::string(5000, '1')), at + "a line of more than 4096 bytes");
  truth_ = "utime_us,ring,range_m,object_id\n";
  WriteAll();
  EXPECT_EQ(Fault(), "sparse-7.truth.csv.xz:1: the header lacks the column return_index");
  truth_.clear();
  WriteAll();
  EXPECT_EQ(Fault(), "sparse-7.truth.csv.xz:1: empty: a header is missing");
}

TEST_F(Captures, AFaultBehindTheLastScanIsToldToo) {
  Make("sparse");
  truth_ += "nonsense\n";
  WriteAll();
  EXPECT_EQ(Fault(), "sparse-7.truth.csv.xz:" + std::to_string(std::ranges::count(truth_, '\n')) + ": 1 columns, where the header has 5");
}

TEST_F(Captures, CompressedDataThatIsCutOffOrDamagedIsRefused) {
  Make("sparse");
  const auto packed = Pack(truth_);
  Write(name_ + ".truth.csv.xz", packed.substr(0, packed.size() / 2));
  EXPECT_NE(Fault().find(": the compressed data is cut off"), std::string::npos) << Fault();
  EXPECT_EQ(Fault().rfind("sparse-7.truth.csv.xz:", 0), 0U) << Fault();
  auto damaged = packed;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 0x55);
  Write(name_ + ".truth.csv.xz", damaged);
  EXPECT_NE(Fault().find(": the compressed data is damaged"), std::string::npos) << Fault();
  Write(name_ + ".truth.csv.xz", truth_);
  EXPECT_EQ(Fault(), "sparse-7.truth.csv.xz:1: not compressed by xz");
  WriteAll();
  const auto pcap = Pack(pcap_);
  Write(name_ + ".pcap.xz", pcap.substr(0, pcap.size() - 100));
  EXPECT_EQ(Fault(), "sparse-7.pcap.xz: the compressed data is cut off");
  Write(name_ + ".pcap.xz", Pack("no capture at all, but text that is long enough to be looked at"));
  EXPECT_EQ(Fault().rfind("sparse-7.pcap.xz: is text, no capture", 0), 0U) << Fault();
  Write(name_ + ".pcap.xz", Pack(pcap_.substr(0, pcap_.size() - 10)));
  EXPECT_EQ(Fault().rfind("sparse-7.pcap.xz: damaged: ", 0), 0U) << Fault();
  Write(name_ + ".pcap.xz", Pack(pcap_.substr(0, 24)));
  EXPECT_EQ(Fault(), "sparse-7.pcap.xz: holds no whole scan of the lidar");
}

TEST_F(Captures, ObjectsMustBeKnownAndOfOneType) {
  Make("sparse");
  objects_ = "object_id,type\n1,shore\n1,boat\n";
  WriteAll();
  EXPECT_EQ(Fault(), "sparse-7.objects.csv.xz:3: object 1 was of type shore before");
  objects_ = "object_id,type\n1,\n";
  WriteAll();
  EXPECT_EQ(Fault(), "sparse-7.objects.csv.xz:2: type: empty");
  objects_ = "object_id,type\n99,shore\n";
  WriteAll();
  EXPECT_EQ(Fault().rfind("sparse-7.objects.csv.xz: lacks object ", 0), 0U) << Fault();
}

TEST_F(Captures, AreFoundByTheirNames) {
  EXPECT_TRUE(ListCaptures(folder_).empty());
  EXPECT_THROW(ListCaptures(folder_ / "nothing"), std::runtime_error);
  for (const auto* name : {"b-2", "b-10", "a-b-3"}) {
    for (const auto* ending : {".pcap.xz", ".truth.csv.xz", ".objects.csv.xz"}) Write(name + std::string(ending), "");
  }
  const auto captures = ListCaptures(folder_);
  ASSERT_EQ(captures.size(), 3U);
  EXPECT_EQ(captures[0].scene, "a-b");
  EXPECT_EQ(captures[1].seed, 2U);
  EXPECT_EQ(captures[2].seed, 10U);
  fs::remove(folder_ / "b-2.truth.csv.xz");
  EXPECT_EQ(Fault(), "b-2.truth.csv.xz: is missing beside b-2.pcap.xz");
  fs::remove(folder_ / "b-2.pcap.xz");
  for (const auto* name : {"noseed.pcap.xz", "-3.pcap.xz", "x-.pcap.xz", "x-3a.pcap.xz", "x-99999999999999999999.pcap.xz"}) {
    Write(name, "");
    EXPECT_THROW(ListCaptures(folder_), std::runtime_error) << name;
    fs::remove(folder_ / name);
  }
}

TEST(XzFile, RefusesWhatUnpacksToTooMuch) {
  const support::TempDir folder;
  const auto file = folder / "file.xz";
  std::ofstream(file, std::ios::binary) << Pack(std::string(1 << 20, 'a'));
  std::vector<std::uint8_t> out(1 << 21);
  EXPECT_EQ(data::XzFile(file, 1 << 20).Read(out), std::size_t{1} << 20);
  EXPECT_THROW(data::XzFile(file, (1 << 20) - 1).Read(out), std::runtime_error);
  fs::remove(file);
  EXPECT_THROW(data::XzFile(file, 1), std::runtime_error);
}

TEST(SecondWorld, EveryReturnOfItsCapturesHasItsTruthAndTheDefaultMethodSeesItsThings) {
  const auto folder = support::kRecordings / "second_world";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const auto captures = ListCaptures(folder);
  const auto dense = std::ranges::find(captures, "dense", &CaptureWithTruth::scene);
  ASSERT_NE(dense, captures.end());
  const auto boat = LoadBoatOfCaptures(folder, support::kCatabotConfig);
  Methods methods;
  methods.push_back(std::make_unique<SegmenterMethod>("ours", boat.segmenter));
  MethodComparison comparison(methods);
  const auto report = ReadCapture(*dense, boat, [&comparison](const LabelledScan& scan) { comparison.Add({"dense", 0, 0}, scan); });
  EXPECT_GE(report.num_scans, 25);
  EXPECT_EQ(report.num_unmatched, 0);
  EXPECT_GT(report.num_own_vessel, 0);
  // Measured 2026-11-22: 97.8 % over both captures of the scene. A mounting or a truth that is off costs more than the points between.
  EXPECT_GE(comparison.results().at(0).by_scene.at("dense").iou.value(), 0.93);
}

}  // namespace
}  // namespace lookout::eval::test
