#include "tools/replay/plan.hpp"

#include <algorithm>

namespace lookout::replay {

namespace {

using ChannelSet = std::set<std::string, std::less<>>;

// The chain as a table: what gives a channel at which a replay can begin, and what else is before that channel.
struct Start {
  std::string_view channel;
  bool stops_vlp16;
  bool stops_segmenter;
  bool stops_navigator;
};
// NAV_RAW, not LIDAR_NMEA, is what POSE is made of: vlp16 is not before it.
constexpr Start kStarts[] = {{bus::kLidarPackets.name, false, false, false}, {bus::kLidarScan.name, true, false, false},
                             {bus::kLidarNmea.name, true, false, false},     {bus::kSegments.name, true, true, false},
                             {bus::kNavRaw.name, false, false, false},       {bus::kPose.name, false, false, true}};

bool Holds(const std::vector<std::string>& names, std::string_view name) { return std::ranges::find(names, name) != names.end(); }

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Which services run, with no word yet about what they read.
Plan Running(const Request& request) {
  for (const auto& name : request.only) {
    if (!Holds(ServiceNames(), name)) throw RequestError("--only " + name + ": is none of " + Joined(ServiceNames()));
  }
  const auto is_wanted = [&request](std::string_view service) { return request.only.empty() || Holds(request.only, service); };
  Plan plan;
  plan.runs_vlp16 = is_wanted("vlp16");
  plan.runs_segmenter = is_wanted("segmenter");
  plan.runs_navigator = is_wanted("navigator");
  plan.runs_georeferencer = is_wanted("georeferencer");
  for (const auto& name : request.from) {
    const auto* start = std::ranges::find(kStarts, name, &Start::channel);
    if (start == std::end(kStarts)) throw RequestError("--from " + name + ": is none of " + Joined(FromNames()));
    const auto stop = [&](bool& runs, bool is_stopped, std::string_view service) {
      if (is_stopped && Holds(request.only, service)) {
        throw RequestError("--only " + std::string(service) + ": does not run with --from " + name);
      }
      runs = runs && !is_stopped;
    };
    stop(plan.runs_vlp16, start->stops_vlp16, "vlp16");
    stop(plan.runs_segmenter, start->stops_segmenter, "segmenter");
    stop(plan.runs_navigator, start->stops_navigator, "navigator");
  }
  return plan;
}

bool TakesLidarNmea(const Request& request, bool has_nav_raw) {
  return !Holds(request.from, bus::kNavRaw.name) && (Holds(request.from, bus::kLidarNmea.name) || !has_nav_raw);
}

// Channels that the services of the plan take and do not give each other.
std::vector<std::string_view> Unmet(const Plan& plan, bool takes_lidar_nmea) {
  std::vector<std::string_view> channels;
  const auto add = [&channels](const bus::Channel& channel, bool is_unmet) {
    if (is_unmet) channels.push_back(channel.name);
  };
  add(bus::kLidarPackets, plan.runs_vlp16);
  add(bus::kLidarScan, plan.runs_segmenter && !plan.runs_vlp16);
  add(bus::kLidarNmea, plan.runs_navigator && takes_lidar_nmea && !plan.runs_vlp16);
  add(bus::kSegments, plan.runs_georeferencer && !plan.runs_segmenter);
  add(bus::kNavRaw, plan.runs_navigator && !takes_lidar_nmea);
  add(bus::kPose, plan.runs_georeferencer && !plan.runs_navigator);
  return channels;
}

void RequireTaken(const Request& request, const std::vector<std::string_view>& unmet) {
  for (const auto& name : request.from) {
    if (std::ranges::find(unmet, name) == unmet.end()) throw RequestError("--from " + name + ": no service that runs takes it");
  }
}

// The services of the plan that get anything to do, by name.
std::vector<std::string> FedServices(const Plan& plan, const ChannelSet& present) {
  const auto has = [&present](const bus::Channel& channel) { return present.contains(channel.name); };
  const bool is_vlp16_fed = plan.runs_vlp16 && has(bus::kLidarPackets);
  const bool is_segmenter_fed = plan.runs_segmenter && (plan.runs_vlp16 ? is_vlp16_fed : has(bus::kLidarScan));
  const bool has_sentences = plan.runs_vlp16 ? is_vlp16_fed : has(bus::kLidarNmea);
  const bool is_navigator_fed = plan.runs_navigator && (plan.navigation == navigator::Input::kLog ? has(bus::kNavRaw) : has_sentences);
  const bool is_georeferencer_fed = plan.runs_georeferencer && ((plan.runs_segmenter ? is_segmenter_fed : has(bus::kSegments)) ||
                                                                (plan.runs_navigator ? is_navigator_fed : has(bus::kPose)));
  std::vector<std::string> fed;
  if (is_vlp16_fed) fed.emplace_back("vlp16");
  if (is_segmenter_fed) fed.emplace_back("segmenter");
  if (is_navigator_fed) fed.emplace_back("navigator");
  if (is_georeferencer_fed) fed.emplace_back("georeferencer");
  return fed;
}

}  // namespace

bool Plan::Reads(std::string_view channel) const { return std::ranges::find(read, channel) != read.end(); }

const std::vector<std::string>& ServiceNames() {
  static const std::vector<std::string> kNames{"vlp16", "segmenter", "navigator", "georeferencer"};
  return kNames;
}

const std::vector<std::string>& FromNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& start : kStarts) names.emplace_back(start.channel);
    return names;
  }();
  return kNames;
}

ChannelSet Candidates(const Request& request) {
  const auto plan = Running(request);
  const auto unmet = Unmet(plan, TakesLidarNmea(request, true));
  RequireTaken(request, unmet);
  return {unmet.begin(), unmet.end()};
}

Plan MakeLogPlan(const Request& request, const ChannelSet& present) {
  Plan plan = Running(request);
  const bool takes_lidar_nmea = TakesLidarNmea(request, present.contains(bus::kNavRaw.name));
  plan.lidar = vlp16::Input::kLog;
  plan.navigation = takes_lidar_nmea ? navigator::Input::kOutside : navigator::Input::kLog;
  plan.read = Unmet(plan, takes_lidar_nmea);
  RequireTaken(request, plan.read);
  for (const auto& name : request.from) {
    if (!present.contains(name)) throw std::runtime_error("--from " + name + ": the input does not hold it");
  }
  const auto fed = FedServices(plan, present);
  for (const auto& service : request.only) {
    if (!Holds(fed, service)) throw std::runtime_error("--only " + service + ": the input holds nothing that it takes");
  }
  if (fed.empty()) {
    const auto candidates = Candidates(request);
    throw std::runtime_error("the input holds none of " + Joined({candidates.begin(), candidates.end()}) + ": nothing can be computed again");
  }
  return plan;
}

Plan MakeCapturePlan(const Request& request) {
  Plan plan = Running(request);
  if (!request.from.empty()) throw RequestError("--from " + request.from.front() + ": a capture holds datagrams, not messages");
  if (plan.runs_segmenter && !plan.runs_vlp16) throw RequestError("--only segmenter: a capture needs vlp16 too");
  if (plan.runs_georeferencer && !plan.runs_segmenter && !plan.runs_navigator) {
    throw RequestError("--only georeferencer: a capture needs vlp16 and segmenter, or navigator, too");
  }
  return plan;
}

std::string InWords(const Plan& plan) {
  std::vector<std::string> services;
  if (plan.runs_vlp16) services.emplace_back("vlp16");
  if (plan.runs_segmenter) services.emplace_back("segmenter");
  if (plan.runs_navigator) services.emplace_back("navigator");
  if (plan.runs_georeferencer) services.emplace_back("georeferencer");
  const std::string input = plan.read.empty() ? "datagrams" : Joined({plan.read.begin(), plan.read.end()});
  return "ran: " + Joined(services) + "\nread: " + input + "\n";
}

}  // namespace lookout::replay
