#include "services/tracker/map_wire.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/core/elementary.hpp"

namespace lookout::tracker {

namespace {

using std::chrono::microseconds;

static_assert(static_cast<int>(MapThing::State::kUnseen) == map_thing_t::STATE_UNSEEN);
static_assert(static_cast<int>(MapThing::State::kSeen) == map_thing_t::STATE_SEEN);
static_assert(static_cast<int>(MapThing::State::kGone) == map_thing_t::STATE_GONE);

map_thing_t ToMessage(const MapThing& thing) {
  map_thing_t message{};
  message.id = thing.id;
  message.kind = static_cast<std::int32_t>(thing.kind);
  message.state = static_cast<std::int32_t>(thing.state);
  message.latitude_deg = thing.latitude_deg;
  message.longitude_deg = thing.longitude_deg;
  message.deviation_m = static_cast<float>(thing.deviation_m);
  message.length_m = static_cast<float>(thing.length_m);
  message.width_m = static_cast<float>(thing.width_m);
  message.length_bearing_rad = static_cast<float>(thing.length_bearing_rad);
  message.top_above_water_m = static_cast<float>(thing.top_above_water_m);
  message.first_utime_us = ToUtimeUs(thing.first);
  message.seen_utime_us = ToUtimeUs(thing.seen);
  message.gone_utime_us = thing.gone ? ToUtimeUs(*thing.gone) : 0;
  for (const auto& day : thing.days) {
    message.day.push_back(day.day);
    message.num_day_scans.push_back(day.num_scans);
  }
  message.num_days = messages::CountOf(message.day);
  // Of more corners than a map has, each second, third ...: of a convex outline a little less.
  constexpr std::size_t kMostCorners = 64;
  const auto step = (thing.outline_m.size() + kMostCorners - 1) / kMostCorners;
  for (std::size_t i = 0; i < thing.outline_m.size(); i += step) {
    const auto& corner_m = thing.outline_m[i];
    message.outline_east_m.push_back(static_cast<float>(corner_m.x()));
    message.outline_north_m.push_back(static_cast<float>(corner_m.y()));
  }
  message.num_outline = messages::CountOf(message.outline_east_m);
  return message;
}

MapThing ToThing(const map_thing_t& message) {
  MapThing thing;
  thing.id = message.id;
  thing.kind = static_cast<TrackKind>(message.kind);
  thing.state = static_cast<MapThing::State>(message.state);
  thing.latitude_deg = message.latitude_deg;
  thing.longitude_deg = message.longitude_deg;
  thing.deviation_m = message.deviation_m;
  thing.length_m = message.length_m;
  thing.width_m = message.width_m;
  thing.length_bearing_rad = message.length_bearing_rad;
  thing.top_above_water_m = message.top_above_water_m;
  thing.first = Utime(microseconds(message.first_utime_us));
  thing.seen = Utime(microseconds(message.seen_utime_us));
  if (message.gone_utime_us != 0) thing.gone = Utime(microseconds(message.gone_utime_us));
  for (std::size_t i = 0; i < message.day.size(); ++i) thing.days.push_back({message.day[i], message.num_day_scans[i]});
  for (std::size_t i = 0; i < message.outline_east_m.size(); ++i) {
    thing.outline_m.emplace_back(message.outline_east_m[i], message.outline_north_m[i]);
  }
  return thing;
}

map_land_t ToMessage(const MapLand& land) {
  map_land_t message{};
  message.tile_east = land.tile.east;
  message.tile_north = land.tile.north;
  message.seen_utime_us = ToUtimeUs(land.seen);
  message.day = land.days;
  message.num_days = messages::CountOf(message.day);
  message.cell = land.cells;
  message.num_cells = messages::CountOf(message.cell);
  return message;
}

// Fills parts one after the other.
class Parts {
 public:
  Parts(const map_t& head, int max_message_bytes)
      : head_(head), head_bytes_(head.getEncodedSize()), max_message_bytes_(max_message_bytes), num_bytes_(head_bytes_), parts_{head} {}

  template <typename Member>
  void Add(Member member, std::vector<Member> map_t::*members) {
    const int size = member._getEncodedSizeNoHash();
    if (head_bytes_ + size > max_message_bytes_) return;
    if (num_bytes_ + size > max_message_bytes_) {
      parts_.push_back(head_);
      num_bytes_ = head_bytes_;
    }
    num_bytes_ += size;
    (parts_.back().*members).push_back(std::move(member));
  }

  std::vector<map_t> Take(int least_parts) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      parts_[i].part_index = static_cast<std::int32_t>(i);
      parts_[i].num_parts = std::max(messages::CountOf(parts_), least_parts);
      parts_[i].num_things = messages::CountOf(parts_[i].things);
      parts_[i].num_land = messages::CountOf(parts_[i].land);
    }
    return std::move(parts_);
  }

 private:
  map_t head_;
  int head_bytes_;
  int max_message_bytes_;
  int num_bytes_;
  std::vector<map_t> parts_;
};

}  // namespace

std::vector<map_t> ToMessages(const MapLabel& label, const OwnMap& map, int max_message_bytes, int least_parts) {
  map_t head{};
  head.utime_us = ToUtimeUs(label.scan.key.time);
  head.seq = label.seq;
  head.raw_seq = label.scan.raw_seq;
  head.end_utime_us = ToUtimeUs(label.scan.end_time);
  head.scan_seq = label.scan.key.seq;
  head.begin_seq = label.scan.begin.seq;
  head.begin_utime_us = ToUtimeUs(label.scan.begin.time);
  head.source = label.source;
  head.datum_latitude_deg = Canonical(label.scan.datum.latitude_deg);
  head.datum_longitude_deg = Canonical(label.scan.datum.longitude_deg);
  head.datum_ellipsoid_height_m = Canonical(label.scan.datum.ellipsoid_height_m);
  head.water_up_m = label.scan.own_up_m;
  head.land_begin_utime_us = label.land_begin ? ToUtimeUs(*label.land_begin) : 0;
  Parts parts(head, max_message_bytes);
  for (const auto& thing : map.things) parts.Add(ToMessage(thing), &map_t::things);
  for (const auto& land : map.land) parts.Add(ToMessage(land), &map_t::land);
  return parts.Take(least_parts);
}

std::optional<OwnMap> ToOwnMap(const map_t& message) {
  if (!messages::IsWellFormed(message)) return std::nullopt;
  OwnMap map;
  for (const auto& thing : message.things) map.things.push_back(ToThing(thing));
  for (const auto& land : message.land) {
    const MapTile tile{land.tile_east, land.tile_north};
    if (message.source == map_t::SOURCE_GIVEN && !earth_grid::Has(tile)) return std::nullopt;
    map.land.push_back({tile, Utime(microseconds(land.seen_utime_us)), land.day, land.cell});
  }
  return map;
}

}  // namespace lookout::tracker
