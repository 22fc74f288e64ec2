#include "services/page/core/request.hpp"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/core/printable.hpp"

namespace lookout::page {

namespace {

using nlohmann::json;

constexpr double kMaxLimitM = 10'000.0;  // coarse bound: the tracker checks with bounds of its own
constexpr std::int64_t kMaxScansOn = 1'000'000;
static_assert(bus::kChannels.size() <= kMaxChannels);

std::optional<ChannelIndex> FindIndex(std::string_view name) {
  const auto& names = ChannelNames();
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<ChannelIndex>(found - names.begin());
}

// One object of numbers, texts and arrays of texts, each member once: all that a request may be.
json ParseFlat(std::string_view text) {
  if (text.size() > kMaxRequestBytes) return json::value_t::discarded;
  bool is_flat = true;
  std::set<std::string> names;
  const auto look = [&](int depth, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start && depth > 0) is_flat = false;
    if (event == json::parse_event_t::array_start && depth > 1) is_flat = false;
    if (event == json::parse_event_t::key && !names.insert(parsed.get<std::string>()).second) is_flat = false;
    return is_flat;
  };
  auto members = json::parse(text.begin(), text.end(), look, false);
  if (!is_flat || !members.is_object()) return json::value_t::discarded;
  return members;
}

// Takes members out of the object, and keeps the first thing that is wrong.
class Reader {
 public:
  explicit Reader(json members) : members_(std::move(members)) {}

  std::int64_t Whole(const char* name, std::int64_t least, std::int64_t greatest) {
    const auto found = members_.find(name);
    if (found == members_.end()) return Fail(std::string(name) + " is missing"), least;
    const auto value = *found;
    members_.erase(found);
    const bool is_whole = value.is_number_unsigned() ? value.get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<std::int64_t>::max()}
                                                     : value.is_number_integer();
    if (!is_whole || value.get<std::int64_t>() < least || value.get<std::int64_t>() > greatest)
      return Fail(std::string(name) + " is not a whole number from " + std::to_string(least) + " to " + std::to_string(greatest)), least;
    return value.get<std::int64_t>();
  }

  // nullopt: it is not there.
  std::optional<double> Number(const char* name, double least, double greatest) {
    const auto found = members_.find(name);
    if (found == members_.end()) return std::nullopt;
    const auto value = *found;
    members_.erase(found);
    if (!value.is_number() || !(value.get<double>() >= least && value.get<double>() <= greatest))
      return Fail(std::string(name) + " is out of range"), std::nullopt;
    return value.get<double>();
  }

  int Small(const char* name, int least, int greatest) { return static_cast<int>(Whole(name, least, greatest)); }

  Utime Time(const char* name) { return Utime(std::chrono::microseconds(Whole(name, kMinUtimeUs, kMaxUtimeUs))); }

  std::string Text(const char* name) {
    const auto found = members_.find(name);
    if (found == members_.end() || !found->is_string()) return Fail(std::string(name) + " is no text"), std::string();
    auto text = found->get<std::string>();
    members_.erase(found);
    return text;
  }

  ChannelIndex Channel(const char* name) {
    const auto text = Text(name);
    return fault_.empty() ? Index(text) : ChannelIndex{0};
  }

  std::vector<ChannelIndex> Channels(const char* name) {
    std::vector<ChannelIndex> channels;
    const auto found = members_.find(name);
    if (found == members_.end() || !found->is_array() || found->size() > ChannelNames().size())
      return Fail(std::string(name) + " is no array of channels"), channels;
    for (const auto& element : *found) {
      if (!element.is_string()) return Fail(std::string(name) + " is no array of channels"), channels;
      channels.push_back(Index(element.get_ref<const std::string&>()));
    }
    members_.erase(found);
    std::ranges::sort(channels);
    if (std::ranges::adjacent_find(channels) != channels.end()) Fail(std::string(name) + " names a channel twice");
    return channels;
  }

  bool Has(const char* name) const { return members_.contains(name); }

  // Nobody knows the meaning of a member that was not read.
  void End() {
    if (!members_.empty()) Fail("it has a member that is not known");
  }

  void Fail(std::string reason) {
    if (fault_.empty()) fault_ = std::move(reason);
  }
  const std::string& fault() const { return fault_; }

 private:
  ChannelIndex Index(const std::string& name) {
    const auto index = FindIndex(name);
    if (!index) Fail("it names a channel that is not known");
    return index.value_or(0);
  }

  json members_;
  std::string fault_;
};

constexpr std::int64_t kMaxTrackId = std::int64_t{1} << 53;

Order ReadOrder(Reader& reader) {
  Order order;
  const auto kind = reader.Text("kind");
  if (kind == "silence") return order;
  if (kind == "name") {
    order.kind = Order::Kind::kName;
    order.track_id = reader.Whole("track_id", 1, kMaxTrackId);
    order.name = reader.Text("name");
    if (!order.name.empty() && !IsName(order.name)) reader.Fail("this is no name");
    return order;
  }
  if (kind != "settings") reader.Fail("its kind is not known");
  order.kind = Order::Kind::kSettings;
  const auto mode = reader.Text("mode");
  if (mode != "open_water" && mode != "harbour") reader.Fail("its mode is not known");
  if (mode == "harbour") order.mode = Order::Mode::kHarbour;
  order.guard_zone_range_m = reader.Number("guard_zone_range_m", 0.0, kMaxLimitM);
  order.guard_zone_from_deg = reader.Number("guard_zone_from_deg", 0.0, 360.0);
  order.guard_zone_to_deg = reader.Number("guard_zone_to_deg", 0.0, 360.0);
  order.cpa_limit_m = reader.Number("cpa_limit_m", 0.0, kMaxLimitM);
  if (reader.Has("guard_zone_from_deg") != reader.Has("guard_zone_to_deg")) reader.Fail("one end of the sector is missing");
  return order;
}

At ReadAt(Reader& reader, std::uint32_t id, bool is_step) {
  At at;
  at.id = id;
  at.source = reader.Small("source", 0, kMaxSources - 1);
  if (is_step || reader.Has("utime_us")) {
    at.time = reader.Time("utime_us");
  } else {
    at.scan_time = reader.Time("scan_utime_us");
  }
  if (is_step) at.num_scans_on = static_cast<int>(reader.Whole("scans", -kMaxScansOn, kMaxScansOn));
  at.channels = reader.Channels("channels");
  return at;
}

Range ReadRange(Reader& reader, std::uint32_t id) {
  Range range;
  range.id = id;
  range.source = reader.Small("source", 0, kMaxSources - 1);
  range.channel = reader.Channel("channel");
  range.from = reader.Time("from_utime_us");
  range.to = reader.Time("to_utime_us");
  range.max_messages = reader.Small("max_messages", 1, kMaxRangeMessages);
  if (range.to < range.from) reader.Fail("to_utime_us is before from_utime_us");
  return range;
}

StripRequest ReadStrip(Reader& reader, std::uint32_t id) {
  StripRequest strip;
  strip.id = id;
  strip.source = reader.Small("source", 0, kMaxSources - 1);
  strip.from = reader.Time("from_utime_us");
  strip.to = reader.Time("to_utime_us");
  strip.num_buckets = reader.Small("buckets", 1, kMaxBuckets);
  if (strip.to <= strip.from) reader.Fail("to_utime_us is not after from_utime_us");
  return strip;
}

std::optional<Request> Read(Reader& reader, RequestFault& fault) {
  const auto op = reader.Text("op");
  if (op == "watch") return Watch{reader.Channels("channels")};
  if (op == "got") return Got{static_cast<std::uint64_t>(reader.Whole("frames", 0, std::int64_t{1} << 53))};
  if (op != "at" && op != "step" && op != "range" && op != "strip") {
    reader.Fail("its op is not known");
    return std::nullopt;
  }
  const auto id = static_cast<std::uint32_t>(reader.Whole("id", 1, std::numeric_limits<std::uint32_t>::max()));
  if (!reader.fault().empty()) return std::nullopt;
  fault.id = id;
  if (op == "range") return ReadRange(reader, id);
  if (op == "strip") return ReadStrip(reader, id);
  return ReadAt(reader, id, op == "step");
}

}  // namespace

const std::vector<std::string_view>& ChannelNames() {
  static const auto kNames = [] {
    std::vector<std::string_view> names;
    names.reserve(bus::kChannels.size());
    for (const auto& channel : bus::kChannels) names.push_back(channel.name);
    return names;
  }();
  return kNames;
}

std::optional<Request> ParseRequest(std::string_view text, RequestFault& fault) try {
  fault = {};
  auto members = ParseFlat(text);
  if (members.is_discarded()) {
    fault.reason = "it is not one flat JSON object";
    return std::nullopt;
  }
  Reader reader(std::move(members));
  auto request = Read(reader, fault);
  reader.End();
  if (reader.fault().empty()) return request;
  fault.reason = reader.fault();
  return std::nullopt;
} catch (const std::exception&) {
  fault.reason = "it cannot be read";
  return std::nullopt;
}

std::optional<Acknowledgement> ParseAcknowledgement(std::string_view text) try {
  auto members = ParseFlat(text);
  if (members.is_discarded()) return std::nullopt;
  Reader reader(std::move(members));
  Acknowledgement acknowledgement;
  acknowledgement.alert_id = reader.Whole("alert_id", -(std::int64_t{1} << 53), std::int64_t{1} << 53);
  if (acknowledgement.alert_id == 0) reader.Fail("no alert has the id 0");
  acknowledgement.raised = reader.Time("raised_utime_us");
  reader.End();
  if (!reader.fault().empty()) return std::nullopt;
  return acknowledgement;
} catch (const std::exception&) {
  return std::nullopt;
}

std::optional<Order> ParseOrder(std::string_view text) try {
  auto members = ParseFlat(text);
  if (members.is_discarded()) return std::nullopt;
  Reader reader(std::move(members));
  const auto order = ReadOrder(reader);
  reader.End();
  if (!reader.fault().empty()) return std::nullopt;
  return order;
} catch (const std::exception&) {
  return std::nullopt;
}

}  // namespace lookout::page
