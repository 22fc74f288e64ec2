#include "services/page/film/strip.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "services/page/core/replies.hpp"

namespace lookout::page {

namespace {

constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::array<std::string_view, 6> kKinds{"alert", "health", "loss", "start", "end", "gap"};

std::string Text(const nlohmann::json& json) { return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace); }

nlohmann::json EventsOf(const Timeline& timeline, const StripRequest& request) {
  const auto& events = timeline.events();
  const auto begin = std::ranges::lower_bound(events, request.from, {}, &FilmEvent::time);
  const auto end = std::ranges::upper_bound(events, request.to, {}, &FilmEvent::time);
  std::vector<const FilmEvent*> chosen;
  for (auto event = begin; event < end; ++event) chosen.push_back(&*event);
  if (chosen.size() > kMaxStripEvents) {
    std::ranges::stable_sort(chosen, [](const auto* one, const auto* other) { return one->level > other->level; });
    chosen.resize(kMaxStripEvents);
    std::ranges::stable_sort(chosen, [](const auto* one, const auto* other) { return one->time < other->time; });
  }
  auto list = nlohmann::json::array();
  for (const auto* event : chosen) {
    list.push_back({{"utime_us", ToUtimeUs(event->time)},
                    {"kind", kKinds.at(static_cast<std::size_t>(event->kind))},
                    {"level", event->level},
                    {"text", event->text}});
  }
  return list;
}

}  // namespace

std::string StripText(const Timeline& timeline, const StripRequest& request) {
  const auto from_us = ToUtimeUs(request.from);
  const auto to_us = ToUtimeUs(request.to);
  if (to_us <= from_us || request.num_buckets <= 0) return RefusedText(request.id, "the span is empty");
  const auto num_buckets = static_cast<std::size_t>(std::min(request.num_buckets, kMaxBuckets));
  const auto bucket_us = (to_us - from_us - 1) / static_cast<std::int64_t>(num_buckets) + 1;
  const auto bucket_of = [&](std::int64_t utime_us) {
    return static_cast<std::size_t>(std::clamp<std::int64_t>((utime_us - from_us) / bucket_us, 0, static_cast<std::int64_t>(num_buckets) - 1));
  };
  std::vector<SecondCell> buckets(num_buckets);
  const auto& cells = timeline.cells();
  const auto first_second = from_us >= 0 ? from_us / kSecondUs : (from_us - kSecondUs + 1) / kSecondUs;
  for (auto cell = std::ranges::lower_bound(cells, first_second, {}, &SecondCell::second); cell != cells.end(); ++cell) {
    const auto begin_us = cell->second * kSecondUs;
    if (begin_us >= to_us) break;
    const auto last = bucket_of(begin_us + kSecondUs - 1);
    // A second belongs to the bucket in which it begins; where buckets are shorter, to all that it covers.
    const auto first = bucket_of(begin_us);
    auto shown = *cell;
    buckets[first].Add(shown);
    shown.num_lost = 0;
    if (bucket_us >= kSecondUs) continue;
    for (auto i = first + 1; i <= last; ++i) buckets[i].Add(shown);
  }
  nlohmann::json json{{"type", "strip"},
                      {"id", request.id},
                      {"source", request.source},
                      {"begin_utime_us", from_us},
                      {"bucket_us", bucket_us},
                      {"num_tracks", nlohmann::json::array()},
                      {"alert_level", nlohmann::json::array()},
                      {"num_lost", nlohmann::json::array()},
                      {"health", nlohmann::json::array()},
                      {"events", EventsOf(timeline, request)}};
  for (const auto& bucket : buckets) {
    json["num_tracks"].push_back(bucket.num_tracks);
    json["alert_level"].push_back(bucket.alert_level);
    json["num_lost"].push_back(bucket.num_lost);
    json["health"].push_back(bucket.health);
  }
  return Text(json);
}

}  // namespace lookout::page
