#include "services/lidar/core/models/table.hpp"

#include <array>
#include <stdexcept>

#include "services/lidar/core/models/hesai.hpp"
#include "services/lidar/core/models/ouster.hpp"
#include "services/lidar/core/models/ouster_metadata.hpp"
#include "services/lidar/core/models/velodyne.hpp"

namespace lookout::lidar {

namespace {

constexpr std::size_t kVelodynePositionBytes = 512;
constexpr std::size_t kOusterImuBytes = 48;
constexpr int kVelodynePort = 2368;
constexpr int kVelodynePositionPort = 8308;
constexpr std::string_view kAngles = "the angle correction of this unit (CSV)";

// In the order of OtherModel. The second port of a Hesai sends 512 bytes of GPS that say nothing about the packets' stamps.
constexpr std::array kModels{
    ModelRow{OtherModel::kVlp32c, "Velodyne VLP-32C", false, "", true, kVelodynePositionBytes, kVelodynePort, kVelodynePositionPort, 0},
    ModelRow{OtherModel::kHdl32e, "Velodyne HDL-32E", false, "", true, kVelodynePositionBytes, kVelodynePort, kVelodynePositionPort, 0},
    ModelRow{OtherModel::kVls128, "Velodyne VLS-128", false, "", true, kVelodynePositionBytes, kVelodynePort, kVelodynePositionPort, 0},
    ModelRow{OtherModel::kOuster, "an Ouster", true, "the metadata of this sensor (JSON), which http://SENSOR/api/v1/sensor/metadata gives", false,
             kOusterImuBytes, 7502, 7503, 80},
    ModelRow{OtherModel::kXt16, "Hesai XT16", false, kAngles, false, 512, kVelodynePort, 10110, 9347},
    ModelRow{OtherModel::kXt32, "Hesai XT32", false, kAngles, false, 512, kVelodynePort, 10110, 9347},
    ModelRow{OtherModel::kXt32m, "Hesai XT32M", false, kAngles, false, 512, kVelodynePort, 10110, 9347},
    ModelRow{OtherModel::kQt64, "Hesai QT64", false, kAngles, false, 512, kVelodynePort, 10110, 9347},
    ModelRow{OtherModel::kQt128, "Hesai QT128", false, kAngles, false, 512, kVelodynePort, 10110, 9347},
    ModelRow{OtherModel::kPandar40p, "Hesai Pandar40P", false, kAngles, false, 512, kVelodynePort, 10110, 9347},
    ModelRow{OtherModel::kPandar64, "Hesai Pandar64", false, kAngles, false, 512, kVelodynePort, 10110, 9347},
};

std::unique_ptr<PacketReader> MakeHesai(HesaiModel model, const std::string& beam_text) {
  return beam_text.empty() ? std::make_unique<HesaiReader>(model) : std::make_unique<HesaiReader>(model, ParseHesaiAngles(beam_text));
}

}  // namespace

std::span<const ModelRow> ModelTable() { return kModels; }

const ModelRow& RowOf(OtherModel model) { return kModels.at(static_cast<std::size_t>(model)); }

std::unique_ptr<PacketReader> MakeReader(OtherModel model, const std::string& beam_text) {
  switch (model) {
    case OtherModel::kVlp32c:
      return std::make_unique<VelodyneReader>(VelodyneModel::kVlp32c);
    case OtherModel::kHdl32e:
      return std::make_unique<VelodyneReader>(VelodyneModel::kHdl32e);
    case OtherModel::kVls128:
      return std::make_unique<VelodyneReader>(VelodyneModel::kVls128);
    case OtherModel::kXt16:
      return MakeHesai(HesaiModel::kXt16, beam_text);
    case OtherModel::kXt32:
      return MakeHesai(HesaiModel::kXt32, beam_text);
    case OtherModel::kXt32m:
      return MakeHesai(HesaiModel::kXt32m, beam_text);
    case OtherModel::kQt64:
      return MakeHesai(HesaiModel::kQt64, beam_text);
    case OtherModel::kQt128:
      return MakeHesai(HesaiModel::kQt128, beam_text);
    case OtherModel::kPandar40p:
      return MakeHesai(HesaiModel::kPandar40p, beam_text);
    case OtherModel::kPandar64:
      return MakeHesai(HesaiModel::kPandar64, beam_text);
    case OtherModel::kOuster:
      return std::make_unique<OusterReader>(ParseOusterMetadata(beam_text));
  }
  throw std::logic_error("MakeReader: no such model");
}

}  // namespace lookout::lidar
