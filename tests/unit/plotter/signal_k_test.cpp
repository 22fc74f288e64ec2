#include "services/plotter/core/signal_k.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using nlohmann::json;
using test::MakeNotice;
using test::MakeOwnShip;
using test::MakeTarget;

// Values of a delta by path.
json Values(const std::string& delta) {
  EXPECT_EQ(delta.find('\n'), delta.size() - 1);  // a line
  json values;
  const auto message = json::parse(delta);
  for (const auto& one : message["updates"][0]["values"]) values[one["path"].get<std::string>()] = one["value"];
  return values;
}

TEST(PlotterSignalK, SaysTheOwnShip) {
  const auto text = OwnShipDelta(MakeOwnShip());
  const auto delta = json::parse(text);
  EXPECT_EQ(delta["context"], "vessels.self");
  EXPECT_EQ(delta["updates"][0]["timestamp"], "2026-07-01T10:20:30.456Z");
  const auto values = Values(text);
  EXPECT_EQ(values["navigation.position"]["latitude"], 53.3);
  EXPECT_EQ(values["navigation.position"]["longitude"], -6.1);
  EXPECT_NEAR(values["navigation.headingTrue"].get<double>(), test::Deg(45), 1e-5);
  EXPECT_NEAR(values["navigation.courseOverGroundTrue"].get<double>(), test::Deg(90), 1e-5);
  EXPECT_EQ(values["navigation.speedOverGround"], 2.0);
}

TEST(PlotterSignalK, SaysNullOfWhatIsNotKnown) {
  const auto values = Values(OwnShipDelta({.time = test::kTime, .position = {}}));
  for (const auto& value : values) EXPECT_TRUE(value.is_null());
  EXPECT_EQ(values.size(), 4U);
}

TEST(PlotterSignalK, SaysATarget) {
  const auto target = MakeTarget();
  const auto text = TargetDelta(TargetContext("gannet", 3), target, test::kTime);
  EXPECT_EQ(json::parse(text)["context"], "targets.lidar:gannet-3");
  const auto values = Values(text);
  EXPECT_NEAR(values["navigation.position"]["latitude"].get<double>(), target.position.latitude_deg, 1e-9);
  EXPECT_NEAR(values["navigation.position"]["longitude"].get<double>(), target.position.longitude_deg, 1e-9);
  EXPECT_EQ(values["navigation.speedOverGround"], 1.0);
  EXPECT_EQ(values["navigation.closestApproach"]["distance"], 12.5);
  EXPECT_EQ(values["navigation.closestApproach"]["timeTo"], 33.0);
  EXPECT_EQ(values["design.length"]["overall"], 6.0);
  EXPECT_EQ(values["design.beam"], 2.0);
  EXPECT_EQ(values[""]["name"], "boat 17");
  EXPECT_LT(text.size(), 2048U);  // signalk-server throws longer lines away
}

TEST(PlotterSignalK, CallsATargetAsPeopleDo) {
  auto target = MakeTarget();
  target.given_name = "Kj\xc3\xb8kken";
  EXPECT_EQ(Values(TargetDelta(TargetContext("gannet", 3), target, test::kTime))[""]["name"], "Kj\xc3\xb8kken");
}

TEST(PlotterSignalK, EndsATargetByNulls) {
  const auto text = TargetEndDelta(TargetContext("gannet", 3), test::kTime);
  EXPECT_EQ(json::parse(text)["context"], "targets.lidar:gannet-3");
  for (const auto& value : Values(text)) EXPECT_TRUE(value.is_null());
  EXPECT_TRUE(Values(text).contains("navigation.position"));
}

TEST(PlotterSignalK, SaysByItsNameThatATargetIsLost) {
  const auto values = Values(TargetEndDelta(VesselContext("gannet", 3), test::kTime, "lost: boat 17"));
  EXPECT_EQ(values[""]["name"], "lost: boat 17");
  EXPECT_TRUE(values["navigation.position"].is_null());
}

// The form that the specification's schema wants of a vessel without an MMSI.
TEST(PlotterSignalK, GivesAVesselAUuidOfItsPlace) {
  const std::regex form("vessels\\.urn:mrn:signalk:uuid:[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}");
  std::set<std::string> contexts;
  for (int place = 1; place <= 500; ++place) {
    contexts.insert(VesselContext("gannet", place));
    EXPECT_TRUE(std::regex_match(VesselContext("gannet", place), form)) << VesselContext("gannet", place);
  }
  EXPECT_EQ(contexts.size(), 500U);
  EXPECT_NE(VesselContext("gannet", 1), VesselContext("tern", 1));
  EXPECT_EQ(VesselContext("gannet", 1), VesselContext("gannet", 1));
}

TEST(PlotterSignalK, MakesAWordOfAnyName) {
  EXPECT_EQ(BoatWord("Sea.Gull, \"2\""), "Sea_Gull___2_");
  EXPECT_EQ(BoatWord(""), "boat");
  EXPECT_EQ(BoatWord("\xC3\x84nn"), "__nn");
}

TEST(PlotterSignalK, SaysAnAlert) {
  auto notice = MakeNotice();
  notice.text = "boat 17: \x01\"near\"";
  const auto state = [&] {
    const auto text = NoticeDelta(notice, "word", test::kTime);
    EXPECT_EQ(json::parse(text)["context"], "vessels.self");
    const auto value = Values(text)["notifications.lookout.word"];
    EXPECT_EQ(value["message"], "boat 17: ?\"near\"");
    return value["state"].get<std::string>() + value["method"].dump();
  };
  EXPECT_EQ(state(), R"(alarm["visual"])") << "another one sounds";
  EXPECT_FALSE(Values(NoticeDelta(notice, "word", test::kTime))["notifications.lookout.word"].contains("acknowledgeStatus"));
  EXPECT_EQ(Values(NoticeDelta(notice, "word", test::kTime))["notifications.lookout.word"]["createdAt"], "2026-07-01T10:20:30.456Z");
  notice.sound = Sound::kSounds;
  EXPECT_EQ(state(), R"(alarm["visual","sound"])");
  notice.level = Level::kCaution;
  EXPECT_EQ(state(), R"(warn["visual","sound"])");
  notice.state = NoticeState::kAcknowledged;
  EXPECT_EQ(state(), R"(warn["visual"])");
  EXPECT_EQ(Values(NoticeDelta(notice, "word", test::kTime))["notifications.lookout.word"]["acknowledgeStatus"], "Yes");
  notice.state = NoticeState::kRectified;
  EXPECT_EQ(state(), R"(alert["visual"])");
  notice.state = NoticeState::kCleared;
  EXPECT_EQ(state(), "normal[]");
}

// As signalk-server 2.23 sends it.
std::string Delta(const std::string& value, const std::string& path = "notifications.lookout.word") {
  return R"({"context":"vessels.urn:mrn:signalk:uuid:1","updates":[{"$source":"ws","values":[{"path":")" + path + R"(","value":)" + value + "}]}]}";
}

TEST(PlotterSignalK, ReadsWhatIsAcknowledged) {
  const auto echo = [](const std::string& value) { return ReadDelta(Delta(value)).echoes.at(0); };
  const auto acknowledged = echo(R"({"state":"alarm","method":[],"status":{"silenced":true,"acknowledged":true,"canSilence":true}})");
  EXPECT_EQ(acknowledged.word, "word");
  EXPECT_TRUE(acknowledged.is_acknowledged);
  const auto sent = echo(R"({"state":"alarm","method":["visual","sound"],"status":{"silenced":false,"acknowledged":false}})");
  EXPECT_FALSE(sent.is_acknowledged || sent.is_quiet);
  const auto silenced = echo(R"({"state":"alarm","method":["visual"],"status":{"silenced":true,"acknowledged":false}})");
  EXPECT_FALSE(silenced.is_acknowledged || silenced.is_quiet);
  EXPECT_TRUE(echo(R"({"state":"alarm","method":["visual"]})").is_quiet);
  EXPECT_TRUE(echo(R"({"state":"normal","method":["visual","sound"]})").is_quiet);
  EXPECT_FALSE(echo(R"({"state":"alert","method":["visual"]})").is_quiet);
}

TEST(PlotterSignalK, ReadsNothingFromWhatIsNone) {
  for (const auto* text :
       {R"({"name":"signalk-server","version":"2.23.0","self":"vessels.urn:1"})", R"({"updates":[]})", R"({"updates":[1,{"values":2}]})"}) {
    const auto read = ReadDelta(text);
    EXPECT_FALSE(read.is_wrong) << text;
    EXPECT_TRUE(read.echoes.empty());
  }
  EXPECT_TRUE(ReadDelta(Delta("null")).echoes.empty());
  EXPECT_TRUE(ReadDelta(Delta(R"({"state":7,"method":8})", "notifications.other.word")).echoes.empty());
  EXPECT_FALSE(ReadDelta(Delta(R"({"state":7,"method":8,"status":9})")).echoes.at(0).is_quiet);
  for (const auto* text : {"", "{", "[1]", "\xFF\xFE", R"({"updates":{}})"}) EXPECT_TRUE(ReadDelta(text).is_wrong) << text;
}

TEST(PlotterSignalK, DiesOfNoNesting) { EXPECT_TRUE(ReadDelta(std::string(60'000, '[')).is_wrong); }

}  // namespace
}  // namespace lookout::plotter
