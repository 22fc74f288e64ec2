// Processor time of whole scans, median and 99th percentile, ours and peers alternating on the same scans; and how it grows with the returns.
//
//   bench/scans_segmenter [--rounds N]
//
// Peers give labels alone. Ours is timed whole, measuring of each segment included, and up to its labels.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "lab/eval/baselines/peers.hpp"
#include "services/segmenter/core/segmenter.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace {

using namespace lookout;
using namespace lookout::segmenter;

constexpr std::uint64_t kSeed = 20261121;

double ProcessorMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double Percentile(std::vector<double>& times_ms, double share) {
  std::ranges::sort(times_ms);
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(times_ms.size())));
  return times_ms[std::max<std::size_t>(rank, 1) - 1];
}

// Heavy spray about the bow: a return on every third beam, 0.6 to 6 m off.
Scan SprayScan(int num_columns) {
  auto scan = test::EmptyScan({.num_columns = num_columns});
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int column = 0; column < num_columns; ++column) {
    for (int ring = 0; ring < scan.head.num_rings(); ++ring) {
      if (uniform(random) < 1.0 / 3.0) test::SetReturn(scan, column, ring, 0.6 + 5.4 * uniform(random));
    }
  }
  return scan;
}

// Many small solid things, all near.
Scan BlocksScan(int num_columns) {
  auto scan = test::EmptyScan({.num_columns = num_columns});
  for (int column = 0; column < num_columns; ++column) {
    for (int ring = 0; ring < scan.head.num_rings(); ++ring)
      test::SetReturn(scan, column, ring, 1.0 + (column / 6 % 2 != 0 ? 0.5 : 0.0) + 0.9 * (ring % 4));
  }
  return scan;
}

// Beams over 30 degrees, however many there are.
Scan EmptyScanOf(int num_rings, int num_columns) {
  auto scan = test::EmptyScan({.num_columns = num_columns, .num_rings = num_rings});
  for (std::size_t ring = 0; ring < scan.head.rings.size(); ++ring) {
    scan.head.rings[ring].elevation_rad = static_cast<float>(DegToRad(-15.0 + 30.0 * static_cast<double>(ring) / (num_rings - 1)));
    scan.head.rings[ring].azimuth_offset_rad = static_cast<float>(DegToRad(0.0083 * static_cast<double>(ring % 16)));  // as at 600 rpm
  }
  return scan;
}

Scan LakeScan(int num_rings, int num_columns, int num_drops, bool is_basin) {
  auto scan = EmptyScanOf(num_rings, num_columns);
  auto walls = test::Lake(kSeed);
  if (is_basin) test::AddBoat(walls, 0.0, 0.0, 0.1, 120.0, 60.0, -1000.0, 1000.0);  // walls of any height on all sides
  test::Look(scan, walls, 0.03, kSeed);
  if (num_drops > 0) test::AddRain(scan, num_drops, kSeed);
  return scan;
}

// A return on every beam, at any range.
Scan NoiseScan(int num_rings, int num_columns) {
  auto scan = EmptyScanOf(num_rings, num_columns);
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> range_m(0.6, 100.0);
  for (int column = 0; column < num_columns; ++column) {
    for (int ring = 0; ring < num_rings; ++ring) test::SetReturn(scan, column, ring, range_m(random));
  }
  return scan;
}

std::size_t NumReturns(const Scan& scan) {
  return static_cast<std::size_t>(std::ranges::count_if(scan.columns.range, [](std::uint16_t range) { return range != 0; }));
}

struct Row {
  std::string name;
  Scan scan;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Processor time of whole scans");
  int num_rounds = 300;
  app.add_option("--rounds", num_rounds, "of each scan and method")->check(CLI::Range(2, 100000));
  CLI11_PARSE(app, argc, argv);

  std::vector<Row> rows;
  rows.push_back({"lake", LakeScan(16, 1808, 0, false)});
  rows.push_back({"lake in rain", LakeScan(16, 1808, 2880, false)});
  rows.push_back({"drops alone", EmptyScanOf(16, 1808)});
  test::AddRain(rows.back().scan, 5000, kSeed);
  rows.push_back({"every beam", LakeScan(16, 1808, 0, true)});
  rows.push_back({"every beam, rain", LakeScan(16, 1808, 2880, true)});

  for (const int num_columns : {512, 2048}) {
    rows.push_back({"spray " + std::to_string(num_columns), SprayScan(num_columns)});
    rows.push_back({"blocks " + std::to_string(num_columns), BlocksScan(num_columns)});
  }

  auto peers = eval::MakePeers({});
  const auto peer = [&peers](const std::string& name) -> eval::Method* {
    const auto found = std::ranges::find_if(peers, [&](const auto& one) { return one->name() == name; });
    return found != peers.end() ? found->get() : nullptr;
  };
  eval::Method* const others[] = {peer("Euclidean 0.5 m"), peer("depth clustering (tuned)")};
  std::printf("processor time, ms; x = times that of our labels\n");
  std::printf("%-18s %8s %9s | %22s | %12s | %20s | %24s\n", "scan", "returns", "segments", "ours: median    p99", "labels alone",
              "Euclidean 0.5 m    x", "depth clustering     x");
  for (const Row& row : rows) {
    Segmenter segmenter{Params{}};
    ReturnClassifier classifier{{}};
    LookoutMethod method({}, Eigen::Matrix3d::Identity());
    Numbering numbering;
    std::vector<double> ours_ms;
    std::vector<double> labels_ms;
    std::vector<double> others_ms[2];
    segmenter.Segment(row.scan);  // takes its memory
    for (int round = 0; round < num_rounds; ++round) {
      double begin_ms = ProcessorMs();
      segmenter.Segment(row.scan);
      ours_ms.push_back(ProcessorMs() - begin_ms);
      begin_ms = ProcessorMs();
      method.Group(row.scan, classifier.Classify(row.scan).returns);
      numbering.Number(method.groups(), {}, 1, std::numeric_limits<std::int16_t>::max());
      labels_ms.push_back(ProcessorMs() - begin_ms);
      for (std::size_t i = 0; i < 2; ++i) {
        if (others[i] == nullptr || round % 10 != 0) continue;  // a tenth of the scans is enough for their median
        begin_ms = ProcessorMs();
        others[i]->Segment(row.scan);
        others_ms[i].push_back(ProcessorMs() - begin_ms);
      }
    }
    const double median_ms = Percentile(labels_ms, 0.5);
    std::printf("%-18s %8zu %9zu | %14.3f %7.3f | %12.3f |", row.name.c_str(), NumReturns(row.scan), segmenter.Segment(row.scan).segments.size(),
                Percentile(ours_ms, 0.5), Percentile(ours_ms, 0.99), median_ms);
    for (auto& times_ms : others_ms) {
      if (times_ms.empty()) continue;
      const double other_ms = Percentile(times_ms, 0.5);
      std::printf(" %14.3f %5.1f |", other_ms, other_ms / median_ms);
    }
    std::printf("\n");
  }

  std::printf("\n%-18s %9s %12s %17s\n", "scan", "returns", "ms median", "us a 1000 returns");
  const auto time = [num_rounds](const std::string& name, const Scan& scan) {
    Segmenter segmenter{Params{}};
    segmenter.Segment(scan);
    std::vector<double> times_ms;
    for (int round = 0; round < std::max(2, num_rounds / 10); ++round) {
      const double begin_ms = ProcessorMs();
      segmenter.Segment(scan);
      times_ms.push_back(ProcessorMs() - begin_ms);
    }
    const double median_ms = Percentile(times_ms, 0.5);
    const auto num_returns = NumReturns(scan);
    std::printf("%-18s %9zu %12.3f %17.1f\n", name.c_str(), num_returns, median_ms, 1e6 * median_ms / static_cast<double>(num_returns));
  };
  for (const auto& [num_rings, num_columns] : {std::pair{16, 512}, {16, 1024}, {16, 1808}, {32, 1024}, {64, 1024}, {64, 2048}, {128, 2048}}) {
    time("lake " + std::to_string(num_rings) + " x " + std::to_string(num_columns), LakeScan(num_rings, num_columns, 0, false));
  }
  time("noise 16 x 1808", NoiseScan(16, 1808));
  time("noise 128 x 2048", NoiseScan(128, 2048));
  return 0;
}
