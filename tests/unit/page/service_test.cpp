#include "services/page/service.hpp"

#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "lookout/alert_ack_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/order_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/page/assets.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/support/page_browser.hpp"

namespace lookout::page {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kStartUs = 1'782'901'200'000'000;

class PageService : public support::BusTest {
 protected:
  PageService() {
    ServerParts parts;
    parts.assets = Assets();
    parts.acknowledge = [this](const Acknowledgement& acknowledgement) { queue_.Push(acknowledgement); };
    parts.order = [this](const Order& order) { orders_.Push(order); };
    server_ = std::make_unique<Server>(ServerOptions{.token = kToken}, std::move(parts));
    ServiceParts service_parts{.server = *server_, .acknowledgements = queue_, .orders = orders_, .now = [this] { return now_; }};
    service_parts.keep = [this](Utime, std::string_view channel, Bytes message) {
      kept_.emplace_back(channel);
      num_kept_bytes_ += message.size();
    };
    service_ = std::make_unique<Service>(bus_, std::move(service_parts));
  }

  void SendAlert(std::int32_t state) {
    alerts_t message{};
    message.utime_us = ToUtimeUs(now_);
    alert_t alert{};
    alert.id = 7;
    alert.raised_utime_us = kStartUs;
    alert.cause = alert_t::CAUSE_GUARD_ZONE;
    alert.level = alert_t::LEVEL_WARNING;
    alert.state = state;
    message.num_alerts = 1;
    message.alerts = {alert};
    Send(bus::kAlerts, message);
  }
  void Acknowledge(std::int64_t id, std::int64_t raised_us = kStartUs) {
    queue_.Push({id, Utime(std::chrono::microseconds(raised_us))});
    service_->AdvanceTo(now_);
    HandleAll();
  }
  void Tell(const Order& order) {
    orders_.Push(order);
    service_->AdvanceTo(now_);
    HandleAll();
  }
  std::int64_t Count(std::string_view name) const { return support::CountOf(*service_, name); }

  static constexpr const char* kToken = "0123456789abcdef";
  Utime now_{std::chrono::microseconds(kStartUs)};
  AcknowledgementQueue queue_;
  OrderQueue orders_;
  support::Kept<order_t> ordered_{bus_, bus::kOrders};
  std::unique_ptr<Server> server_;
  std::unique_ptr<Service> service_;
  std::vector<std::string> kept_;
  std::size_t num_kept_bytes_ = 0;
  support::Kept<alert_ack_t> sent_{bus_, bus::kAlertAck};
};

TEST_F(PageService, AcknowledgesAnAlertThatStands) {
  SendAlert(alert_t::STATE_ACTIVE);
  Acknowledge(7);
  ASSERT_EQ(sent_.size(), 1U);
  EXPECT_EQ(sent_[0].source, "page");
  EXPECT_EQ(sent_[0].seq, 0);
  EXPECT_EQ(sent_[0].alert_id, 7);
  EXPECT_EQ(sent_[0].alert_raised_utime_us, kStartUs);
  EXPECT_EQ(sent_[0].utime_us, kStartUs);
  EXPECT_EQ(Count("acks_sent"), 1);
}

TEST_F(PageService, AcknowledgesOnceUntilTheAnswerIsDue) {
  SendAlert(alert_t::STATE_RECTIFIED);
  Acknowledge(7);
  Acknowledge(7);
  EXPECT_EQ(sent_.size(), 1U);
  EXPECT_EQ(Count("acks_repeated"), 1);
  now_ += 1s;
  SendAlert(alert_t::STATE_RECTIFIED);
  Acknowledge(7);
  ASSERT_EQ(sent_.size(), 2U);
  EXPECT_EQ(sent_[1].seq, 1);
}

TEST_F(PageService, AcknowledgesNothingElse) {
  Acknowledge(7);  // no ALERTS yet
  SendAlert(alert_t::STATE_ACKNOWLEDGED);
  Acknowledge(7);
  SendAlert(alert_t::STATE_ACTIVE);
  Acknowledge(8);
  Acknowledge(7, kStartUs + 1);  // of another run
  now_ += 1s;                    // nobody looks any more
  Acknowledge(7);
  EXPECT_TRUE(sent_.empty());
  EXPECT_EQ(Count("acks_of_no_alert"), 5);
}

TEST_F(PageService, DropsAcknowledgementsOfWhoSendsThemByTheHundred) {
  for (int i = 0; i < 150; ++i) queue_.Push({1, now_});
  EXPECT_EQ(queue_.TakeAll().size(), AcknowledgementQueue::kMost);
  EXPECT_EQ(Count("acks_dropped"), 50);
}

TEST_F(PageService, TellsTheLookOutToBeSilentOnceASecond) {
  Tell({});  // no ALERTS yet
  EXPECT_EQ(Count("orders_unheard"), 1);
  SendAlert(alert_t::STATE_ACTIVE);
  Tell({});
  Tell({});
  ASSERT_EQ(ordered_.size(), 1U);
  EXPECT_EQ(ordered_[0].kind, order_t::KIND_SILENCE);
  EXPECT_EQ(ordered_[0].source, "page");
  EXPECT_EQ(ordered_[0].utime_us, kStartUs);
  EXPECT_EQ(Count("orders_repeated"), 1);
  now_ += 1s;
  SendAlert(alert_t::STATE_ACTIVE);
  Tell({});
  ASSERT_EQ(ordered_.size(), 2U);
  EXPECT_EQ(ordered_[1].seq, 1);
  EXPECT_EQ(sent_.size(), 0U) << "silence acknowledges nothing";
}

TEST_F(PageService, SetsLimitsAndLeavesToTheConfigWhatIsNotGiven) {
  SendAlert(alert_t::STATE_ACTIVE);
  Tell({.kind = Order::Kind::kSettings, .mode = Order::Mode::kHarbour, .guard_zone_from_deg = 270.0, .cpa_limit_m = 3.0});
  ASSERT_EQ(ordered_.size(), 1U);
  EXPECT_EQ(ordered_[0].kind, order_t::KIND_SETTINGS);
  EXPECT_EQ(ordered_[0].mode, order_t::MODE_HARBOUR);
  EXPECT_TRUE(std::isnan(ordered_[0].guard_zone_range_m));
  EXPECT_NEAR(ordered_[0].guard_zone_from_rad, 4.712389, 1e-5);
  EXPECT_EQ(ordered_[0].cpa_limit_m, 3.0F);
  Order naming;
  naming.kind = Order::Kind::kName;
  naming.track_id = 7;
  naming.name = "Kiosk pier";
  Tell(naming);
  ASSERT_EQ(ordered_.size(), 2U);
  EXPECT_EQ(ordered_[1].kind, order_t::KIND_NAME);
  EXPECT_EQ(ordered_[1].track_id, 7);
  EXPECT_EQ(ordered_[1].name, "Kiosk pier");
}

TEST_F(PageService, SendsTheVeryBytesToWhoWatches) {
  support::PageTab tab(server_->port());
  EXPECT_NE(tab.Read().bytes.find("\"hello\""), std::string::npos);
  tab.Say(R"({"op":"watch","channels":["TRACKS"]})");
  ChannelIndex index = 0;
  while (ChannelNames()[index] != "TRACKS") ++index;
  for (int i = 0; i < 500 && !server_->IsWatched(index); ++i) std::this_thread::sleep_for(10ms);
  ASSERT_TRUE(server_->IsWatched(index));
  tracks_t message{};
  message.utime_us = kStartUs;
  message.num_parts = 1;
  health_t health{};
  health.process = "tracker";
  bus::Publish(bus_, bus::kHealth, health);
  Send(bus::kTracks, message);
  const auto frame = tab.Read();
  const auto bytes = bus::Encode(message);
  ASSERT_FALSE(frame.is_text);
  EXPECT_EQ(frame.bytes.substr(kFrameHeadBytes), std::string(bytes.begin(), bytes.end()));
  EXPECT_EQ(frame.bytes[2], static_cast<char>(index));
}

TEST_F(PageService, KeepsEachMessageForTheLastMinutesButNoneThatDoesNotDecode) {
  tracks_t message{};
  message.num_parts = 1;
  bus::Publish(bus_, bus::kTracks, message);
  bus_.Publish(bus::kTracks, {1, 2, 3});
  HandleAll();
  EXPECT_EQ(kept_, std::vector<std::string>{"TRACKS"});
  EXPECT_EQ(num_kept_bytes_, bus::Encode(message).size());
  EXPECT_EQ(bus_.input_traffic()[std::string("TRACKS")].num_undecodable, 1);
}

TEST(PageAssets, HoldThePage) {
  std::vector<std::string> paths;
  for (const auto& asset : Assets()) {
    paths.emplace_back(asset.path);
    ASSERT_GE(asset.gzip_bytes.size(), 20U) << asset.path;
    EXPECT_EQ(asset.gzip_bytes[0], 0x1F);
    EXPECT_EQ(asset.gzip_bytes[1], 0x8B);
    for (std::size_t i = 4; i < 8; ++i) EXPECT_EQ(asset.gzip_bytes[i], 0) << "the time of compression";
  }
  for (const auto* path : {"/", "/page.js", "/page.css", "/icon.svg"}) EXPECT_NE(std::ranges::find(paths, path), paths.end()) << path;
}

// HEALTH was ok while nothing came.
TEST_F(PageService, SaysWhichInputsAreSilent) {
  service_->AdvanceTo(now_);
  EXPECT_EQ(service_->Report().state, HealthState::kOk);
  service_->AdvanceTo(now_ + 1s);
  SendAlert(alert_t::STATE_ACTIVE);
  service_->AdvanceTo(now_ + 2s);
  EXPECT_EQ(service_->Report().state, HealthState::kDegraded);
  EXPECT_EQ(service_->Report().reason, "no LIDAR_SCAN, SEGMENTS, POSE, OBSTACLES, TRACKS for 2 s");
}

}  // namespace
}  // namespace lookout::page
