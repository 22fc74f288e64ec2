// UDP datagrams out of a capture file: classic pcap (microseconds or nanoseconds) or pcapng, also packed by gzip.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "common/io/unpacked_file.hpp"
#include "services/lidar/io/frame.hpp"
#include "services/lidar/io/pcapng.hpp"

namespace lookout::lidar {

struct Datagram {
  Utime host_time;             // stamp in the capture; some captures count from 0
  std::string source_address;  // numeric
  int source_port = 0;
  std::string destination_address;  // numeric
  int destination_port = 0;
  std::vector<std::uint8_t> payload;
};

class CaptureReader {
 public:
  /// @throws std::runtime_error naming the file when it cannot be opened, is no file (a pipe would hold the caller), is no capture (the text says
  ///         what it is, and what to do), or is of link types of which none is understood (named too). A capture without packets is valid.
  explicit CaptureReader(const std::filesystem::path& file);

  /// @param max_frames  to look at in this call
  /// @return the next datagram, in the order of the file; nullopt at the end, and after max_frames: is_at_end() tells which. Frames without a
  ///         whole UDP datagram are skipped and counted. Where the file is damaged reading ends: see num_damaged().
  std::optional<Datagram> Next(std::int64_t max_frames = std::numeric_limits<std::int64_t>::max());

  bool is_at_end() const { return is_at_end_; }

  /// Bytes of the file that were read, as it lies there.
  std::int64_t position_bytes() const;

  std::int64_t num_frames() const { return frames_.num_frames(); }        // read so far
  std::int64_t num_datagrams() const { return frames_.num_datagrams(); }  // returned so far; 0 at the end with num_frames() above 0: all were refused
  std::int64_t num_damaged() const { return damage_.empty() ? 0 : 1; }
  const std::string& damage() const { return damage_; }  // the damage, and after how many frames; empty = none

  /// frames_read, frames_datagram, then skipped frames by reason.
  std::vector<Counter> counters() const;

 private:
  void OpenPcap(const std::filesystem::path& file, bool is_packed);
  void OpenPcapng(const std::filesystem::path& file);
  std::optional<CapturedFrame> NextFrame();

  // Either `pcapng_` or `capture_` reads the file; libpcap reads a packed file through `packed_`.
  std::unique_ptr<PcapngReader> pcapng_;
  std::unique_ptr<io::UnpackedFile> packed_;
  CaptureHandle capture_;
  int link_type_ = 0;
  bool is_at_end_ = false;
  FrameCounts frames_;
  FragmentJoiner fragments_;
  std::string damage_;
};

}  // namespace lookout::lidar
