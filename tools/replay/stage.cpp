#include "tools/replay/stage.hpp"

#include <list>
#include <map>

#include "services/ais/params.hpp"
#include "services/ais/service.hpp"
#include "services/georeferencer/params.hpp"
#include "services/georeferencer/service.hpp"
#include "services/lidar/params.hpp"
#include "services/lidar/service.hpp"
#include "services/lidar/sources.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/service.hpp"
#include "services/odometer/params.hpp"
#include "services/odometer/service.hpp"
#include "services/segmenter/params.hpp"
#include "services/segmenter/service.hpp"
#include "services/tracker/params.hpp"
#include "services/tracker/service.hpp"

namespace lookout::replay {

namespace {

namespace fs = std::filesystem;

class LidarStage final : public Stage {
 public:
  LidarStage(bus::Bus& bus, const fs::path& config_folder, const StageInput& input) {
    for (const int number : {1, 2}) {
      if (number == 2 && !lidar::HasSecond(config_folder)) continue;
      auto params = lidar::LoadParams(config_folder, number);
      params.input = input.reads_raw ? lidar::Input::kLog : lidar::Input::kOutside;
      lidars_.emplace_back(bus, params);
    }
  }

  void AdvanceTo(Utime time) override {
    for (auto& lidar : lidars_) lidar.service.AdvanceTo(time);
  }
  bool OnDatagram(const Datagram& datagram) override {
    bool is_taken = false;
    for (auto& lidar : lidars_) {
      if (datagram.port != lidar.params.data_port && datagram.port != lidar.params.position_port) continue;
      is_taken = true;
      if (datagram.port == lidar.params.data_port) ++num_measured_;
      lidar.service.OnDatagram(datagram.host_time, datagram.port, datagram.payload, datagram.sender);
    }
    return is_taken;
  }
  void Finish(Utime time) override {
    for (auto& lidar : lidars_) lidar.service.Finish(time);
  }
  HealthReport Report() const override {
    auto report = lidars_.front().service.Report();
    if (lidars_.size() == 1) return report;
    std::map<std::string_view, std::int64_t> of_second;
    const auto second = lidars_.back().service.Report();
    for (const auto& counter : second.counters) of_second[counter.name] += counter.count;
    for (auto& counter : report.counters) {
      counter.count += of_second[counter.name];
      of_second.erase(counter.name);
    }
    for (const auto& [name, count] : of_second) report.counters.push_back({name, count});
    report.reason += (report.reason.empty() || second.reason.empty() ? "" : "; ") + second.reason;
    return report;
  }

 private:
  struct Lidar {
    Lidar(bus::Bus& bus, const lidar::Params& of_config) : params(of_config), service(bus, params) {}

    lidar::Params params;
    lidar::Service service;
  };

  std::list<Lidar> lidars_;  // one or two
};

// A service that computes its output from messages alone, and holds nothing at its end.
template <typename Service, auto load>
class PlainStage final : public Stage {
 public:
  PlainStage(bus::Bus& bus, const fs::path& config_folder, const StageInput& /*input*/) : service_(bus, load(config_folder)) {}

  HealthReport Report() const override { return service_.Report(); }

 private:
  Service service_;
};

class NavigatorStage final : public Stage {
 public:
  NavigatorStage(bus::Bus& bus, const fs::path& config_folder, const StageInput& input)
      : params_(Load(config_folder, input)), service_(bus, params_) {}

  void AdvanceTo(Utime time) override { service_.AdvanceTo(time); }
  bool OnDatagram(const Datagram& datagram) override {
    const auto source = params_.source_of_port.find(datagram.port);
    if (source == params_.source_of_port.end()) return false;
    ++num_measured_;
    service_.OnDatagram(datagram.host_time, datagram.payload, source->second, datagram.sender.address + " " + std::to_string(datagram.sender.port));
    return true;
  }
  void OnTextLine(Utime time, Bytes line) override {
    ++num_measured_;
    service_.OnDatagram(time, line);  // as if the line had come by the input "udp"
  }
  void Finish(Utime time) override { service_.Finish(time); }
  std::int64_t FinishLogs(Utime time, bool is_whole) override {
    if (!params_.reads_nav_raw && is_whole) service_.Finish(time);  // LIDAR_NMEA has no end mark: the navigator sets its own
    return 0;
  }
  HealthReport Report() const override { return service_.Report(); }

 private:
  static navigator::Params Load(const fs::path& config_folder, const StageInput& input) {
    auto params = navigator::LoadParams(config_folder);
    params.reads_nav_raw = input.reads_raw;
    params.navigator.use_lidar_odometry = params.navigator.use_lidar_odometry && input.plan.pose_by_lidar;
    params.navigator.use_lidar_imu = input.plan.pose_by_lidar;
    return params;
  }

  navigator::Params params_;
  navigator::Service service_;
};

class GeoreferencerStage final : public Stage {
 public:
  GeoreferencerStage(bus::Bus& bus, const fs::path& config_folder, const StageInput& /*input*/)
      : bus_(bus), service_(bus, georeferencer::LoadParams(config_folder)) {}

  void Finish(Utime /*time*/) override { service_.Finish(); }
  // It reads no marks. Where the run was cut, scans that wait for POSE are left out, unless no POSE can come.
  std::int64_t FinishLogs(Utime /*time*/, bool is_whole) override {
    if (!is_whole && bus_.input_traffic().find(bus::kPose.name)->second.num_messages > 0) return service_.num_waiting();
    service_.Finish();
    return 0;
  }
  HealthReport Report() const override { return service_.Report(); }

 private:
  bus::Bus& bus_;
  georeferencer::Service service_;
};

class TrackerStage final : public Stage {
 public:
  TrackerStage(bus::Bus& bus, const fs::path& config_folder, const StageInput& input)
      : service_(bus, tracker::LoadParams(config_folder),
                 {.sources = {.has_beams = input.plan.Gives(bus::kLidarScan), .has_labels = input.plan.Gives(bus::kSegments)},
                  .script = input.plan.script}) {}

  void Finish(Utime /*time*/) override { service_.Finish(); }
  // It reads no marks. Where the run was cut, scans that wait are left out.
  std::int64_t FinishLogs(Utime /*time*/, bool is_whole) override {
    if (is_whole) service_.Finish();
    return 0;
  }
  HealthReport Report() const override { return service_.Report(); }

 private:
  tracker::Service service_;
};

class AisStage final : public Stage {
 public:
  AisStage(bus::Bus& bus, const fs::path& config_folder, const StageInput& /*input*/) : service_(bus, ais::LoadParams(config_folder)) {}

  void Finish(Utime /*time*/) override { service_.Finish(); }
  // It reads no marks. Where the run was cut, scans that wait are left out.
  std::int64_t FinishLogs(Utime /*time*/, bool is_whole) override {
    if (is_whole) service_.Finish();
    return 0;
  }
  HealthReport Report() const override { return service_.Report(); }

 private:
  ais::Service service_;
};

template <typename S>
std::unique_ptr<Stage> Make(bus::Bus& bus, const fs::path& config_folder, const StageInput& input) {
  return std::make_unique<S>(bus, config_folder, input);
}

}  // namespace

const std::vector<StageFactory>& StageFactories() {
  static const std::vector<StageFactory> kFactories{
      {"lidar",
       [](const fs::path& folder) {
         lidar::LoadParams(folder);
         if (lidar::HasSecond(folder)) lidar::LoadParams(folder, 2);
       },
       Make<LidarStage>},
      {"segmenter", [](const fs::path& folder) { segmenter::LoadParams(folder); }, Make<PlainStage<segmenter::Service, segmenter::LoadLanes>>},
      {"odometer", [](const fs::path& folder) { odometer::LoadParams(folder); }, Make<PlainStage<odometer::Service, odometer::LoadParams>>},
      {"navigator", [](const fs::path& folder) { navigator::LoadParams(folder); }, Make<NavigatorStage>},
      {"georeferencer", [](const fs::path& folder) { georeferencer::LoadParams(folder); }, Make<GeoreferencerStage>},
      {"tracker", [](const fs::path& folder) { tracker::LoadParams(folder); }, Make<TrackerStage>},
      {"ais", [](const fs::path& folder) { ais::LoadParams(folder); }, Make<AisStage>}};
  return kFactories;
}

}  // namespace lookout::replay
