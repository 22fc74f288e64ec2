#include "services/lidar/decoders.hpp"

#include <chrono>
#include <utility>

#include "services/lidar/core/driver/column_decoder.hpp"
#include "services/lidar/core/models/imu_sentence.hpp"
#include "services/lidar/core/models/ouster_metadata.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "services/lidar/core/vlp16/form.hpp"
#include "services/lidar/core/vlp16/judge.hpp"

namespace lookout::lidar {

namespace {

// Models with many packets fill a bundle within some milliseconds; of the others none should wait longer.
constexpr std::chrono::milliseconds kMaxBundleWait(10);

std::function<std::unique_ptr<PacketReader>()> ReaderMakerOf(const OtherLidar& other) {
  const std::shared_ptr<const PacketReader> first = MakeReader(other.model, other.beam_text);
  return [first] { return first->Clone(); };
}

// Roll and pitch for the navigator; nullptr where the axes of the IMU are not known.
std::function<std::string(Bytes)> ImuSentences(const Params& params) {
  if (params.other->model != OtherModel::kOuster || !params.R_vessel_lidar) return nullptr;
  const auto metadata = ParseOusterMetadata(params.other->beam_text);
  if (!metadata.T_sensor_lidar || !metadata.T_sensor_imu) return nullptr;
  const Eigen::Matrix3d R_vessel_imu = *params.R_vessel_lidar * metadata.T_sensor_lidar->linear().transpose() * metadata.T_sensor_imu->linear();
  return [R_vessel_imu](Bytes payload) {
    const auto sample = ParseOusterImu(payload);
    return sample ? ImuSentence(*sample, R_vessel_imu) : std::string();
  };
}

}  // namespace

std::unique_ptr<Decoder> MakeDecoder(const Params& params, ScanHandler on_scan, SentenceHandler on_sentence) {
  if (!params.other) return std::make_unique<vlp16::Decoder>(params.decoder, std::move(on_scan), std::move(on_sentence));
  return std::make_unique<ColumnDecoder>(ColumnDecoderParams{.make_reader = ReaderMakerOf(*params.other),
                                                             .has_position_packets = RowOf(params.other->model).has_position_packets,
                                                             .sentence_of = ImuSentences(params),
                                                             .time = params.decoder.time,
                                                             .cut_azimuth_rad = params.decoder.cut_azimuth_rad},
                                         std::move(on_scan), std::move(on_sentence));
}

JudgeMaker JudgeOf(const Params& params) {
  if (!params.other) return vlp16::MakeJudgeOf(params.decoder.model);
  return MakeReaderJudge(ReaderMakerOf(*params.other), RowOf(params.other->model).position_size_bytes);
}

Bundler::Form FormOf(const Params& params) {
  if (!params.other) return vlp16::FormOf(params.decoder.cut_azimuth_rad);
  const auto position_size_bytes = RowOf(params.other->model).position_size_bytes;
  std::shared_ptr<const PacketReader> reader = MakeReader(params.other->model, params.other->beam_text);
  Bundler::Form form;
  form.is_data_size = [reader](std::size_t size_bytes) { return reader->MayBe(size_bytes); };
  form.is_position_size = [position_size_bytes](std::size_t size_bytes) { return size_bytes > 0 && size_bytes == position_size_bytes; };
  form.max_wait = kMaxBundleWait;
  return form;
}

}  // namespace lookout::lidar
