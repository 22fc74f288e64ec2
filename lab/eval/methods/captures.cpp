#include "lab/eval/methods/captures.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "common/config/text_config.hpp"
#include "common/io/stop_signal.hpp"
#include "config/schema/segmenter.pb.h"
#include "lab/data/csv_file.hpp"
#include "lab/data/xz_file.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "services/segmenter/params.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCaptureEnding = ".pcap.xz";
constexpr std::uint64_t kMaxCaptureBytes = std::uint64_t{1} << 30;

fs::path Beside(const fs::path& capture, const std::string& ending) {
  const auto name = capture.filename().string();
  return capture.parent_path() / (name.substr(0, name.size() - kCaptureEnding.size()) + ending);
}

struct TrueReturn {
  std::int64_t utime_us = 0;
  int return_index = 0;
  std::uint16_t range = 0;  // in format::kRangeUnitM
  std::int32_t object = kNoTrueObject;
  bool is_taken = false;
};

// The truth about the returns of one stretch of time after the other.
class TruthFile {
 public:
  explicit TruthFile(const fs::path& file) : csv_(file, {"utime_us", "ring", "return_index", "range_m", "object_id"}) {}

  // Reads up to a time and forgets what lies before another.
  void MoveTo(std::int64_t begin_us, std::int64_t end_us) {
    for (auto& ring : by_ring_) {
      for (; !ring.empty() && ring.front().utime_us < begin_us; --num_kept_) ring.pop_front();
    }
    while (last_us_ < end_us && csv_.Next()) TakeRow(begin_us);
  }

  // Reads the rest, so that a fault in it is told.
  void ReadRest() {
    while (csv_.Next()) TakeRow(std::numeric_limits<std::int64_t>::max());
  }

  // nullptr when there is none.
  TrueReturn* Find(int ring, std::int64_t utime_us, std::uint16_t range, int return_index) {
    auto& rows = by_ring_.at(static_cast<std::size_t>(ring));
    const std::int64_t tolerance_us = kMatchTolerance.count();
    TrueReturn* best = nullptr;
    const auto rank = [&](const TrueReturn& row) { return std::tuple(row.return_index != return_index, std::abs(row.utime_us - utime_us)); };
    for (auto row = std::ranges::lower_bound(rows, utime_us - tolerance_us, {}, &TrueReturn::utime_us);
         row != rows.end() && row->utime_us <= utime_us + tolerance_us; ++row) {
      if (row->is_taken || row->range != range) continue;
      if (best == nullptr || rank(*row) < rank(*best)) best = &*row;
    }
    return best;
  }

 private:
  static constexpr int kMaxRings = 128;
  static constexpr std::int64_t kMaxKept = std::int64_t{1} << 22;  // twice the cells that a scan may have

  void TakeRow(std::int64_t begin_us) {
    TrueReturn row;
    row.utime_us = csv_.WholeNumber(0, 0, std::numeric_limits<std::int64_t>::max());
    const auto ring = static_cast<std::size_t>(csv_.WholeNumber(1, 0, kMaxRings - 1));
    row.return_index = static_cast<int>(csv_.WholeNumber(2, 0, 1));
    row.range = RangeOf(csv_.Number(3));
    row.object = static_cast<std::int32_t>(csv_.WholeNumber(4, kOwnVesselObject, std::numeric_limits<std::int32_t>::max()));
    if (row.utime_us < last_us_) csv_.Refuse("utime_us goes back");
    last_us_ = row.utime_us;
    if (row.utime_us < begin_us) return;
    if (++num_kept_ > kMaxKept) csv_.Refuse("more than " + std::to_string(kMaxKept) + " returns within a scan");
    by_ring_[ring].push_back(row);
  }

  std::uint16_t RangeOf(double range_m) const {
    constexpr double kRounding = 0.01;  // of a step
    const double steps = range_m / vlp16::format::kRangeUnitM;
    const double whole = std::round(steps);
    if (std::abs(steps - whole) > kRounding || whole < 1.0 || whole > std::numeric_limits<std::uint16_t>::max()) {
      csv_.Refuse("range_m: not a range of the sensor, in steps of 2 mm: " + std::string(csv_.Text(3)));
    }
    return static_cast<std::uint16_t>(whole);
  }

  data::CsvFile csv_;
  std::int64_t num_kept_ = 0;
  std::int64_t last_us_ = std::numeric_limits<std::int64_t>::min();
  std::array<std::deque<TrueReturn>, kMaxRings> by_ring_;
};

// Things of the second world that stand on the ground; all else floats.
bool IsInWater(const std::string& type) {
  static const std::set<std::string> kOnTheGround{"shore", "island",     "land",       "dock",   "pier", "jetty", "wall",
                                                  "quay",  "canal_wall", "breakwater", "bridge", "tree", "rock"};
  return !kOnTheGround.contains(type);
}

// Gives a scan its truth.
void Join(const CaptureWithTruth& files, TruthFile& truth, LabelledScan& labelled, CaptureReport& report) {
  auto& scan = labelled.scan;
  const auto start_us = ToUtimeUs(scan.head.time);
  const auto num_returns = static_cast<std::size_t>(scan.head.num_returns);
  labelled.object.assign(scan.num_cells(), kNoTrueObject);
  constexpr std::int64_t kMarginUs = 1000;  // lasers of a column fire within 40 us
  truth.MoveTo(start_us - kMarginUs, ToUtimeUs(scan.head.end_time) + kMarginUs);
  for (std::size_t cell = 0; cell < scan.num_cells(); ++cell) {
    auto& range = scan.columns.range[cell];
    if (range == 0) continue;
    ++report.num_returns;
    const std::size_t ring = cell / num_returns % scan.head.rings.size();
    const std::size_t column = cell / num_returns / scan.head.rings.size();
    const std::int64_t time_ns = std::int64_t{scan.columns.time_ns[column]} + scan.head.rings[ring].time_offset_ns;
    const std::int64_t utime_us = start_us + static_cast<std::int64_t>(std::llround(static_cast<double>(time_ns) / 1000.0));
    auto* found = truth.Find(static_cast<int>(ring), utime_us, range, static_cast<int>(cell % num_returns));
    if (found == nullptr) {
      ++report.num_unmatched;
      continue;
    }
    found->is_taken = true;
    if (found->object == kOwnVesselObject) {
      range = 0;
      ++report.num_own_vessel;
      continue;
    }
    if (found->object != kNoTrueObject && !labelled.objects.contains(found->object)) {
      throw std::runtime_error(files.objects.string() + ": lacks object " + std::to_string(found->object) + " of " + files.truth.string());
    }
    labelled.object[cell] = found->object;
    report.num_clutter += found->object == kNoTrueObject ? 1 : 0;
  }
  ++report.num_scans;
}

}  // namespace

UnpackedCapture::UnpackedCapture(const fs::path& file) : memory_(fdopen(memfd_create("capture", MFD_CLOEXEC), "wb"), &std::fclose) {
  if (!memory_) throw std::runtime_error(file.string() + ": cannot be unpacked: no memory file");
  data::XzFile packed(file, kMaxCaptureBytes);
  std::vector<std::uint8_t> block(std::size_t{1} << 16);
  try {
    while (const std::size_t size = packed.Read(block)) {
      if (std::fwrite(block.data(), 1, size, memory_.get()) != size) throw std::runtime_error("cannot be unpacked: out of memory");
    }
    if (std::fflush(memory_.get()) != 0) throw std::runtime_error("cannot be unpacked: out of memory");
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

fs::path UnpackedCapture::path() const { return "/proc/self/fd/" + std::to_string(fileno(memory_.get())); }

std::map<std::int32_t, ScanObject> ReadObjectsOfCapture(const CaptureWithTruth& files) {
  constexpr std::size_t kMaxObjects = 100'000;
  data::CsvFile csv(files.objects, {"object_id", "type"});
  std::map<std::int32_t, ScanObject> objects;
  while (csv.Next()) {
    const auto id = static_cast<std::int32_t>(csv.WholeNumber(0, 1, std::numeric_limits<std::int32_t>::max()));
    const std::string type(csv.Text(1));
    if (type.empty()) csv.Refuse("type: empty");
    const auto [known, is_new] = objects.try_emplace(id, ScanObject{type + "_" + std::to_string(id), type, IsInWater(type)});
    if (objects.size() > kMaxObjects) csv.Refuse("more than " + std::to_string(kMaxObjects) + " objects");
    if (!is_new && known->second.kind != type) csv.Refuse("object " + std::to_string(id) + " was of type " + known->second.kind + " before");
  }
  return objects;
}

std::vector<CaptureWithTruth> ListCaptures(const fs::path& folder, CaptureTruth truth) {
  static const std::regex kName(R"((.+)-(\d+)\.pcap\.xz)");
  std::error_code fault;
  std::vector<CaptureWithTruth> captures;
  for (const auto& entry : fs::directory_iterator(folder, fault)) {
    const auto name = entry.path().filename().string();
    if (!name.ends_with(kCaptureEnding)) continue;
    CaptureWithTruth files;
    std::smatch parts;
    std::regex_match(name, parts, kName);
    const std::string seed = parts[2];  // empty without a match
    if (std::from_chars(seed.data(), seed.data() + seed.size(), files.seed).ec != std::errc()) {
      throw std::runtime_error(entry.path().string() + ": the name is not NAME-SEED" + std::string(kCaptureEnding));
    }
    files.scene = parts[1];
    files.capture = entry.path();
    files.truth = Beside(files.capture, ".truth.csv.xz");
    files.objects = Beside(files.capture, ".objects.csv.xz");
    for (const auto& file : {files.objects, files.truth}) {
      if (truth == CaptureTruth::kOfObjects && file == files.truth) continue;
      if (!fs::exists(file)) throw std::runtime_error(file.string() + ": is missing beside " + name);
    }
    captures.push_back(std::move(files));
  }
  if (fault) throw std::runtime_error(folder.string() + ": cannot be read: " + fault.message());
  std::ranges::sort(captures, {}, [](const CaptureWithTruth& one) { return std::tie(one.scene, one.seed); });
  return captures;
}

Boat LoadBoatOfCaptures(const fs::path& folder, const fs::path& config_folder) {
  if (!fs::exists(folder / "boat.txtpb")) return LoadBoat(config_folder);
  const auto file = config_folder / "segmenter.txtpb";
  const auto message = config::Load<config::Segmenter>(config_folder, "segmenter.txtpb");
  const auto facts = config::LoadBoat(folder);
  return {config_folder, facts, lidar::LoadParams(config_folder), segmenter::ToParams(message, facts, file)};
}

CaptureReport ReadCapture(const CaptureWithTruth& files, const Boat& boat, const ScanHandler& on_scan) {
  CaptureReport report;
  LabelledScan labelled;
  labelled.objects = ReadObjectsOfCapture(files);
  TruthFile truth(files.truth);

  // The labels of a scan do not depend on its clock; the truth is of the sensor's.
  auto params = boat.lidar.decoder;
  params.time = lidar::TimeChoice::kSensor;
  vlp16::Decoder decoder(
      params,
      [&](const lidar::Scan& scan) {
        io::ThrowIfStopAsked();
        if (scan.is_partial_start || scan.is_partial_end) return;
        labelled.scan = ToSegmenterScan(scan);
        Join(files, truth, labelled, report);
        on_scan(labelled);
      },
      [](const lidar::SentenceOfLidar&) {});

  const UnpackedCapture unpacked(files.capture);
  try {
    lidar::CaptureReader reader(unpacked.path());
    while (const auto datagram = reader.Next()) {
      if (datagram->destination_port == boat.lidar.data_port) decoder.OnDataPayload(datagram->host_time, datagram->payload);
      if (datagram->destination_port == boat.lidar.position_port) decoder.OnPositionPayload(datagram->host_time, datagram->payload);
    }
    if (reader.num_damaged() > 0) throw std::runtime_error(unpacked.path().string() + ": damaged: " + reader.damage());
  } catch (const std::runtime_error& error) {
    // The name of the memory tells nobody anything.
    std::string reason = error.what();
    const auto name = unpacked.path().string();
    if (reason.starts_with(name)) reason = files.capture.string() + reason.substr(name.size());
    throw std::runtime_error(reason);
  }
  decoder.Flush();
  truth.ReadRest();
  if (report.num_scans == 0) throw std::runtime_error(files.capture.string() + ": holds no whole scan of the lidar");
  if (static_cast<double>(report.num_unmatched) > kMaxUnmatchedShare * static_cast<double>(report.num_returns)) {
    throw std::runtime_error(files.truth.string() + ": does not belong to " + files.capture.string() + ": " + std::to_string(report.num_unmatched) +
                             " of " + std::to_string(report.num_returns) + " returns have no truth");
  }
  return report;
}

}  // namespace lookout::eval
