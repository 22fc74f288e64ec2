// Which track is which ship, in made harbours: hardly ever wrong, and right wherever AIS can tell.
#include "tests/property/ais_harbour.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>

#include "services/ais/core/watcher.hpp"

namespace lookout::ais {
namespace {

constexpr int kNumPlaces = 5;
constexpr std::array<const char*, kNumPlaces> kPlaceNames{"side by side", "at a quay", "alone", "under way", "encounter"};

struct Count {
  std::int64_t right = 0;   // told as the track that it is
  std::int64_t unsure = 0;  // not told as any
  std::int64_t wrong = 0;   // told as another

  std::int64_t all() const { return right + unsure + wrong; }
  double Percent(std::int64_t number) const { return all() == 0 ? 0.0 : 100.0 * static_cast<double>(number) / static_cast<double>(all()); }
};

struct Tally {
  std::array<Count, kNumPlaces> of_place{};
  std::int64_t without_ais = 0;        // seconds of tracks without AIS
  std::int64_t without_ais_named = 0;  // of them such as were told to be a ship
  std::int64_t ais_only = 0;           // ships in reach that were told as not seen
};

int FirstSeed() { return std::getenv("LOOKOUT_AIS_FIRST_SEED") != nullptr ? std::atoi(std::getenv("LOOKOUT_AIS_FIRST_SEED")) : 101; }
int NumSeeds() { return std::getenv("LOOKOUT_AIS_SEEDS") != nullptr ? std::atoi(std::getenv("LOOKOUT_AIS_SEEDS")) : 8; }

void JudgeHarbour(unsigned seed, Tally& tally) {
  constexpr double kStepS = 0.5;
  constexpr double kSettledS = 10.0;  // a track is judged when it has been there so long
  constexpr double kDurationS = 180.0;
  test::MadeHarbour harbour(seed);
  Watcher watcher({});
  std::map<std::int64_t, double> first_s;
  for (double time_s = 0.0; time_s < kDurationS; time_s += kStepS) {
    for (const auto& item : harbour.TakeItems(time_s)) watcher.Consume(item);
    const auto scan = harbour.Scan(time_s);
    const auto picture = watcher.Update(scan, harbour.OwnPose(time_s));
    ASSERT_EQ(picture.status, Status::kOk);
    std::map<std::int64_t, std::int32_t> told;  // by track
    std::map<std::int32_t, ShipState> states;
    for (const auto& ship : picture.ships) {
      states[ship.ship.mmsi] = ship.state;
      if (ship.state != ShipState::kTracked) continue;
      ASSERT_TRUE(told.emplace(ship.track_id, ship.ship.mmsi).second) << "a track is two ships";
    }
    for (const auto& track : scan.tracks) first_s.try_emplace(track.id, time_s);
    for (const auto& ship : harbour.ships()) {
      const auto since = first_s.find(ship.track_id);
      const bool is_here = std::ranges::binary_search(scan.tracks, ship.track_id, {}, &TrackedThing::id);
      if (!is_here || time_s - since->second < kSettledS) continue;
      const auto found = told.find(ship.track_id);
      if (ship.mmsi == 0) {
        ++tally.without_ais;
        if (found != told.end()) ++tally.without_ais_named;
        continue;
      }
      const auto mmsi = static_cast<std::int32_t>(ship.mmsi);
      if (!states.contains(mmsi)) continue;  // nothing was heard of her yet
      if (states[mmsi] == ShipState::kAisOnly) ++tally.ais_only;
      auto& count = tally.of_place.at(static_cast<std::size_t>(ship.place));
      const bool is_told = states[mmsi] == ShipState::kTracked;
      if (found != told.end() && found->second == mmsi) {
        ++count.right;
      } else if (is_told || found != told.end()) {
        ++count.wrong;
      } else {
        ++count.unsure;
      }
    }
  }
}

TEST(AisHarbour, TracksAreTheirShips) {
  Tally tally;
  for (int seed = FirstSeed(); seed < FirstSeed() + NumSeeds(); ++seed) JudgeHarbour(static_cast<unsigned>(seed), tally);
  Count all;
  Count alone;
  for (int i = 0; i < kNumPlaces; ++i) {
    const auto& count = tally.of_place.at(static_cast<std::size_t>(i));
    std::printf("%-13s %7lld scans: right %6.2f %%, unsure %6.2f %%, wrong %5.2f %%\n", kPlaceNames.at(static_cast<std::size_t>(i)),
                static_cast<long long>(count.all()), count.Percent(count.right), count.Percent(count.unsure), count.Percent(count.wrong));
    auto& sum = i == static_cast<int>(test::Place::kAlone) || i == static_cast<int>(test::Place::kUnderWay) ? alone : all;
    sum.right += count.right;
    sum.unsure += count.unsure;
    sum.wrong += count.wrong;
  }
  all.right += alone.right;
  all.unsure += alone.unsure;
  all.wrong += alone.wrong;
  const auto num_told = all.right + all.wrong + tally.without_ais_named;
  const double wrong_percent =
      100.0 * static_cast<double>(all.wrong + tally.without_ais_named) / static_cast<double>(std::max<std::int64_t>(num_told, 1));
  std::printf("all           %7lld scans: right %6.2f %%, unsure %6.2f %%, wrong %5.2f %%\n", static_cast<long long>(all.all()),
              all.Percent(all.right), all.Percent(all.unsure), all.Percent(all.wrong));
  std::printf("without AIS   %7lld scans: named %5.2f %%. Of what is told %.3f %% is wrong. AIS only though tracked: %lld\n",
              static_cast<long long>(tally.without_ais),
              100.0 * static_cast<double>(tally.without_ais_named) / static_cast<double>(tally.without_ais), wrong_percent,
              static_cast<long long>(tally.ais_only));
  EXPECT_GT(alone.Percent(alone.right), 90.0);
  EXPECT_LT(wrong_percent, 0.3);
  for (const auto& count : tally.of_place) EXPECT_LT(count.Percent(count.wrong), 1.0);
  const auto right = [&tally](test::Place place) {
    const auto& count = tally.of_place.at(static_cast<std::size_t>(place));
    return count.Percent(count.right);
  };
  EXPECT_GT(right(test::Place::kEncounter), 95.0);
  EXPECT_GT(right(test::Place::kAtQuay), 70.0);
  EXPECT_LT(tally.ais_only, all.all() / 1000) << "told as unseen though it is tracked";
}

}  // namespace
}  // namespace lookout::ais
