#include "services/plotter/core/signal_k.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/core/hash.hpp"
#include "common/core/printable.hpp"

namespace lookout::plotter {

namespace {

using Json = nlohmann::ordered_json;  // members in the order in which they are written here
using ReadJson = nlohmann::json;      // in which a member is found at once, however many there are

// A delta of one notification has some 500 bytes.
constexpr std::size_t kMostTextBytes = 16'384;
constexpr std::string_view kNotifications = "notifications.lookout.";

std::string TimeText(Utime time) {
  using std::chrono::milliseconds;
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(std::chrono::floor<milliseconds>(time - day));
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()), clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     clock.subseconds().count());
}

// null where it is not known. Rounded to a digit below the sensors' resolution, so that texts stay short.
Json Number(double value, double per_unit) {
  if (!std::isfinite(value)) return nullptr;
  return std::nearbyint(value * per_unit) / per_unit;
}

Json Angle(double angle_rad) { return Number(angle_rad, 1e5); }
Json Length(double length_m) { return Number(length_m, 1e2); }

Json PositionJson(const Position& position) {
  if (!std::isfinite(position.latitude_deg) || !std::isfinite(position.longitude_deg)) return nullptr;
  return {{"latitude", Number(position.latitude_deg, 1e9)}, {"longitude", Number(position.longitude_deg, 1e9)}};  // 0.1 mm
}

class Delta {
 public:
  Delta(std::string context, Utime time) : context_(std::move(context)), time_(time) {}

  void Add(std::string_view path, Json value) { values_.push_back({{"path", path}, {"value", std::move(value)}}); }

  std::string Text() const {
    const Json update{{"source", {{"label", "lookout"}, {"type", "lidar"}}}, {"timestamp", TimeText(time_)}, {"values", values_}};
    const Json delta{{"context", context_}, {"updates", Json::array({update})}};
    return delta.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }

 private:
  std::string context_;
  Utime time_;
  Json values_ = Json::array();
};

std::string_view StateOf(const Notice& notice) {
  switch (notice.state) {
    case NoticeState::kCleared:
      return "normal";
    case NoticeState::kRectified:
      return "alert";
    default:
      return notice.level == Level::kWarning ? "alarm" : "warn";
  }
}

Json MethodsOf(const Notice& notice) {
  switch (notice.state) {
    case NoticeState::kActive:
      return notice.sound == Sound::kSounds ? Json::array({"visual", "sound"}) : Json::array({"visual"});
    case NoticeState::kCleared:
      return Json::array();
    default:
      return Json::array({"visual"});
  }
}

std::string_view CauseWord(Cause cause) {
  switch (cause) {
    case Cause::kGuardZone:
      return "guardZone";
    case Cause::kClosestApproach:
      return "closestApproach";
    case Cause::kPosition:
      return "noPosition";
    case Cause::kPartUnseen:
      return "lookoutGap";
    default:
      return "noLookout";
  }
}

bool IsTrue(const ReadJson& object, const char* name) {
  const auto member = object.find(name);
  return member != object.end() && member->is_boolean() && member->get<bool>();
}

bool HasSound(const ReadJson& value) {
  const auto method = value.find("method");
  return method != value.end() && method->is_array() && std::ranges::find(*method, ReadJson("sound")) != method->end();
}

// nullopt: it is no notification of ours.
std::optional<NoticeEcho> ToEcho(const ReadJson& one) {
  if (!one.is_object()) return std::nullopt;
  const auto path = one.find("path");
  const auto value = one.find("value");
  if (path == one.end() || value == one.end() || !path->is_string() || !value->is_object()) return std::nullopt;
  const auto& text = path->get_ref<const std::string&>();
  const auto state = value->find("state");
  if (!text.starts_with(kNotifications) || state == value->end()) return std::nullopt;
  NoticeEcho echo{.word = text.substr(kNotifications.size())};
  const auto status = value->find("status");
  const bool has_status = status != value->end() && status->is_object();
  echo.is_acknowledged = has_status && IsTrue(*status, "acknowledged");
  const bool is_silenced = has_status && IsTrue(*status, "silenced");
  echo.is_raised = *state != "normal" && *state != "nominal";
  const bool is_loud = *state == "alarm" || *state == "warn";
  echo.is_quiet = !is_silenced && (*state == "normal" || (is_loud && !HasSound(*value)));
  return echo;
}

}  // namespace

std::string BoatWord(std::string_view boat) {
  const auto is_good = [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
  };
  constexpr std::size_t kMostBytes = 64;
  std::string word(boat.substr(0, kMostBytes));
  std::ranges::replace_if(
      word, [&](char letter) { return !is_good(letter); }, '_');
  return word.empty() ? "boat" : word;
}

std::string OwnShipDelta(const OwnShip& own) {
  Delta delta("vessels.self", own.time);
  delta.Add("navigation.position", PositionJson(own.position));
  delta.Add("navigation.headingTrue", Angle(own.heading_rad));
  delta.Add("navigation.courseOverGroundTrue", Angle(own.course_rad));
  delta.Add("navigation.speedOverGround", Number(own.speed_mps, 1e3));
  return delta.Text();
}

std::string TargetContext(std::string_view boat, int place) { return fmt::format("targets.lidar:{}-{}", boat, place); }

std::string VesselContext(std::string_view boat, int place) {
  // As the server wants them: version 4, variant 2.
  const auto first = Fnv1a(fmt::format("{}-{}", boat, place));
  const auto second = Fnv1a(fmt::format("{}-{} lidar", boat, place));
  return fmt::format("vessels.urn:mrn:signalk:uuid:{:08x}-{:04x}-4{:03x}-{:x}{:03x}-{:012x}", first >> 32U, first >> 16U & 0xFFFFU, first & 0xFFFU,
                     8U | (second >> 60U & 3U), second >> 48U & 0xFFFU, second & 0xFFFF'FFFF'FFFFU);
}

std::string TargetName(const Target& target) { return target.given_name.empty() ? target.name : PrintableLines(target.given_name); }

std::string TargetDelta(std::string_view context, const Target& target, Utime time) {
  Delta delta(std::string(context), time);
  delta.Add("", {{"name", TargetName(target)}});
  delta.Add("navigation.position", PositionJson(target.position));
  delta.Add("navigation.courseOverGroundTrue", Angle(target.course_rad));
  delta.Add("navigation.speedOverGround", Number(target.speed_mps, 1e3));
  delta.Add("navigation.closestApproach", {{"distance", Length(target.cpa_m)}, {"timeTo", Length(target.tcpa_s)}});
  delta.Add("design.length", {{"overall", Length(target.length_m)}});
  delta.Add("design.beam", Length(target.width_m));
  return delta.Text();
}

std::string TargetEndDelta(std::string_view context, Utime time, std::string_view new_name) {
  Delta delta(std::string(context), time);
  if (!new_name.empty()) delta.Add("", {{"name", new_name}});
  for (const char* path : {"navigation.position", "navigation.courseOverGroundTrue", "navigation.speedOverGround", "navigation.closestApproach"})
    delta.Add(path, nullptr);
  return delta.Text();
}

std::string NoticeWord(const Notice& notice) {
  const auto word = fmt::format("{}{}at{}", CauseWord(notice.cause), std::abs(notice.id), ToUtimeUs(notice.changed));
  return notice.escalation > 0 ? word + fmt::format("escalated{}", notice.escalation) : word;
}

std::string NoticeDelta(const Notice& notice, std::string_view word, Utime time) {
  Delta delta("vessels.self", time);
  Json value{
      {"state", StateOf(notice)}, {"method", MethodsOf(notice)}, {"message", PrintableLines(notice.text)}, {"createdAt", TimeText(notice.raised)}};
  if (notice.state == NoticeState::kAcknowledged) value["acknowledgeStatus"] = "Yes";
  delta.Add(fmt::format("{}{}", kNotifications, word), std::move(value));
  return delta.Text();
}

std::string NoticeSubscription() {
  const Json subscription{{"context", "vessels.self"},
                          {"subscribe", Json::array({{{"path", std::string(kNotifications) + "*"}, {"policy", "instant"}}})}};
  return subscription.dump() + "\n";
}

ReadEchoes ReadDelta(std::string_view text) {
  ReadEchoes read;
  const auto message = text.size() <= kMostTextBytes ? ReadJson::parse(text, nullptr, false) : ReadJson();
  read.is_wrong = !message.is_object();
  if (read.is_wrong) return read;
  const auto updates = message.find("updates");
  if (updates == message.end()) return read;
  read.is_wrong = !updates->is_array();
  if (read.is_wrong) return read;
  for (const auto& update : *updates) {
    if (!update.is_object()) continue;
    const auto values = update.find("values");
    if (values == update.end() || !values->is_array()) continue;
    for (const auto& one : *values) {
      if (auto echo = ToEcho(one)) read.echoes.push_back(*std::move(echo));
    }
  }
  return read;
}

}  // namespace lookout::plotter
