#include "lab/eval/tracks/over_time.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/io/stop_signal.hpp"
#include "common/messages/pieces.hpp"
#include "common/messages/scan_collector.hpp"
#include "lab/eval/methods/run_plan.hpp"
#include "lab/eval/tracks/track_labels.hpp"
#include "lab/sim/scene_file.hpp"
#include "services/segmenter/core/returns.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

// Scans that have no tracks wait for them, some seconds of scans at most.
constexpr std::size_t kMostScansWaiting = 256;

bool IsDone(const messages::ScanMessages& scan) {
  return messages::HasAllParts(scan.scans) && messages::HasAllParts(scan.segments) && messages::HasAllParts(scan.tracks);
}

std::int32_t LabelOfCell(std::int16_t segment, std::int16_t piece, const TrackLabels& labels) {
  if (segment == segmenter::ToLabel(segmenter::Reason::kFieldOfView)) return kNotScored;
  return segment > 0 ? labels.Of(segment, piece) : 0;
}

std::vector<std::int32_t> LabelsOfCells(const messages::ScanMessages& scan) {
  std::vector<tracks_t> tracks;
  tracks.reserve(scan.tracks.size());
  for (const auto& [part_index, part] : scan.tracks) tracks.push_back(part);
  const TrackLabels labels(tracks, TrackLabels::Land::kBySegment);
  std::vector<std::int32_t> label;
  for (const auto& [part_index, part] : scan.segments) {
    const auto piece = messages::PiecesOf(part);
    std::ranges::transform(part.label, piece, std::back_inserter(label),
                           [&labels](std::int16_t segment, std::int16_t of_cell) { return LabelOfCell(segment, of_cell, labels); });
  }
  return label;
}

}  // namespace

bool OverTimeMethod::BeginScan(const ScanPlace& place) {
  if (place.scene == scene_ && place.seed == seed_) return has_run_;
  scene_ = place.scene;
  seed_ = place.seed;
  Run(place);
  return has_run_;
}

void OverTimeMethod::Run(const ScanPlace& place) {
  scans_.clear();
  next_ = 0;
  messages::ScanCollector collector(IsDone, messages::ScanCollector::Order::kOfArrival, kMostScansWaiting,
                                    [this](const messages::ScanMessages& scan) {
                                      if (!messages::HasAllParts(scan.scans) || !messages::HasAllParts(scan.segments)) return;
                                      if (messages::IsCut(scan.scans.begin()->second.flags)) return;
                                      auto& cells = scans_.emplace_back();
                                      for (const auto& [part_index, part] : scan.scans)
                                        cells.range.insert(cells.range.end(), part.range.begin(), part.range.end());
                                      cells.label = LabelsOfCells(scan);
                                      if (cells.label.size() != cells.range.size())
                                        throw std::logic_error("SEGMENTS and LIDAR_SCAN do not agree in their cells");
                                    });
  replay::Chain chain(config_folder_, {}, [&collector](Utime, std::string_view channel, Bytes bytes) {
    const auto take = [&](auto message) {
      if (!message || !collector.Add(*std::move(message))) throw std::logic_error("a message of the services cannot be used");
    };
    if (channel == bus::kLidarScan.name) take(bus::Decode<lidar_scan_t>(bytes));
    if (channel == bus::kSegments.name) take(bus::Decode<segments_t>(bytes));
    if (channel == bus::kTracks.name) take(bus::Decode<tracks_t>(bytes));
  });
  has_run_ = feed_(
      place,
      [&chain](const replay::Datagram& datagram) {
        io::ThrowIfStopAsked();
        chain.OnDatagram(datagram);
      },
      [&chain](Utime time, const std::vector<lidar_scan_t>& parts) {
        for (const auto& part : parts) chain.OnLogged(time, bus::kLidarScan, bus::Encode(part));
      });
  if (!has_run_) return;
  chain.Finish();
  collector.Finish();
}

Labelling OverTimeMethod::Segment(const segmenter::Scan& scan) {
  const auto& range = scan.columns.range;
  const auto is_same = [&range](const LabelledCells& cells) {
    return std::ranges::equal(range, cells.range, [](std::uint16_t scored, std::uint16_t sent) { return scored == 0 || scored == sent; });
  };
  while (next_ < scans_.size() && !is_same(scans_[next_])) ++next_;
  if (next_ == scans_.size()) throw std::runtime_error(scene_ + ": a scan is not among those of the whole boat's run");
  Labelling labelling;
  labelling.label = scans_[next_++].label;
  for (std::size_t cell = 0; cell < range.size(); ++cell) {
    if (range[cell] == 0) labelling.label[cell] = 0;
  }
  labelling.is_timed = false;
  return labelling;
}

OverTimeMethod::Feed FeedOfScenes(const std::filesystem::path& config_folder, std::span<const std::string> scenes, double seconds,
                                  const std::string& lidar) {
  std::map<std::string, std::filesystem::path> files;
  for (const auto& scene : scenes) files[SceneLabel(scene)] = sim::FindScene(scene, config_folder);
  return [config_folder, files, seconds, lidar](const ScanPlace& place, const DatagramHandler& on_datagram, const ScanMessageHandler& on_scan) {
    // The last packet of the last scan arrives later than it ends.
    constexpr double kArrivalS = 0.1;
    const auto file = files.find(place.scene);
    if (file == files.end()) return false;
    Truth truth(1);
    SimulateRun(config_folder, file->second, place.seed, seconds + kArrivalS, truth, on_datagram, on_scan, lidar);
    return true;
  };
}

OverTimeMethod::Feed FeedOfCaptures(std::vector<CaptureWithTruth> captures) {
  return [captures = std::move(captures)](const ScanPlace& place, const DatagramHandler& on_datagram, const ScanMessageHandler& /*on_scan*/) {
    const auto files = std::ranges::find_if(captures, [&](const auto& one) { return one.scene == place.scene && one.seed == place.seed; });
    if (files == captures.end()) return false;
    SendCapture(*files, on_datagram);
    return true;
  };
}

}  // namespace lookout::eval
