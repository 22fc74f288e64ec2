// Input that is wrong: it is counted, told, and never makes a wrong track.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tests/unit/tracker_shell/service_fixture.hpp"

namespace lookout::tracker {
namespace {

class TrackerBadInput : public test::ServiceFixture {
 protected:
  // The boat at a place that does not move, its poses from a scan's begin to the next.
  void SendPoses(int number, double north_m = 0.0, std::int32_t status = pose_t::STATUS_OK) {
    for (int i = 0; i < 5; ++i) {
      auto pose = test::MakePose(test::kScanUs * number + 20'000 * i, 5 * number + i);
      pose.position_map_m[1] = north_m;
      pose.status = status;
      Send(bus::kPose, pose);
    }
  }
  // A thing 20 m to the north of a place, and one 30 m to the east of it.
  static obstacles_t Obstacles(int number, double north_m = 0.0) {
    const auto offset_us = test::kScanUs * number;
    return test::MakeObstacles(offset_us, number,
                               {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {0.0, north_m + 20.0}),
                                test::MakeObstacle(2, test::kStartUs + offset_us + 60'000, {30.0, north_m})});
  }
  void SendScan(int number, double north_m = 0.0) {
    SendPoses(number, north_m);
    SendSight(number, number);
    Send(bus::kObstacles, Obstacles(number, north_m));
  }
  // Each track lies where something stands, and stands itself.
  void ExpectRightTracks(std::size_t first_message, const std::vector<double>& norths_m) const {
    for (auto i = first_message; i < tracks_.size(); ++i) {
      for (const auto& track : tracks_[i].tracks) {
        const auto is_at = [&](double east_m, double north_m) {
          return std::hypot(track.position_map_m[0] - east_m, track.position_map_m[1] - north_m) < 1.5;
        };
        EXPECT_TRUE(std::ranges::any_of(norths_m, [&](double north_m) { return is_at(0.0, north_m + 20.0) || is_at(30.0, north_m); }))
            << track.position_map_m[0] << ", " << track.position_map_m[1] << " in scan " << tracks_[i].seq;
        EXPECT_EQ(track.speed_mps, 0.0F);
      }
    }
  }
};

TEST_F(TrackerBadInput, BeamsAndLabelsOfOtherScansAreNotUsed) {
  SendScan(0);
  for (int i = 1; i < 12; ++i) {
    SendPoses(i);
    // The same time with another number, another time with the same number.
    Send(bus::kLidarScan, test::MakeScan(test::kScanUs * i, i + 1));
    auto labels = test::MakeSegments(test::kScanUs * i, i);
    labels.utime_us += 1;
    Send(bus::kSegments, labels);
    Send(bus::kObstacles, Obstacles(i));
  }
  SendScan(12);
  SendScan(13);
  ASSERT_GE(tracks_.size(), 13U);
  for (std::size_t i = 1; i < 12; ++i) EXPECT_EQ(tracks_[i].sight, tracks_t::SIGHT_UNKNOWN) << i;
  EXPECT_GE(Count("scans_without_sight"), 11);
  ExpectRightTracks(0, {0.0});
  ASSERT_EQ(tracks_.back().num_tracks, 2);
}

// Labels that fit no beams: fewer returns, fewer columns.
TEST_F(TrackerBadInput, LabelsThatDoNotFitTheBeamsAreCounted) {
  for (int i = 0; i < 5; ++i) {
    SendPoses(i);
    Send(bus::kLidarScan, test::MakeScan(test::kScanUs * i, i));
    auto labels = test::MakeSegments(test::kScanUs * i, i);
    labels.num_columns -= 1;
    labels.num_cells -= test::kNumRings;
    labels.label.resize(static_cast<std::size_t>(labels.num_cells));
    Send(bus::kSegments, labels);
    Send(bus::kObstacles, Obstacles(i));
  }
  SendPoses(5);
  EXPECT_EQ(tracks_.size(), 5U);
  EXPECT_EQ(Count("labels_inconsistent"), 5);
}

// A piece of two segments; as many pieces as labels above 0 but one.
TEST_F(TrackerBadInput, PiecesThatDoNotFitTheLabelsAreCounted) {
  const auto send = [this](int i, std::int16_t second_piece, std::size_t num_pieces) {
    SendPoses(i);
    Send(bus::kLidarScan, test::MakeScan(test::kScanUs * i, i));
    auto labels = test::MakeSegments(test::kScanUs * i, i);
    labels.piece.assign(labels.label.begin() + 1, labels.label.end());
    labels.piece[1] = second_piece;
    labels.piece.resize(num_pieces);
    labels.num_labelled = static_cast<std::int32_t>(num_pieces);
    Send(bus::kSegments, labels);
    Send(bus::kObstacles, Obstacles(i));
  };
  for (int i = 0; i < 3; ++i) send(i, 2, 19);
  EXPECT_EQ(Count("labels_inconsistent"), 0);
  for (int i = 3; i < 6; ++i) send(i, 1, 19);
  for (int i = 6; i < 8; ++i) send(i, 2, 18);
  send(8, 2, 19);
  SendPoses(9);
  EXPECT_EQ(tracks_.size(), 9U);
  EXPECT_EQ(Count("labels_inconsistent"), 3);
  EXPECT_EQ(Count("segments_refused_count"), 2);
}

TEST_F(TrackerBadInput, AJumpOfTenKilometresBeginsAnewAndMovesNoTrack) {
  constexpr double kJumpM = 10'000.0;
  for (int i = 0; i < 20; ++i) SendScan(i);
  const auto before = tracks_.back();
  ASSERT_EQ(before.num_tracks, 2);
  const auto first = tracks_.size();
  for (int i = 20; i < 40; ++i) SendScan(i, kJumpM);
  SendPoses(40, kJumpM);
  EXPECT_EQ(Count("restarts_by_jump"), 1);
  ExpectRightTracks(0, {0.0, kJumpM});
  const auto& last = tracks_.back();
  ASSERT_EQ(last.num_tracks, 2);
  for (const auto& track : last.tracks) {
    EXPECT_GT(track.id, before.tracks.back().id);
    EXPECT_GT(track.position_map_m[1], kJumpM - 100.0);
    EXPECT_EQ(track.status, track_t::STATUS_CONFIRMED);
  }
  for (auto i = first; i < tracks_.size(); ++i) {
    for (const auto& track : tracks_[i].tracks) EXPECT_LT(track.range_m, 100.0F) << "nothing of the old place is left";
  }
  for (const auto& message : alerts_) EXPECT_EQ(message.num_alerts, 0);
}

// A receiver that errs for one fix: nobody knows where the boat was in two scans, and tracks go on.
TEST_F(TrackerBadInput, APlaceThatIsWrongForOneScanLeavesNoTrackThere) {
  constexpr double kJumpM = 10'000.0;
  for (int i = 0; i < 20; ++i) SendScan(i);
  const auto before = tracks_.back();
  SendScan(20, kJumpM);
  for (int i = 21; i < 50; ++i) SendScan(i);
  SendPoses(50);
  EXPECT_EQ(Count("scans_with_jump"), 2);
  EXPECT_EQ(Count("restarts_by_jump"), 0);
  ExpectRightTracks(0, {0.0});
  ASSERT_EQ(tracks_.back().num_tracks, 2);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(tracks_.back().tracks[i].id, before.tracks[i].id);
}

// The heading is lost: nobody knows where what is seen lies. Tracks stay where they were, less and less sure, and end.
TEST_F(TrackerBadInput, WithoutAHeadingTracksCoastAndEnd) {
  for (int i = 0; i < 20; ++i) SendScan(i);
  ASSERT_EQ(tracks_.back().num_tracks, 2);
  EXPECT_TRUE(service_.Report().reason.empty()) << service_.Report().reason;
  const auto first = tracks_.size();
  constexpr int kNumScans = 320;
  for (int i = 20; i < 20 + kNumScans; ++i) {
    SendPoses(i, 0.0, pose_t::STATUS_NO_HEADING);
    SendSight(i, i);
    Send(bus::kObstacles, test::InTheVesselFrame(Obstacles(i)));
    if (i == 40) {
      EXPECT_NE(service_.Report().reason.find("no position or heading"), std::string::npos) << service_.Report().reason;
    }
  }
  ASSERT_GE(tracks_.size(), first + kNumScans - 1);
  EXPECT_GE(Count("scans_without_pose"), kNumScans - 1);
  EXPECT_GE(Count("obstacles_not_placed"), 2 * (kNumScans - 1));
  ExpectRightTracks(0, {0.0});
  std::map<std::int64_t, double> spread_m2;
  std::set<std::int64_t> lost;
  for (auto i = first; i < tracks_.size(); ++i) {
    const double unseen_s = 0.1 * static_cast<double>(i - first);
    for (const auto& track : tracks_[i].tracks) {
      EXPECT_FALSE(lost.contains(track.id)) << "it is told once";
      if (track.status == track_t::STATUS_LOST) lost.insert(track.id);
      if (unseen_s > 1.5) {
        EXPECT_NE(track.status, track_t::STATUS_CONFIRMED) << unseen_s;
      }
      const double spread = track.covariance[0][0] + track.covariance[1][1];
      const auto known = spread_m2.find(track.id);
      if (known != spread_m2.end() && i > first + 1) {
        EXPECT_GT(spread, known->second) << "after " << unseen_s << " s";
      }
      spread_m2[track.id] = spread;
    }
  }
  EXPECT_EQ(lost.size(), 2U);
  EXPECT_EQ(tracks_.back().num_tracks, 0);
}

// What navigator says of one map does not place what georeferencer says of another.
TEST_F(TrackerBadInput, AnotherDatumBeginsAnew) {
  for (int i = 0; i < 10; ++i) SendScan(i);
  for (int i = 10; i < 30; ++i) {
    SendPoses(i);
    SendSight(i, i);
    auto message = Obstacles(i);
    message.datum_longitude_deg += 0.5;
    Send(bus::kObstacles, message);
  }
  SendPoses(30);
  EXPECT_GE(Count("scans_without_pose"), 20);
  for (const auto& message : tracks_) {
    for (const auto& track : message.tracks) EXPECT_EQ(track.speed_mps, 0.0F);
  }
}

// Time goes back by less than an hour's drift and by years.
TEST_F(TrackerBadInput, TimeThatGoesBackBeginsAnew) {
  for (const int start : {30'000, 20'000, 19'990, 0}) {
    for (int i = start; i < start + 20; ++i) SendScan(i);
  }
  EXPECT_GE(Count("runs_begun"), 3);
  EXPECT_GE(tracks_.size(), 76U);
  ExpectRightTracks(0, {0.0});
  EXPECT_EQ(tracks_.back().num_tracks, 2);
  std::int64_t last_id = 0;
  for (const auto& message : tracks_) {
    for (const auto& track : message.tracks) last_id = std::max(last_id, track.id);
  }
  EXPECT_GT(tracks_.back().tracks[0].id, 2) << "ids are not used again";
}

// Beams, labels, obstacles and poses in any order within half a second, some twice, some not at all.
TEST_F(TrackerBadInput, InAnyOrderDoubledAndMissingMakesNoWrongTrack) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    bus::MemoryBus bus;
    Service service(bus, test::MakeParams());
    tracks_.clear();
    bus::Subscribe<tracks_t>(bus, bus::kTracks, [this](const tracks_t& message) { tracks_.push_back(message); });
    std::mt19937 random(seed);
    std::vector<std::pair<double, std::pair<const bus::Channel*, std::vector<std::uint8_t>>>> messages;
    const auto add = [&](const bus::Channel& channel, double time_s, const auto& message) {
      for (auto copies = random() % 20 == 0 ? 0U : random() % 10 == 0 ? 2U : 1U; copies > 0; --copies) {
        messages.push_back({time_s + std::uniform_real_distribution<double>(0.0, 0.5)(random), {&channel, bus::Encode(message)}});
      }
    };
    for (int i = 0; i < 60; ++i) {
      for (int k = 0; k < 5; ++k) add(bus::kPose, 0.1 * i, test::MakePose(test::kScanUs * i + 20'000 * k, 5 * i + k));
      add(bus::kLidarScan, 0.1 * i, test::MakeScan(test::kScanUs * i, i));
      add(bus::kSegments, 0.1 * i, test::MakeSegments(test::kScanUs * i, i));
      add(bus::kObstacles, 0.1 * i, Obstacles(i));
    }
    std::ranges::stable_sort(messages, {}, [](const auto& one) { return one.first; });
    for (const auto& [time_s, message] : messages) {
      bus.Publish(*message.first, message.second);
      support::HandleAll(bus);
    }
    service.Finish();
    support::HandleAll(bus);
    EXPECT_GT(tracks_.size(), 10U);
    EXPECT_LE(tracks_.size(), 60U);
    ExpectRightTracks(0, {0.0});
  }
}

void ExpectSound(const tracks_t& message) {
  for (const auto& track : message.tracks) {
    EXPECT_TRUE(std::isfinite(track.position_map_m[0]) && std::isfinite(track.position_map_m[1]) && std::isfinite(track.latitude_deg));
    EXPECT_TRUE(std::isfinite(track.velocity_map_mps[0]) && std::isfinite(track.velocity_map_mps[1]));
    for (int i = 0; i < 4; ++i) EXPECT_GE(track.covariance[i][i], 0.0);
    for (const auto share : {track.existence_probability, track.moving_probability, track.cpa_probability}) {
      EXPECT_TRUE(share >= 0.0F && share <= 1.0F) << share;
    }
  }
}

// One number of a message each time, at any place, of those that hurt.
TEST_F(TrackerBadInput, HostileNumbersMakeNoUnsoundTrack) {
  bus::Subscribe<tracks_t>(bus_, bus::kTracks, ExpectSound);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::array numbers{kNan, kInfinity, -kInfinity, 1e308, -1e308, 1e30, 1e10, 5e-324, -1.0, 0.0};
  const std::array<std::uint32_t, 4> counts{0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x00010000};
  constexpr std::size_t kFingerprintBytes = 8;
  std::mt19937 random(1);
  const auto put = [](std::vector<std::uint8_t>& bytes, std::size_t place, std::uint64_t bits, std::size_t size) {
    for (std::size_t i = 0; i < size && place + i < bytes.size(); ++i) bytes[place + i] = static_cast<std::uint8_t>(bits >> (8 * (size - 1 - i)));
  };
  for (int i = 0; i < 4000; ++i) {
    std::vector<std::pair<const bus::Channel*, std::vector<std::uint8_t>>> messages;
    for (int k = 0; k < 5; ++k) messages.emplace_back(&bus::kPose, bus::Encode(test::MakePose(test::kScanUs * i + 20'000 * k, 5 * i + k)));
    messages.emplace_back(&bus::kLidarScan, bus::Encode(test::MakeScan(test::kScanUs * i, i)));
    messages.emplace_back(&bus::kSegments, bus::Encode(test::MakeSegments(test::kScanUs * i, i)));
    messages.emplace_back(&bus::kObstacles, bus::Encode(Obstacles(i)));
    auto& spoiled = messages[random() % messages.size()].second;
    const std::size_t place = kFingerprintBytes + random() % (spoiled.size() - kFingerprintBytes);
    const double number = numbers[random() % numbers.size()];
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof(bits));
    const auto as_float = static_cast<float>(std::isfinite(number) ? std::clamp(number, -3e38, 3e38) : number);
    std::uint32_t float_bits = 0;
    std::memcpy(&float_bits, &as_float, sizeof(float_bits));
    switch (random() % 3) {
      case 0:
        put(spoiled, place, bits, 8);
        break;
      case 1:
        put(spoiled, place, float_bits, 4);
        break;
      default:
        put(spoiled, place, counts[random() % counts.size()], 4);
    }
    for (const auto& [channel, bytes] : messages) bus_.Publish(*channel, bytes);
    HandleAll();
    if (HasFailure()) FAIL() << "scan " << i;
  }
  EXPECT_GT(tracks_.size(), 2500U);
  // A scan or two after what was spoiled, all is as it was.
  for (int i = 4000; i < 4030; ++i) SendScan(i);
  EXPECT_EQ(tracks_.back().num_tracks, 2);
}

// As fast as a computer can read them: what is too much is left out and counted, the nearest and surest stay.
TEST_F(TrackerBadInput, FortyThousandObstaclesAScanTakeBoundedTime) {
  constexpr int kNumObstacles = 40'000;
  constexpr int kOfAPart = 100;
  constexpr int kNumScans = 3;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kNumScans; ++i) {
    SendPoses(i);
    SendSight(i, i);
    std::mt19937 random(static_cast<std::uint32_t>(i));
    for (int part = 0; part < kNumObstacles / kOfAPart; ++part) {
      std::vector<obstacle_t> obstacles;
      for (int k = part * kOfAPart; k < (part + 1) * kOfAPart; ++k) {
        const std::pair place(std::uniform_real_distribution<double>(-100.0, 100.0)(random),
                              std::uniform_real_distribution<double>(-100.0, 100.0)(random));
        auto& obstacle = obstacles.emplace_back(test::MakeObstacle(k + 1, test::kStartUs + test::kScanUs * i, place));
        obstacle.range_m = static_cast<float>(std::hypot(place.first, place.second));
        if (k % 2 == 1) obstacle.confidence = obstacle_t::CONFIDENCE_TENTATIVE;
      }
      auto message = test::MakeObstacles(test::kScanUs * i, i, std::move(obstacles));
      message.part_index = part;
      message.num_parts = kNumObstacles / kOfAPart;
      Send(bus::kObstacles, message);
    }
  }
  SendPoses(kNumScans);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_FALSE(tracks_.empty());
  EXPECT_EQ(Count("obstacles_over_limit"), kNumScans * (kNumObstacles - kMostObstacles));
  EXPECT_LT(took_s, 60.0);
  std::printf("%.2f s a scan\n", took_s / kNumScans);
}

}  // namespace
}  // namespace lookout::tracker
