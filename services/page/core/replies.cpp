#include "services/page/core/replies.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/bus/services.hpp"

namespace lookout::page {

namespace {

using nlohmann::json;

// A text that is no UTF-8 (the name of a computer, of a file) gets replacement characters.
std::string Text(const json& message) { return message.dump(-1, ' ', false, json::error_handler_t::replace); }

// An object with a member more, whose value is JSON already.
std::string With(std::string object, std::string_view name, std::string_view value) {
  object.pop_back();
  return object.append(",\"").append(name).append("\":").append(value).append("}");
}

// Names of the boat's processes as in HEALTH; a second lidar has a process of its own.
const std::vector<std::string_view>& ProcessNames() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all{"lidar_2"};
    all.reserve(bus::kServices.size() + 1);
    for (const auto& service : bus::kServices) all.push_back(service.name);
    return all;
  }();
  return names;
}

}  // namespace

std::string HelloText(const Hello& hello, std::string_view sources) {
  return With(Text({{"type", "hello"},
                    {"mode", hello.is_log ? "log" : "live"},
                    {"version", hello.version},
                    {"host", hello.host},
                    {"server_utime_us", ToUtimeUs(hello.server_time)},
                    {"channels", ChannelNames()},
                    {"processes", ProcessNames()},
                    {"may_acknowledge", hello.may_acknowledge}}),
              "sources", sources);
}

std::string SourcesMessage(std::string_view sources) { return With(Text({{"type", "sources"}}), "sources", sources); }

std::string IndexingText(int source, double share) {
  return Text({{"type", "indexing"}, {"source", source}, {"share", std::clamp(share, 0.0, 1.0)}});
}

std::string AnswerText(std::uint32_t id, int source, const Answer& answer, std::size_t num_frames) {
  return Text({{"type", "answer"},
               {"id", id},
               {"source", source},
               {"utime_us", ToUtimeUs(answer.time)},
               {"scan_utime_us", ToUtimeUs(answer.scan_time)},
               {"scan_index", answer.scan_index},
               {"num_scans", answer.num_scans},
               {"num_frames", num_frames}});
}

std::string RefusedText(std::uint32_t id, std::string_view reason) { return Text({{"type", "refused"}, {"id", id}, {"reason", reason}}); }

}  // namespace lookout::page
