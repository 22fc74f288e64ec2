// GOSPA, by hand, against each other, and against scipy's.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <vector>

#include "lab/eval/tracks/track_gospa.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;

TEST(Gospa, ByHand) {
  // One pair 3 m apart, a truth alone, an estimate beyond the cut-off of it: 9 + 2 x 200.
  const auto gospa = GospaOf(Points{{0.0, 0.0}, {100.0, 0.0}}, Points{{3.0, 0.0}, {100.0, 30.0}});
  EXPECT_DOUBLE_EQ(gospa.localisation_m2, 9.0);
  EXPECT_EQ(gospa.num_missed, 1);
  EXPECT_EQ(gospa.num_false, 1);
  EXPECT_DOUBLE_EQ(gospa.Rms(), std::sqrt(9.0 + 400.0));
  EXPECT_DOUBLE_EQ(gospa.LocalisationRms(), 3.0);
  EXPECT_DOUBLE_EQ(gospa.MissedRms(), std::sqrt(200.0));
  EXPECT_DOUBLE_EQ(gospa.FalseRms(), std::sqrt(200.0));
}

TEST(Gospa, ScansAddInSquares) {
  Gospa sum{.num_scans = 0};
  sum.Add(GospaOf(Points{{0.0, 0.0}}, Points{{4.0, 0.0}}));
  sum.Add(GospaOf(Points{}, Points{}));
  EXPECT_DOUBLE_EQ(sum.Rms(), std::sqrt(16.0 / 2.0));
}

TEST(Gospa, IsSymmetricButForNames) {
  const Points some_m{{0.0, 0.0}, {5.0, 5.0}, {70.0, 0.0}};
  const Points others_m{{1.0, 1.0}, {6.0, 4.0}};
  const auto there = GospaOf(some_m, others_m);
  const auto back = GospaOf(others_m, some_m);
  EXPECT_DOUBLE_EQ(there.Rms(), back.Rms());
  EXPECT_EQ(there.num_missed, back.num_false);
}

// The same by somebody else's assignment: tests/unit/eval_tracks/gospa_by_scipy.py reads sets and our results, and says where it differs.
TEST(Gospa, AgreesWithScipy) {
  const std::string python = std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";  // Debian's, which has Debian's scipy
  if (std::system((python + " -c 'import scipy.optimize' 2>/dev/null").c_str()) != 0) {
    GTEST_SKIP() << "python3-scipy is not installed (./dev setup slow)";
  }
  constexpr unsigned kSeed = 11;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> place_m(0.0, 60.0);
  std::uniform_int_distribution<int> count(0, 12);
  std::string text;
  for (int i = 0; i < 300; ++i) {
    const auto make = [&](char name) {
      Points points_m(static_cast<std::size_t>(count(random)));
      text += name;
      for (auto& p_m : points_m) {
        p_m = {place_m(random), place_m(random)};
        text += fmt::format(" {:.17g} {:.17g}", p_m.x(), p_m.y());
      }
      text += '\n';
      return points_m;
    };
    const auto truths_m = make('x');
    const auto estimates_m = make('y');
    const auto gospa = GospaOf(truths_m, estimates_m);
    text += fmt::format("g {:.17g} {:.17g} {} {}\n", gospa.Rms(), gospa.localisation_m2, gospa.num_missed, gospa.num_false);
  }
  const support::TempDir folder;
  const auto file = folder.path() / "sets.txt";
  support::WriteFile(file, text);
  const auto script = support::kSources / "tests/unit/eval_tracks/gospa_by_scipy.py";
  EXPECT_EQ(std::system((python + " " + script.string() + " " + file.string()).c_str()), 0);
}

}  // namespace
}  // namespace lookout::eval
