#include "services/page/film/source_text.hpp"

#include <nlohmann/json.hpp>

#include "common/bus/channels.hpp"

namespace lookout::page {

std::string SourcesTextOf(const std::vector<std::pair<SourceFacts, const Timeline*>>& sources) {
  auto list = nlohmann::json::array();
  for (const auto& [facts, timeline] : sources) {
    const bool has_times = timeline != nullptr && !timeline->is_empty();
    list.push_back({{"id", facts.id},
                    {"name", facts.name},
                    {"begin_utime_us", has_times ? ToUtimeUs(timeline->begin()) : 0},
                    {"end_utime_us", has_times ? ToUtimeUs(timeline->end()) : 0},
                    {"opens_utime_us", has_times ? ToUtimeUs(timeline->OpensAt()) : 0},
                    {"has_pose", has_times && timeline->Holds(bus::kPose)},
                    {"has_tracks", has_times && timeline->Holds(bus::kTracks)},
                    {"num_scans", timeline == nullptr ? 0 : timeline->scans().size()},
                    {"is_growing", facts.is_growing},
                    {"is_indexed", facts.is_indexed},
                    {"boat", nlohmann::json::parse(facts.boat_text, nullptr, false)}});
    if (list.back()["boat"].is_discarded()) list.back()["boat"] = nullptr;
  }
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace lookout::page
