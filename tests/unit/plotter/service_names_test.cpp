// What targets are called: as people named them, as their ship of AIS, or as their track.
#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "services/plotter/service.hpp"
#include "tests/unit/plotter/fixture.hpp"

namespace lookout::plotter {
namespace {

class PlotterNames : public test::ServiceFixture {};

ais_t AisOf(std::int64_t track_id, const std::string& name, std::int64_t end_us, std::int64_t begin_us) {
  ais_t message{};
  message.utime_us = message.end_utime_us = end_us;
  message.tracks_begin_utime_us = begin_us;
  message.num_ships = 1;
  auto& ship = message.ships.emplace_back();
  ship = {};
  ship.mmsi = 211000001;
  ship.name = name;
  ship.state = ais_ship_t::STATE_TRACKED;
  ship.track_id = track_id;
  ship.arrival_utime_us = end_us;
  return message;
}

TEST_F(PlotterNames, CallsATargetAsItsShipUnlessPeopleGaveAName) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  support::Send(*bus_, bus::kAis, AisOf(17, "EVEREST", host_us_, begin_us_));
  Run(1'200'000);
  EXPECT_NE(signal_k_->With("gannet-1").back().find("EVEREST"), std::string::npos);
  support::Send(*bus_, bus::kAis, AisOf(17, "", host_us_, begin_us_));
  Run(1'200'000);
  EXPECT_NE(signal_k_->With("gannet-1").back().find("MMSI 211000001"), std::string::npos);
  names_ = {{17, "Kiosk pier"}};
  Run(1'200'000);
  EXPECT_NE(signal_k_->With("gannet-1").back().find("Kiosk pier"), std::string::npos);
  // Of another process of the tracker the number means another thing.
  names_.clear();
  support::Send(*bus_, bus::kAis, AisOf(17, "EVEREST", host_us_, begin_us_ + 1));
  Run(1'200'000);
  EXPECT_EQ(signal_k_->With("gannet-1").back().find("EVEREST"), std::string::npos);
}

TEST_F(PlotterNames, LeavesShipsOutForAPlotterThatHasAis) {
  params_.sends_ais_targets = false;
  Start();
  tracks_ = {MakeTrack(17), MakeTrack(18)};
  support::Send(*bus_, bus::kAis, AisOf(17, "EVEREST", host_us_ + 200'000, begin_us_));
  Run(1'000'000);
  EXPECT_TRUE(signal_k_->With("EVEREST").empty());
  EXPECT_FALSE(signal_k_->With("boat 18").empty());
  // What AIS may have dropped is there, and what comes near, with an alert or before it.
  const auto is_sent = [this](auto&& change) {
    signal_k_->sent.clear();
    auto ais = AisOf(17, "EVEREST", host_us_ + 200'000, begin_us_);
    tracks_ = {MakeTrack(17), MakeTrack(18)};
    change(ais.ships[0], tracks_[0]);
    support::Send(*bus_, bus::kAis, ais);
    Run(1'000'000);
    return signal_k_->sent.end() != std::ranges::find_if(signal_k_->sent, [](const auto& text) {
             return text.find("EVEREST") != std::string::npos && text.find("\"latitude\"") != std::string::npos;
           });
  };
  EXPECT_TRUE(is_sent([](auto& ship, auto&) { ship.arrival_utime_us -= 300'000'000; }));
  EXPECT_FALSE(is_sent([](auto&, auto&) {}));
  EXPECT_TRUE(is_sent([](auto&, auto& track) { track.cpa_probability = 0.9F; }));
  EXPECT_FALSE(is_sent([](auto&, auto&) {}));
  // What an alert tells of is there.
  alerts_ = {MakeAlert(3)};
  alerts_[0].track_id = 17;
  Run(500'000);
  EXPECT_FALSE(signal_k_->With("EVEREST").empty());
}

TEST_F(PlotterNames, CallsTargetsAsPeopleDo) {
  tracks_ = {MakeTrack(17)};
  names_ = {{17, "Kiosk pier"}};
  Run(300'000);
  Clear();
  Run(3'000'000);
  EXPECT_FALSE(nmea_->With(",Kiosk pier,T,").empty());
  EXPECT_FALSE(signal_k_->With("Kiosk pier").empty());
  // Another process of the tracker: its track 17 is of another thing.
  names_.clear();
  begin_us_ += 1'000'000;
  Clear();
  Run(3'000'000);
  EXPECT_TRUE(nmea_->With(",Kiosk pier,T,").empty());
}

TEST_F(PlotterNames, TellsAlertsAlsoWhereANameIsNone) {
  tracks_ = {MakeTrack(17)};
  names_ = {{17, "\x1b[31m"}};
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  EXPECT_GT(Count("names_refused"), 0);
  EXPECT_FALSE(nmea_->With("ALR").empty());
  EXPECT_FALSE(nmea_->With(",boat 17,T,").empty());
  EXPECT_TRUE(nmea_->With("\x1b").empty());
}

}  // namespace
}  // namespace lookout::plotter
