// One turn with its labels and segments, out of the messages of LIDAR_SCAN and SEGMENTS.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/segment_t.hpp"
#include "tools/export/scan_joiner.hpp"
#include "tools/export/sink.hpp"
#include "tools/export/turn_picker.hpp"

namespace lookout::exporter {

class LabelledTurn {
 public:
  /// @param seq  number of the wanted turn; nullopt = the last whole one
  explicit LabelledTurn(std::optional<std::int64_t> seq);
  LabelledTurn(const LabelledTurn&) = delete;
  LabelledTurn& operator=(const LabelledTurn&) = delete;

  /// Takes a message of LIDAR_SCAN or SEGMENTS.
  Taken Take(std::string_view channel, Bytes bytes);
  void Finish();
  bool IsDone() const { return picker_.IsDone(); }

  const std::vector<LabelledScan>& parts() const { return picker_.parts(); }
  /// Precondition: parts() is not empty.
  const TurnPlace& place() const { return picker_.place(); }
  /// Time of the turn that was seen last.
  std::int64_t latest_utime_us() const { return latest_utime_us_; }
  /// Segments of the chosen turn, of all its parts.
  std::vector<segment_t> Segments() const;

 private:
  struct FurtherSegments {
    std::int64_t utime_us;
    std::int64_t seq;
    std::vector<segment_t> segments;
  };

  TurnPicker<LabelledScan> picker_;
  std::int64_t latest_utime_us_ = 0;
  std::vector<FurtherSegments> further_;  // parts of SEGMENTS without columns, of the chosen turn and the latest ones
  ScanJoiner joiner_;
};

}  // namespace lookout::exporter
