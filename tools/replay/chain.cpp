#include "tools/replay/chain.hpp"

#include <utility>

#include "common/config/text_config.hpp"
#include "common/runtime/run_info.hpp"
#include "services/georeferencer/params.hpp"
#include "services/navigator/params.hpp"
#include "services/segmenter/params.hpp"
#include "services/vlp16/params.hpp"
#include "services/vlp16/sources.hpp"

namespace lookout::replay {

namespace {

vlp16::Params LidarParams(const std::filesystem::path& config_folder, vlp16::Input input) {
  auto params = vlp16::LoadParams(config_folder);
  vlp16::WriteAllowedAlike(params.sources);
  params.input = input;
  return params;
}

navigator::Params NavigationParams(const std::filesystem::path& config_folder, navigator::Input input) {
  auto params = navigator::LoadParams(config_folder);
  params.input = input;
  return params;
}

// Adds the time that `call` takes to `total`: for the table of stages only.
template <typename Call>
void Timed(std::chrono::nanoseconds& total, Call call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  total += std::chrono::steady_clock::now() - start;
}

}  // namespace

void CheckConfig(const std::filesystem::path& config_folder) {
  config::FaultList faults;
  faults.Try([&] { runtime::EffectiveConfig(config_folder); });
  faults.Try([&] { vlp16::LoadParams(config_folder); });
  faults.Try([&] { segmenter::LoadParams(config_folder); });
  faults.Try([&] { navigator::LoadParams(config_folder); });
  faults.Try([&] { georeferencer::LoadParams(config_folder); });
  faults.ThrowIfAny();
}

Chain::Chain(const std::filesystem::path& config_folder, const Plan& plan, Sink sink)
    : sink_(std::move(sink)),
      read_(plan.read),
      is_navigation_live_(plan.navigation == navigator::Input::kOutside),
      ports_(LidarParams(config_folder, plan.lidar), NavigationParams(config_folder, plan.navigation)) {
  if (plan.runs_vlp16) vlp16_.emplace(bus_, LidarParams(config_folder, plan.lidar));
  if (plan.runs_segmenter) segmenter_.emplace(bus_, segmenter::LoadParams(config_folder));
  if (plan.runs_navigator) navigator_.emplace(bus_, NavigationParams(config_folder, plan.navigation));
  if (plan.runs_georeferencer) georeferencer_.emplace(bus_, georeferencer::LoadParams(config_folder));
  bus_.SubscribeAll([this](std::string_view channel, Bytes bytes) {
    auto digest = digests_.find(channel);
    if (digest == digests_.end()) digest = digests_.try_emplace(std::string(channel)).first;
    ++digest->second.count;
    Timed(digest_time_, [&] { digest->second.sha256.Add(bytes.data(), bytes.size()); });
    sink_(*time_, channel, bytes);
  });
}

Chain::Ports::Ports(const vlp16::Params& lidar, const navigator::Params& navigation)
    : lidar_data(lidar.data_port), lidar_position(lidar.position_port), nmea(navigation.source_of_port) {}

void Chain::AdvanceTo(Utime time) {
  if (!first_time_) first_time_ = time;
  time_ = time;
  if (vlp16_) {
    Timed(vlp16_time_, [&] { vlp16_->AdvanceTo(time); });
    Drain();
  }
  if (navigator_ && is_navigation_live_) {
    Timed(navigator_time_, [&] { navigator_->AdvanceTo(time); });
    Drain();
  }
}

void Chain::OnDatagram(Utime host_time, int udp_port, Bytes payload, const vlp16::Sender& sender) {
  AdvanceTo(host_time);
  const auto source = ports_.nmea.find(udp_port);
  if (vlp16_ && (udp_port == ports_.lidar_data || udp_port == ports_.lidar_position)) {
    num_data_datagrams_ += udp_port == ports_.lidar_data ? 1 : 0;
    Timed(vlp16_time_, [&] { vlp16_->OnDatagram(host_time, udp_port, payload, sender); });
  } else if (navigator_ && source != ports_.nmea.end()) {
    ++num_nmea_datagrams_;
    Timed(navigator_time_, [&] { navigator_->OnDatagram(host_time, payload, source->second); });
  } else {
    ++num_other_ports_;
  }
  Drain();
}

void Chain::OnTextLine(Utime time, Bytes line) {
  AdvanceTo(time);
  if (navigator_) {
    ++num_nmea_datagrams_;
    Timed(navigator_time_, [&] { navigator_->OnDatagram(time, line); });
  }
  Drain();
}

void Chain::OnLogged(Utime log_time, const bus::Channel& channel, Bytes bytes) {
  AdvanceTo(log_time);
  bus_.Publish(channel, bytes);
  Drain();
}

void Chain::Finish() {
  if (!time_) return;  // nothing came: nothing waits
  if (vlp16_) {
    Timed(vlp16_time_, [&] { vlp16_->Finish(*time_); });
    Drain();
  }
  if (navigator_) {
    Timed(navigator_time_, [&] { navigator_->Finish(*time_); });
    Drain();
  }
  if (georeferencer_) georeferencer_->Finish();
  Drain();
}

std::int64_t Chain::FinishLogs(bool is_whole) {
  if (!time_) return 0;
  if (navigator_ && is_navigation_live_ && is_whole) {  // out of LIDAR_NMEA: it sets its own end mark
    Timed(navigator_time_, [&] { navigator_->Finish(*time_); });
    Drain();
  }
  if (!georeferencer_) return 0;
  const auto pose = bus_.input_traffic().find(bus::kPose.name);
  const bool has_pose = pose != bus_.input_traffic().end() && pose->second.num_messages > 0;
  if (!is_whole && has_pose) return georeferencer_->num_waiting();
  georeferencer_->Finish();
  Drain();
  return 0;
}

void Chain::Drain() {
  while (bus_.HandleOnce()) {
  }
}

std::vector<Chain::StageTime> Chain::StageTimes() const {
  const auto handling = [this](const bus::Channel& channel) {
    const auto traffic = bus_.input_traffic().find(channel.name);
    return traffic == bus_.input_traffic().end() ? std::chrono::nanoseconds(0) : traffic->second.total_handling_time;
  };
  std::vector<StageTime> times;
  if (vlp16_) times.push_back({"vlp16", ToSeconds(vlp16_time_ + handling(bus::kLidarPackets))});
  if (segmenter_) times.push_back({"segmenter", ToSeconds(handling(bus::kLidarScan))});
  if (navigator_) times.push_back({"navigator", ToSeconds(navigator_time_ + handling(bus::kNavRaw) + handling(bus::kLidarNmea))});
  if (georeferencer_) times.push_back({"georeferencer", ToSeconds(handling(bus::kSegments) + handling(bus::kPose))});
  return times;
}

std::vector<std::pair<std::string, std::int64_t>> Chain::Counters() const {
  std::vector<std::pair<std::string, std::int64_t>> counters;
  const auto add = [&counters](const std::string& service, const HealthReport& report) {
    for (const auto& counter : report.counters) {
      if (counter.count != 0) counters.emplace_back(service + "." + std::string(counter.name), counter.count);
    }
  };
  if (vlp16_) add("vlp16", vlp16_->Report());
  if (segmenter_) add("segmenter", segmenter_->Report());
  if (navigator_) add("navigator", navigator_->Report());
  if (georeferencer_) add("georeferencer", georeferencer_->Report());
  for (const auto& [channel, traffic] : bus_.input_traffic()) {
    if (traffic.num_undecodable != 0) counters.emplace_back(channel + ".undecodable", traffic.num_undecodable);
    if (traffic.num_lost != 0) counters.emplace_back(channel + ".lost", traffic.num_lost);
  }
  if (num_other_ports_ != 0) counters.emplace_back("input.other_port", num_other_ports_);
  return counters;
}

std::vector<std::pair<std::string, std::int64_t>> Chain::Gaps() const {
  std::vector<std::pair<std::string, std::int64_t>> gaps;
  for (const auto channel : read_) {
    const auto traffic = bus_.input_traffic().find(channel);
    if (traffic != bus_.input_traffic().end() && traffic->second.num_lost > 0) gaps.emplace_back(channel, traffic->second.num_lost);
  }
  return gaps;
}

}  // namespace lookout::replay
