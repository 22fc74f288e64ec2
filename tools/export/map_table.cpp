#include "tools/export/map_table.hpp"

#include <numeric>

#include "common/bus/channels.hpp"
#include "common/messages/words.hpp"
#include "tools/export/csv.hpp"
#include "tools/export/map_merge.hpp"
#include "tools/export/map_reader.hpp"
#include "tools/export/own_map_text.hpp"

namespace lookout::exporter {

namespace {

constexpr std::string_view kHeader =
    "what,kind,latitude_deg,longitude_deg,deviation_m,length_m,width_m,length_bearing_deg,top_above_water_m,first_utime_us,seen_utime_us,"
    "gone_utime_us,days,scans,cells";

void AppendThing(const MapThing& thing, std::string& text) {
  const auto num_scans = std::accumulate(thing.days.begin(), thing.days.end(), std::int64_t{0},
                                         [](std::int64_t sum, const DayScans& day) { return sum + day.num_scans; });
  AppendCells(text, std::string_view("thing"), words::WordOf(words::kTrackKind, thing.kind), Fixed{thing.latitude_deg, 9},
              Fixed{thing.longitude_deg, 9}, Fixed{thing.deviation_m, 3}, Fixed{thing.length_m, 3}, Fixed{thing.width_m, 3},
              Direction{thing.length_bearing_rad}, Fixed{thing.top_above_water_m, 3}, ToUtimeUs(thing.first), ToUtimeUs(thing.seen));
  text += ',';
  if (thing.gone) AppendCell(ToUtimeUs(*thing.gone), text);
  text += ',';
  AppendRow(text, static_cast<std::int64_t>(thing.days.size()), num_scans, Empty{});
}

// The place is the middle of the tile.
void AppendLand(const MapLand& land, std::string& text) {
  constexpr std::int16_t kMiddleCell = kCellsOfTile / 2 + kTileCells / 2;
  const auto middle = earth_grid::MiddleOf({land.tile, kMiddleCell});
  AppendRow(text, std::string_view("land"), Empty{}, Fixed{middle.latitude_deg, 9}, Fixed{middle.longitude_deg, 9}, Empty{}, Empty{}, Empty{},
            Empty{}, Empty{}, Empty{}, ToUtimeUs(land.seen), Empty{}, static_cast<std::int64_t>(land.days.size()), Empty{},
            static_cast<std::int64_t>(land.cells.size()));
}

class MapSink final : public Sink {
 public:
  explicit MapSink(bool is_geojson) : is_geojson_(is_geojson) {}

  std::vector<bus::Channel> Channels() const override { return {bus::kTracks, bus::kLidarScan, bus::kPose, bus::kRunInfo}; }

  Taken Take(std::string_view channel, Bytes bytes, std::string&) override { return reader_.Take(channel, bytes); }

  void Finish(std::string& text) override {
    reader_.Finish();
    const auto map = merge_.Merged();
    if (is_geojson_) {
      text += MapText(map);
      return;
    }
    for (const auto& thing : map.things) AppendThing(thing, text);
    for (const auto& land : map.land) AppendLand(land, text);
  }

  std::vector<std::string> Remarks() const override {
    std::vector<std::string> remarks;
    const auto add = [&remarks](std::int64_t number, const std::string& what) {
      if (number > 0)
        remarks.push_back("a map holds no more: " + std::to_string(number) + " " + what + " that were not seen for longest are left out");
    };
    add(merge_.num_things_left_out(), "things");
    add(merge_.num_cells_left_out(), "cells of land");
    if (merge_.num_over_limit() > 0) remarks.emplace_back("more than 4000 things stood in one run of the tracker: the rest is left out");
    if (reader_.num_looks() == 0) {
      remarks.emplace_back("what is gone is not known: that takes LIDAR_SCAN, POSE, and the boat's config in RUN_INFO, beside TRACKS");
    }
    return remarks;
  }

 private:
  bool is_geojson_;
  MapMerge merge_;
  MapReader reader_{merge_};
};

}  // namespace

std::string_view MapHeader() { return kHeader; }

std::unique_ptr<Sink> MakeMapSink(bool is_geojson) { return std::make_unique<MapSink>(is_geojson); }

}  // namespace lookout::exporter
