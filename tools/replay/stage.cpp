#include "tools/replay/stage.hpp"

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
  LidarStage(bus::Bus& bus, const fs::path& config_folder, const StageInput& input)
      : params_(Load(config_folder, input.reads_raw ? lidar::Input::kLog : lidar::Input::kOutside)), service_(bus, params_) {}

  void AdvanceTo(Utime time) override { service_.AdvanceTo(time); }
  bool OnDatagram(const Datagram& datagram) override {
    if (datagram.port != params_.data_port && datagram.port != params_.position_port) return false;
    if (datagram.port == params_.data_port) ++num_measured_;
    service_.OnDatagram(datagram.host_time, datagram.port, datagram.payload, datagram.sender);
    return true;
  }
  void Finish(Utime time) override { service_.Finish(time); }
  HealthReport Report() const override { return service_.Report(); }

 private:
  static lidar::Params Load(const fs::path& config_folder, lidar::Input input) {
    auto params = lidar::LoadParams(config_folder);
    params.input = input;
    return params;
  }

  lidar::Params params_;
  lidar::Service service_;
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
      : params_(Load(config_folder, input.reads_raw)), service_(bus, params_) {}

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
    service_.OnDatagram(time, line);  // as if it had come by the input "udp"
  }
  void Finish(Utime time) override { service_.Finish(time); }
  std::int64_t FinishLogs(Utime time, bool is_whole) override {
    if (!params_.reads_nav_raw && is_whole) service_.Finish(time);  // LIDAR_NMEA has no end mark: it sets its own
    return 0;
  }
  HealthReport Report() const override { return service_.Report(); }

 private:
  static navigator::Params Load(const fs::path& config_folder, bool reads_raw) {
    auto params = navigator::LoadParams(config_folder);
    params.reads_nav_raw = reads_raw;
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

template <typename S>
std::unique_ptr<Stage> Make(bus::Bus& bus, const fs::path& config_folder, const StageInput& input) {
  return std::make_unique<S>(bus, config_folder, input);
}

}  // namespace

const std::vector<StageFactory>& StageFactories() {
  static const std::vector<StageFactory> kFactories{
      {"lidar", [](const fs::path& folder) { lidar::LoadParams(folder); }, Make<LidarStage>},
      {"segmenter", [](const fs::path& folder) { segmenter::LoadParams(folder); }, Make<PlainStage<segmenter::Service, segmenter::LoadParams>>},
      {"odometer", [](const fs::path& folder) { odometer::LoadParams(folder); }, Make<PlainStage<odometer::Service, odometer::LoadParams>>},
      {"navigator", [](const fs::path& folder) { navigator::LoadParams(folder); }, Make<NavigatorStage>},
      {"georeferencer", [](const fs::path& folder) { georeferencer::LoadParams(folder); }, Make<GeoreferencerStage>},
      {"tracker", [](const fs::path& folder) { tracker::LoadParams(folder); }, Make<TrackerStage>}};
  return kFactories;
}

}  // namespace lookout::replay
