// An output that tells of alerts by ALF, with the list, the heartbeat and the commands that belong to it.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "lookout/order_t.hpp"
#include "services/plotter/core/alert_sentences.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/plotter/fixture.hpp"

namespace lookout::plotter {
namespace {

std::string Received(const std::string& body) {
  auto sentence = Sentence(body);
  sentence.resize(sentence.size() - 2);
  return sentence;
}

class AlfOutput : public test::ServiceFixture {
 protected:
  void SetUp() override { StartWith(true); }

  void StartWith(bool takes_acknowledgements) {
    auto link = std::make_unique<test::KeepingLink>();
    link_ = link.get();
    std::vector<std::unique_ptr<Output>> outputs;
    outputs.push_back(
        std::make_unique<NmeaOutput>(OutputParams{.name = "bridge", .alerts = SentAlerts::kAlf, .takes_acknowledgements = takes_acknowledgements},
                                     std::move(link), params_.target_period, RevisionFile(revisions_)));
    NewBus();
    bus::Subscribe<order_t>(*bus_, bus::kOrders, [this](const order_t& message) { ordered_.push_back(message); });
    service_ = std::make_unique<Service>(*bus_, params_, std::move(outputs));
    service_->AdvanceTo(Now());
  }

  std::vector<std::string> Answers(const std::string& body) {
    link_->sent.clear();
    link_->received = {Received(body)};
    Wait(200'000);
    return link_->With("ARC");
  }

  support::TempDir folder_;
  std::filesystem::path revisions_ = folder_ / "alerts.txt";
  test::KeepingLink* link_ = nullptr;
  std::vector<order_t> ordered_;
};

TEST_F(AlfOutput, ListsWhatStandsAndSaysThatItLives) {
  alerts_ = {MakeAlert(3), MakeAlert(4)};
  Run(300'000);
  ASSERT_EQ(link_->With("HBT").size(), 1U) << "a new receiver need not wait";
  link_->sent.clear();
  alerts_[0].state = alert_t::STATE_ACKNOWLEDGED;
  Run(31'000'000);
  ASSERT_EQ(link_->With("RAHBT,30,A,").size(), 1U);
  ASSERT_EQ(link_->With("RAALC,01,01,01,2,LKO,10002,3,2,LKO,10002,4,1*").size(), 1U);
  link_->sent.clear();
  Wait(31'000'000);  // the tracker is silent
  EXPECT_FALSE(link_->With("RAHBT,30,V,").empty());
  EXPECT_FALSE(link_->With(",LKO,10002,3,2,").empty()) << "nobody knows that it is over";
}

TEST_F(AlfOutput, ObeysCommandsThatFitAndRefusesOthers) {
  alerts_ = {MakeAlert(3), MakeAlert(4, alert_t::STATE_ACKNOWLEDGED)};
  Run(300'000);
  EXPECT_TRUE(Answers("CAACN,102031.00,LKO,10002,3,A,C").empty());
  ASSERT_EQ(acknowledged_.size(), 1U);
  EXPECT_EQ(acknowledged_[0].alert_id, 3);
  EXPECT_TRUE(Answers("CAACN,102031.00,LKO,10002,4,Q,C").empty());
  EXPECT_EQ(link_->With(",B,W,A,LKO,10002,4,1,0,").size(), 1U);
  EXPECT_TRUE(link_->With(",LKO,10002,3,1,0,").empty());
  EXPECT_TRUE(Answers("CAACN,102031.00,LKO,10002,3,S,C").empty());
  ASSERT_EQ(ordered_.size(), 1U);
  EXPECT_EQ(ordered_[0].kind, order_t::KIND_SILENCE);
  EXPECT_EQ(acknowledged_.size(), 1U) << "silence is no acknowledgement";

  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10002,4,A,C").size(), 1U) << "acknowledged already";
  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10002,3,O,C").size(), 1U) << "who looks out cannot hand it over";
  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10002,77,Q,C").size(), 1U) << "of no alert";
  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10002,77,A,C").at(0).find("$RAARC,"), 0U);
  EXPECT_TRUE(Answers("CAACN,102031.00,XYZ,10002,77,A,C").empty()) << "of another maker";
  EXPECT_EQ(acknowledged_.size(), 1U);
  link_->sent.clear();
  for (int i = 0; i < 1000; ++i) link_->received.push_back(Received("CAACN,102031.00,LKO,10002,77,A,C"));
  Wait(1'000'000);
  EXPECT_LE(link_->With("ARC").size(), 11U) << "a flood is not answered line by line";
}

TEST_F(AlfOutput, RefusesAllThatSilencesWhereTheConfigTakesNone) {
  StartWith(false);
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10002,3,A,C").size(), 1U);
  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10002,3,S,C").size(), 1U);
  EXPECT_TRUE(Answers("CAACN,102031.00,LKO,10002,3,Q,C").empty());
  EXPECT_TRUE(acknowledged_.empty());
  EXPECT_TRUE(ordered_.empty());
}

TEST_F(AlfOutput, RaisesAgainWhatNobodyAcknowledges) {
  alerts_ = {MakeAlert(3)};
  Run(290'000'000);
  EXPECT_TRUE(link_->With(",LKO,10002,3,2,").empty());
  Run(20'000'000);
  EXPECT_FALSE(link_->With(",B,W,V,LKO,10002,3,2,1,").empty());
  alerts_[0].state = alert_t::STATE_ACKNOWLEDGED;
  link_->sent.clear();
  Run(300'000);
  EXPECT_EQ(link_->With(",B,W,A,LKO,10002,3,3,0,").size(), 1U);
}

// The clock of the host was set ahead by an hour, as by the first fix: each warning was raised again at once.
TEST_F(AlfOutput, RaisesAgainByTimePassedAndNotByTheClock) {
  alerts_ = {MakeAlert(3)};
  Run(60'000'000);
  host_us_ += 3'600'000'000;
  Run(60'000'000);
  EXPECT_TRUE(link_->With(",LKO,10002,3,2,").empty());
  // A warning that comes up after a step back, the same.
  host_us_ -= 7'200'000'000;
  alerts_.push_back(MakeAlert(4));
  alerts_[1].raised_utime_us = alerts_[1].changed_utime_us = host_us_;
  Run(290'000'000);
  EXPECT_FALSE(link_->With(",B,W,V,LKO,10002,3,2,1,").empty());
  EXPECT_TRUE(link_->With(",LKO,10002,4,2,").empty());
  Run(20'000'000);
  EXPECT_FALSE(link_->With(",B,W,V,LKO,10002,4,2,1,").empty());
}

TEST_F(AlfOutput, GoesOnWithItsRevisionsAfterARestart) {
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  alerts_[0].state = alert_t::STATE_ACKNOWLEDGED;
  Run(300'000);
  StartWith(true);
  Run(300'000);
  EXPECT_EQ(link_->With(",B,W,A,LKO,10002,3,2,0,").size(), 1U);
  // Over, and active again within 10 s, with a restart between.
  alerts_.clear();
  Run(300'000);
  EXPECT_EQ(link_->With(",B,W,N,LKO,10002,3,3,0,").size(), 1U);
  StartWith(true);
  Run(300'000);
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  EXPECT_EQ(link_->With(",B,W,V,LKO,10002,3,4,0,").size(), 1U);
  alerts_[0].state = alert_t::STATE_ACKNOWLEDGED;
  std::ofstream(folder_ / "alerts.txt") << "3 2 damaged";
  StartWith(true);
  Run(300'000);
  EXPECT_EQ(link_->With(",B,W,A,LKO,10002,3,1,0,").size(), 1U) << "a damaged file keeps nobody from being told";
}

// The tracker's first alert of the watch and the plotter's own were one on the wire: the end of one took off the other.
TEST_F(AlfOutput, TellsItsOwnWatchApartFromTheTrackers) {
  alerts_ = {MakeAlert(-1)};
  alerts_[0].cause = alert_t::CAUSE_WATCH;
  Run(300'000);
  EXPECT_EQ(link_->With(",B,W,V,LKO,10003,1,1,0,").size(), 1U);
  EXPECT_FALSE(link_->With("HBT,30,V,").empty());
  Wait(1'300'000);
  EXPECT_EQ(link_->With(",B,W,V,LKO,10003,999999,1,0,").size(), 1U);
  Run(8'000'000);
  EXPECT_FALSE(link_->With(",N,LKO,10003,999999,").empty());
  EXPECT_TRUE(link_->With(",N,LKO,10003,1,").empty());
}

// The only word that nobody looks: it can be acknowledged, and not silenced. Nor can a caution, which makes no lasting sound.
TEST_F(AlfOutput, SilencesWarningsOfThingsAlone) {
  alerts_ = {MakeAlert(-1), MakeAlert(5)};
  alerts_[0].cause = alert_t::CAUSE_WATCH;
  alerts_[1].level = alert_t::LEVEL_CAUTION;
  Run(300'000);
  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10003,1,S,C").size(), 1U);
  EXPECT_EQ(Answers("CAACN,102031.00,LKO,10002,5,S,C").size(), 1U);
  EXPECT_TRUE(ordered_.empty());
  EXPECT_TRUE(Answers("CAACN,102031.00,LKO,10003,1,A,C").empty());
  ASSERT_EQ(acknowledged_.size(), 1U);
  EXPECT_EQ(acknowledged_[0].alert_id, -1);
}

// Ids begin anew with each process of the tracker: the end of the old alert took off the new one of its number.
TEST_F(AlfOutput, TellsNoEndOfANumberThatIsInUse) {
  alerts_ = {MakeAlert(1)};
  Run(300'000);
  alerts_.clear();
  begin_us_ += 5'000'000;
  Run(1'000'000);
  EXPECT_EQ(link_->With(",N,LKO,10002,1,2,").size(), 1U);
  alerts_ = {MakeAlert(1)};
  alerts_[0].raised_utime_us += 5'000'000;
  link_->sent.clear();
  Run(8'000'000);
  EXPECT_EQ(link_->With(",B,W,V,LKO,10002,1,3,0,").size(), 1U);
  EXPECT_TRUE(link_->With(",N,LKO,").empty());
  ++link_->openings;
  Run(4'000'000);
  EXPECT_TRUE(link_->With(",N,LKO,").empty()) << "nor to a new receiver";
}

// At 4800 baud no list of many alerts fits at once.
TEST_F(AlfOutput, ListsManyAlertsOverASlowPort) {
  for (int id = 1; id <= 30; ++id) alerts_.push_back(MakeAlert(id));
  for (int i = 0; i < 320; ++i) {
    link_->room = 256;
    Run(100'000);
  }
  EXPECT_FALSE(link_->With("HBT").empty());
  EXPECT_GE(link_->With("ALC").size(), 8U) << "four alerts in each";
}

// A list of two sentences waited for room when one of one sentence came: the second of the old one went out behind it.
TEST_F(AlfOutput, SendsNothingOfAnOldListBehindAShorterOne) {
  for (int id = 1; id <= 6; ++id) alerts_.push_back(MakeAlert(id));
  Run(31'000'000);
  ASSERT_FALSE(link_->With("RAALC,02,02,").empty());
  link_->sent.clear();
  link_->room = 0;
  Run(31'000'000);
  alerts_.resize(1);
  Run(31'000'000);
  EXPECT_TRUE(link_->sent.empty());
  link_->room = 1'000'000;
  Run(1'000'000);
  EXPECT_EQ(link_->With("RAALC,01,01,").size(), 1U);
  EXPECT_TRUE(link_->With("RAALC,02,").empty());
}

TEST_F(AlfOutput, TellsAFurtherBoatAfterAThousandAlerts) {
  revisions_.clear();  // a file for each change would take seconds
  StartWith(true);
  for (std::int64_t id = 1; id <= 1200; ++id) {
    link_->room = 1'000'000;
    alerts_ = {MakeAlert(id)};
    Run(100'000);
    Answers("CAACN,102031.00,LKO,10002," + std::to_string(id) + (id % 2 == 0 ? ",A,C" : ",S,C"));
    if (id % 2 == 0) alerts_[0].state = alert_t::STATE_ACKNOWLEDGED;
    Run(100'000);
    alerts_.clear();
    Run(100'000);
  }
  EXPECT_EQ(acknowledged_.size(), 600U);
  EXPECT_FALSE(ordered_.empty());
  link_->sent.clear();
  alerts_ = {MakeAlert(1201)};
  alerts_[0].raised_utime_us = alerts_[0].changed_utime_us = host_us_;
  Run(100'000);
  EXPECT_EQ(link_->With(",B,W,V,LKO,10002,1201,1,0,").size(), 1U);
}

}  // namespace
}  // namespace lookout::plotter
