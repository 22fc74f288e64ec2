#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/plotter/core/nmea0183.hpp"
#include "services/plotter/service.hpp"
#include "tests/unit/plotter/fixture.hpp"

namespace lookout::plotter {
namespace {

class PlotterAlerts : public test::ServiceFixture {};

std::string Ack(const std::string& body) {
  auto sentence = Sentence(body);
  sentence.resize(sentence.size() - 2);
  return sentence;
}

TEST_F(PlotterAlerts, PassesAcknowledgementsOn) {
  alerts_ = {MakeAlert(3), MakeAlert(4, alert_t::STATE_ACKNOWLEDGED)};
  Run(300'000);
  nmea_->received = {Ack("IIACK,003"), Ack("IIACK,003"), Ack("IIACK,004"), Ack("IIACK,077"), "garbage", Ack("GPGGA,1")};
  Wait(100'000);
  ASSERT_EQ(acknowledged_.size(), 1U);
  EXPECT_EQ(acknowledged_[0].alert_id, 3);
  EXPECT_EQ(acknowledged_[0].alert_raised_utime_us, test::kStartUs);
  EXPECT_EQ(acknowledged_[0].source, "plotter");
  EXPECT_EQ(Count("acks_sent"), 1);
  EXPECT_EQ(Count("acks_of_no_alert"), 1);
  EXPECT_EQ(Count("lines_refused"), 1);
}

// As signalk-server 2.23 says that somebody has acknowledged what it was sent.
std::string AcknowledgedDelta(const std::string& sent) {
  auto delta = nlohmann::json::parse(sent);
  delta["context"] = "vessels.urn:mrn:signalk:uuid:1";
  auto& value = delta["updates"][0]["values"][0]["value"];
  value["method"] = nlohmann::json::array();
  value["status"] = {{"silenced", true}, {"acknowledged", true}};
  return delta.dump();
}

TEST_F(PlotterAlerts, PassesAcknowledgementsOfSignalKOn) {
  alerts_ = {MakeAlert(3)};
  sounding_alert_id_ = 3;
  Run(300'000);
  const auto sent = signal_k_->With("closestApproach3").at(0);
  signal_k_->received = {sent};  // our own, come back
  Wait(100'000);
  EXPECT_TRUE(acknowledged_.empty());
  signal_k_->received = {AcknowledgedDelta(sent)};
  Wait(100'000);
  ASSERT_EQ(acknowledged_.size(), 1U);
  EXPECT_EQ(acknowledged_[0].alert_id, 3);
}

// A server remembers by path what was acknowledged: what grows graver then must have another.
TEST_F(PlotterAlerts, RaisesWhatGrewGraverUnderAnotherPath) {
  alerts_ = {MakeAlert(3)};
  alerts_[0].level = alert_t::LEVEL_CAUTION;
  Run(300'000);
  const auto first = signal_k_->With("closestApproach3").at(0);
  alerts_[0].state = alert_t::STATE_ACKNOWLEDGED;
  alerts_[0].changed_utime_us += 1'000'000;
  Run(300'000);
  Clear();
  alerts_[0].state = alert_t::STATE_ACTIVE;
  alerts_[0].level = alert_t::LEVEL_WARNING;
  alerts_[0].changed_utime_us += 1'000'000;
  Run(300'000);
  const auto sent = signal_k_->With("closestApproach3");
  ASSERT_EQ(sent.size(), 2U);
  const auto path_of = [](const std::string& text) { return nlohmann::json::parse(text)["updates"][0]["values"][0]["path"].get<std::string>(); };
  EXPECT_EQ(path_of(sent[0]), path_of(first));
  EXPECT_NE(sent[0].find("\"normal\""), std::string::npos);
  EXPECT_NE(path_of(sent[1]), path_of(first));
  EXPECT_NE(sent[1].find("\"alarm\""), std::string::npos);
  signal_k_->received = {AcknowledgedDelta(first)};  // late, of the caution
  Wait(100'000);
  EXPECT_TRUE(acknowledged_.empty());
}

// Nobody has acknowledged a warning for five minutes: it is raised anew, once, under another path. A server that was told to silence it keeps that
// path silent for ever.
TEST_F(PlotterAlerts, RaisesAWarningAnewThatNobodyAcknowledges) {
  alerts_ = {MakeAlert(3)};
  alerts_[0].raised_utime_us = alerts_[0].changed_utime_us = host_us_;
  sounding_alert_id_ = 3;
  signal_k_->room = 1'000'000'000;
  Run(290'000'000);
  const auto first = signal_k_->With("closestApproach3").at(0);
  EXPECT_TRUE(signal_k_->With("escalated").empty());
  Clear();
  Run(15'000'000);
  const auto again = signal_k_->With("escalated1");
  ASSERT_FALSE(again.empty());
  EXPECT_NE(again[0].find(R"("state":"alarm","method":["visual","sound"])"), std::string::npos) << again[0];
  const auto ended = signal_k_->With("\"normal\"");
  ASSERT_FALSE(ended.empty());
  EXPECT_EQ(ended[0].find("escalated"), std::string::npos);
  signal_k_->received = {AcknowledgedDelta(again[0])};
  Wait(100'000);
  EXPECT_EQ(acknowledged_.size(), 1U);
}

// A caution that was a warning is the same alert, told once.
TEST_F(PlotterAlerts, TellsOnceThatAnAlertGrewLess) {
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  Clear();
  alerts_[0].level = alert_t::LEVEL_CAUTION;
  alerts_[0].changed_utime_us += 1'000'000;
  Run(300'000);
  const auto sent = signal_k_->With("closestApproach3");
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_NE(sent[0].find(R"("state":"warn")"), std::string::npos) << sent[0];
}

// What comes back from "over, not acknowledged" is told anew: an acknowledgement of what was over is none of it.
TEST_F(PlotterAlerts, RaisesWhatComesBackUnderAnotherPath) {
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  const auto first = signal_k_->With("closestApproach3").at(0);
  alerts_[0].state = alert_t::STATE_RECTIFIED;
  alerts_[0].changed_utime_us += 1'000'000;
  Run(300'000);
  alerts_[0].state = alert_t::STATE_ACTIVE;
  alerts_[0].changed_utime_us += 1'000'000;
  Run(300'000);
  signal_k_->received = {AcknowledgedDelta(first)};
  Wait(100'000);
  EXPECT_TRUE(acknowledged_.empty());
}

// The watch's alerts by the clock have ids below 0: by its absolute value one of them had the name of that of the guard zone.
TEST_F(PlotterAlerts, TellsThatAPartIsNotLookedIntoApartFromThatNobodyLooks) {
  alerts_ = {MakeAlert(3), MakeAlert(-3)};
  for (auto& alert : alerts_) alert.cause = alert_t::CAUSE_WATCH;
  alerts_[0].text = "no look-out in part of the guard zone: 270 to 90 deg (the lidar does not fire there)";
  Run(300'000);
  ASSERT_FALSE(signal_k_->With("lookoutGap3at").empty());
  EXPECT_NE(signal_k_->With("lookoutGap3at")[0].find("270 to 90 deg"), std::string::npos);
  EXPECT_FALSE(signal_k_->With("noLookout3at").empty());
}

// Two boats sounded at once on a display, and went on when somebody had pressed "silence" on the page.
TEST_F(PlotterAlerts, SoundOnceAndAreSilencedOverSignalK) {
  const auto method_of = [this](std::string_view alert) {
    const auto sent = signal_k_->With(alert);
    return sent.empty() ? "" : nlohmann::json::parse(sent.back())["updates"][0]["values"][0]["value"]["method"].dump();
  };
  alerts_ = {MakeAlert(3), MakeAlert(4)};
  sounding_alert_id_ = 3;
  Run(300'000);
  EXPECT_EQ(method_of("closestApproach3at"), R"(["visual","sound"])");
  EXPECT_EQ(method_of("closestApproach4at"), R"(["visual"])");
  nmea_->sent.clear();
  sounding_alert_id_ = 0;
  silenced_until_us_ = host_us_ + 30'000'000;
  Run(300'000);
  EXPECT_EQ(method_of("closestApproach3at"), R"(["visual"])");
  EXPECT_TRUE(nmea_->With("ALR").empty()) << "it has no word for it";
}

// What goes out without sound comes back without: no person has taken note. Nor is what was told so before it sounded, and is on its way back.
TEST_F(PlotterAlerts, TakeNoEchoOfWhatDoesNotSoundForAnAcknowledgement) {
  alerts_ = {MakeAlert(3), MakeAlert(4)};
  sounding_alert_id_ = 3;
  Run(300'000);
  const auto quiet = signal_k_->With("closestApproach4at").at(0);
  signal_k_->received = {quiet};
  Wait(100'000);
  EXPECT_TRUE(acknowledged_.empty());
  sounding_alert_id_ = 4;
  Run(300'000);
  signal_k_->received = {quiet};
  Wait(100'000);
  EXPECT_TRUE(acknowledged_.empty());
  const auto loud = signal_k_->With("closestApproach4at").back();
  signal_k_->received = {loud};
  Wait(100'000);
  // A server that is there again tells first what it has kept, however old.
  ++signal_k_->openings;
  Run(4'000'000);
  signal_k_->received = {quiet};
  Wait(100'000);
  EXPECT_TRUE(acknowledged_.empty());
  signal_k_->received = {loud, quiet};  // an older display
  Wait(100'000);
  ASSERT_EQ(acknowledged_.size(), 1U);
  EXPECT_EQ(acknowledged_[0].alert_id, 4);
  auto normal = nlohmann::json::parse(signal_k_->With("closestApproach3at").at(0));
  normal["updates"][0]["values"][0]["value"]["state"] = "normal";
  signal_k_->received = {normal.dump()};
  Wait(100'000);
  ASSERT_EQ(acknowledged_.size(), 2U);
  EXPECT_EQ(acknowledged_[1].alert_id, 3);
}

// A server keeps what a process told that was killed.
TEST_F(PlotterAlerts, EndsAlarmsOfAProcessBefore) {
  Run(300'000);
  Clear();
  const std::string left =
      R"({"context":"vessels.urn:1","updates":[{"values":[{"path":"notifications.lookout.guardZone9at1","value":{"state":"alarm","method":["sound"]}}]}]})";
  signal_k_->received = {left, left};
  Wait(200'000);
  const auto sent = signal_k_->With("guardZone9at1");
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_NE(sent[0].find("\"normal\""), std::string::npos);
}

TEST_F(PlotterAlerts, TakesNoAcknowledgementWhereConfigDoesNot) {
  std::vector<std::unique_ptr<Output>> outputs;
  auto link = std::make_unique<test::KeepingLink>();
  link->received = {Ack("IIACK,003")};
  outputs.push_back(std::make_unique<NmeaOutput>(OutputParams{.name = "nmea"}, std::move(link), params_.target_period));
  NewBus();
  service_ = std::make_unique<Service>(*bus_, params_, std::move(outputs));
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  EXPECT_TRUE(acknowledged_.empty());
  EXPECT_EQ(Count("acks_sent"), 0);
}

// More alerts than there are numbers of ALR, and than are kept once they are over: the next one is told as the first was, and sounds.
TEST_F(PlotterAlerts, TellAFurtherBoatAfterAThousandOthers) {
  constexpr std::int64_t kNum = 1200;
  const auto raise = [this](std::int64_t id) {
    alerts_ = {MakeAlert(id)};
    alerts_[0].raised_utime_us = alerts_[0].changed_utime_us = host_us_;
    sounding_alert_id_ = id;
    Run(100'000);
  };
  for (std::int64_t id = 1; id <= kNum; ++id) {
    raise(id);
    sounding_alert_id_ = 0;
    if (id % 3 == 0) silenced_until_us_ = host_us_ + 30'000'000;
    if (id % 3 == 1) {
      const auto number = std::to_string(1000 + (id - 1) % 997 + 1).substr(1);
      nmea_->received = {Ack("IIACK," + number)};
      Wait(100'000);
      alerts_[0].state = alert_t::STATE_ACKNOWLEDGED;
    }
    Run(100'000);
    alerts_.clear();
    Run(100'000);
    if (id % 50 == 0) Run(1'000'000);
    Clear();
    nmea_->room = signal_k_->room = 1'000'000;
  }
  EXPECT_EQ(acknowledged_.size(), static_cast<std::size_t>(kNum) / 3);
  raise(kNum + 1);
  EXPECT_FALSE(nmea_->With(",204,A,V,").empty());
  const auto told = signal_k_->With("closestApproach1201");
  ASSERT_FALSE(told.empty());
  EXPECT_NE(told.back().find("\"sound\""), std::string::npos) << told.back();
  EXPECT_EQ(Count("lines_dropped"), 0);
}

}  // namespace
}  // namespace lookout::plotter
