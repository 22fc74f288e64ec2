#include "services/plotter/core/target_places.hpp"

#include <gtest/gtest.h>
#include <set>

#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using namespace std::chrono_literals;

TEST(PlotterPlaces, AreKeptAndUsedAgainAfterAMinute) {
  TargetPlaces places;
  EXPECT_EQ(places.Of(17, 0s), 1);
  EXPECT_EQ(places.Of(18, 0s), 2);
  EXPECT_EQ(places.Of(17, 500s), 1);
  places.Keep(std::vector{test::MakeTarget(18)}, 500s);
  EXPECT_EQ(places.Of(19, 559s), 3) << "the first was freed less than a minute ago";
  EXPECT_EQ(places.Of(20, 560s), 1);
  EXPECT_EQ(places.Of(18, 600s), 2);
  EXPECT_EQ(places.num_places(), 3U);
}

// An hour in which a target comes each second and lives for 20 s: 20 alive, 60 s of quarantine.
TEST(PlotterPlaces, AreAsManyAsAreThereAndWereThereInTheLastMinute) {
  TargetPlaces places;
  std::vector<Target> targets;
  for (int second = 0; second < 3600; ++second) {
    targets.push_back(test::MakeTarget(second));
    if (targets.size() > 20) targets.erase(targets.begin());
    places.Keep(targets, std::chrono::seconds(second));
    std::set<int> used;
    for (const auto& target : targets) used.insert(places.Of(target.id, std::chrono::seconds(second)));
    ASSERT_EQ(used.size(), targets.size());
  }
  EXPECT_LE(places.num_places(), 82U);
}

}  // namespace
}  // namespace lookout::plotter
