#include "tools/export/own_map_text.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace lookout::exporter::own_map_text {
namespace {

using nlohmann::json;

MapThing MakeThing() {
  MapThing thing;
  thing.kind = track_t::KIND_BUOY;
  thing.latitude_deg = 43.63012345678;
  thing.longitude_deg = -72.15;
  thing.deviation_m = 0.25;
  thing.length_m = 1.25;
  thing.width_m = 0.5;
  thing.length_bearing_rad = 1.0;
  thing.top_above_water_m = -0.0001;
  thing.first = Utime(std::chrono::seconds(1'700'000'000));
  thing.seen = Utime(std::chrono::milliseconds(1'700'200'000'999));
  thing.days = {{19'675, 7}, {19'676, 8}, {19'677, 9}};
  thing.outline_m = {{-0.6, -0.2}, {0.6, -0.2}, {0.0, 0.25}};
  return thing;
}

json FeaturesOf(const OwnMap& map) { return json::parse(MapText(map)).at("features"); }

TEST(OwnMapText, IsGeoJsonOfThings) {
  const auto map = json::parse(MapText({.things = {MakeThing()}, .land = {}}));
  EXPECT_EQ(map.at("type"), "FeatureCollection");
  EXPECT_EQ(map.at("lookout_map"), 1);
  const auto& properties = map.at("features").at(0).at("properties");
  EXPECT_EQ(properties, json::parse(R"({"type":"thing","kind":"buoy","latitude_deg":43.630123457,"longitude_deg":-72.15,"deviation_m":0.25,)"
                                    R"("length_m":1.25,"width_m":0.5,"length_bearing_deg":57.3,"top_above_water_m":0,)"
                                    R"("first_seen":"2023-11-14T22:13:20Z","last_seen":"2023-11-17T05:46:40Z","gone":false,"gone_since":null,)"
                                    R"("days":3,"known":true,"scans":24,"scans_by_day":{"2023-11-14":7,"2023-11-15":8,"2023-11-16":9}})"));
  const auto& geometry = map.at("features").at(0).at("geometry");
  EXPECT_EQ(geometry.at("type"), "Polygon");
  const auto& ring = geometry.at("coordinates").at(0);
  ASSERT_EQ(ring.size(), 4U);
  EXPECT_EQ(ring.front(), ring.back());
  EXPECT_NEAR(ring.at(2).at(1).get<double>(), 43.63012345678 + 0.25 / 111'100.0, 1e-8);
}

TEST(OwnMapText, OfFewCornersIsALineOrAPoint) {
  OwnMap map{.things = {MakeThing(), MakeThing()}, .land = {}};
  map.things[0].outline_m = {{-0.5, 0.0}, {0.5, 0.0}};
  map.things[1].outline_m = {{0.0, 0.0}};
  map.things[1].gone = Utime(std::chrono::seconds(1'700'300'000));
  map.things[1].days.resize(2);
  const auto features = FeaturesOf(map);
  EXPECT_EQ(features.at(0).at("geometry").at("type"), "LineString");
  EXPECT_EQ(features.at(1).at("geometry").at("type"), "Point");
  EXPECT_EQ(features.at(1).at("properties").at("gone"), true);
  EXPECT_EQ(features.at(1).at("properties").at("gone_since"), "2023-11-18T09:33:20Z");
  EXPECT_EQ(features.at(1).at("properties").at("known"), false) << "two days are not enough";
}

TEST(OwnMapText, HasTheMiddlesOfCellsOfLand) {
  const auto cell = earth_grid::CellAt(43.6302, -72.1503);
  const auto features =
      FeaturesOf({.things = {}, .land = {{cell.tile, Utime(std::chrono::seconds(1'700'200'000)), {19'675, 19'677}, {0, cell.index}}}});
  EXPECT_EQ(features.at(0).at("geometry").at("type"), "MultiPoint");
  const auto& place = features.at(0).at("geometry").at("coordinates").at(1);
  EXPECT_EQ(earth_grid::CellAt(place.at(1).get<double>(), place.at(0).get<double>()), cell);
  EXPECT_EQ(features.at(0).at("properties"),
            json::parse(R"({"type":"land","cells":2,"last_seen":"2023-11-17T05:46:40Z","days":2,"seen_on":["2023-11-14","2023-11-16"]})"));
}

TEST(OwnMapText, MayBeEmpty) { EXPECT_TRUE(FeaturesOf({}).empty()); }

}  // namespace
}  // namespace lookout::exporter::own_map_text
