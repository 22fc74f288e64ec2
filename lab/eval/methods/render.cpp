#include "lab/eval/methods/render.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/messages/checks.hpp"
#include "lab/data/scan_message.hpp"
#include "lab/sim/head_lidar.hpp"
#include "lab/sim/lidar.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "services/lidar/wire.hpp"
#include "services/segmenter/params.hpp"
#include "services/segmenter/wire.hpp"

namespace lookout::eval {
namespace {

using namespace std::chrono_literals;

// As lookout-sim begins: any date serves, as long as it is always the same.
constexpr Utime kStart{1'781'532'600'000'000us};
// Sending takes 100 us at 100 Mbit/s.
constexpr auto kLatency = 150us;

struct Truth {
  int ring;
  int return_index;
  std::int32_t object_id;
};

static_assert(sim::kNoObject == kNoTrueObject && sim::kOwnVessel == kOwnVesselObject);

// Takes the truth of each cell with a return, column by column. Within a column the truth is in the order of lasers, cells are in the order of rings.
std::vector<std::int32_t> TakeObjects(const segmenter::Scan& scan, std::deque<Truth>& truths) {
  const auto num_rings = static_cast<std::size_t>(scan.head.num_rings());
  const auto num_returns = static_cast<std::size_t>(scan.head.num_returns);
  const std::size_t column_cells = num_rings * num_returns;
  std::vector<std::int32_t> object(scan.num_cells(), kNoTrueObject);
  for (std::size_t first = 0; first < scan.num_cells(); first += column_cells) {
    std::size_t num_left = 0;
    for (std::size_t i = 0; i < column_cells; ++i) num_left += scan.columns.range[first + i] != 0 ? 1 : 0;
    std::vector<bool> is_taken(column_cells, false);
    for (; num_left > 0; --num_left) {
      if (truths.empty()) throw std::logic_error("a simulated scan has returns without truth");
      const Truth truth = truths.front();
      truths.pop_front();
      const std::size_t i = static_cast<std::size_t>(truth.ring) * num_returns + static_cast<std::size_t>(truth.return_index);
      if (i >= column_cells || scan.columns.range[first + i] == 0 || is_taken[i]) {
        throw std::logic_error("the truth of a simulated scan does not fit its returns");
      }
      is_taken[i] = true;
      object[first + i] = truth.object_id;
    }
  }
  return object;
}

void RenderHead(const sim::Scene& scene, const Boat& boat, const sim::Head& head, std::uint64_t seed, Utime end, LabelledScan& labelled,
                const ScanHandler& on_scan) {
  const sim::LidarParams params;
  sim::HeadLidar lidar(scene, boat.facts, head, params.rotation_rpm, params.field_of_view, kStart, seed);
  for (auto made = lidar.Next(); made.scan.head.end_time <= end; made = lidar.Next()) {
    auto received = ScanOfMessages(data::ToScanMessages(made.scan, std::string(head.model), bus::kMaxMessageBytes));
    if (!received) throw std::logic_error("the segmenter refuses a scan of a simulated head");
    labelled.scan = std::move(*received);
    labelled.object = std::move(made.object_id);
    on_scan(labelled);
  }
}

}  // namespace

Boat LoadBoat(const std::filesystem::path& config_folder) {
  return {config_folder, config::LoadBoat(config_folder), lidar::LoadParams(config_folder), segmenter::LoadParams(config_folder)};
}

std::optional<segmenter::Scan> ScanOfMessages(const std::vector<lidar_scan_t>& parts) {
  if (std::ranges::any_of(parts, [](const auto& part) { return messages::FaultOf(part, bus::kMaxMessageBytes).has_value(); })) return std::nullopt;
  return segmenter::ToScan(parts);
}

segmenter::Scan ToSegmenterScan(const lidar::Scan& scan) {
  auto received = ScanOfMessages(lidar::ToScanMessages(scan, 0, bus::kMaxMessageBytes));
  if (!received) throw std::logic_error("the segmenter refuses a scan of the decoder");
  return std::move(*received);
}

void RenderScans(const sim::Scene& scene, const Boat& boat, std::uint64_t seed, double seconds, const ScanHandler& on_scan) {
  LabelledScan labelled;
  for (const auto& object : scene.objects) labelled.objects[object.id] = {object.name, object.kind, object.is_in_water};
  const Utime end = kStart + std::chrono::microseconds(std::llround(seconds * 1e6));
  if (const auto* head = sim::FindHead(scene.lidar)) {
    RenderHead(scene, boat, *head, seed, end, labelled, on_scan);
    return;
  }

  std::deque<Truth> truths;
  vlp16::Decoder decoder(
      boat.lidar.decoder,
      [&](const lidar::Scan& scan) {
        labelled.scan = ToSegmenterScan(scan);
        labelled.object = TakeObjects(labelled.scan, truths);
        if (!scan.is_partial_start && !scan.is_partial_end) on_scan(labelled);
      },
      [](const lidar::SentenceOfLidar&) {});

  sim::LidarParams params;
  if (scene.lidar == sim::kHiResName) params.model = vlp16::Model::kPuckHiRes;
  params.use_vertical_origin_offsets = boat.lidar.decoder.use_vertical_origin_offsets;
  sim::Lidar lidar(scene, boat.facts, params, kStart, seed);
  for (auto packet = lidar.Next(); packet.end_time <= end; packet = lidar.Next()) {
    for (const auto& one : packet.returns) truths.push_back({one.ring, one.return_index, one.object_id});
    if (!decoder.OnDataPayload(packet.end_time + kLatency, packet.payload)) {
      throw std::logic_error("a simulated packet is refused: " + decoder.last_refusal());
    }
  }
  decoder.Flush();
  if (!truths.empty()) throw std::logic_error("the truth of a simulated scan does not fit its returns");
}

}  // namespace lookout::eval
