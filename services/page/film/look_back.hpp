// The last minutes of a live bus: out of the recorder's growing log where there is one, else out of a spool on the disk.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "common/io/disk_reserve.hpp"
#include "services/page/core/recordings.hpp"

namespace lookout::page {

struct LookBackOptions {
  std::filesystem::path spool_folder;                             // of this process alone; made where missing
  std::optional<std::filesystem::path> recorder_folder = {};      // log_folder of recorder.txtpb
  std::chrono::seconds span = std::chrono::minutes(10);           // how far a page can look back
  std::int64_t max_bytes = std::int64_t{2} * 1024 * 1024 * 1024;  // of the spool
  io::DiskReserve reserve{0};                                     // of the spool's disk; see ReserveAt
  std::function<std::int64_t(const std::filesystem::path& folder)> free_bytes = io::FreeBytes;
  std::int64_t queue_bytes = std::int64_t{8} * 1024 * 1024;  // that may wait for the disk
  std::string boat_text = "null";                            // BoatText: `boat` of the source
  std::function<void()> on_sources = {};                     // called on its thread, at most once a second
  std::function<void(const std::string& line)> tell = {};    // for people; on its thread
};

/// Counts since the start.
struct LookBackStatus {
  bool is_following = false;  // the recorder's log; else the spool is written
  std::string fault = {};     // why the spool is not written; empty when the spool is written or is not needed
  std::string shortage = {};  // why the spool holds less than the span; empty when it holds the whole span, or is not needed
  std::int64_t num_spooled = 0;
  std::int64_t num_spooled_bytes = 0;
  std::int64_t num_lost = 0;  // messages that the spool lacks: the disk was too slow, full or failed
};

/// Source 0, growing. The spool is a log for each minute, SPOOL/look-back-N.lcmlog.partial: never committed, so never synced, and gone with the
/// process; the next start removes the files of a killed process. Once a second the recorder's folder is looked at: when its newest log grows, that
/// log is followed and no spool is written; when the log has not grown for 5 s, the spool is written again. The spool leaves the reserve of the disk
/// free: where less is left the spool gives up its oldest minutes, and below kLeastBytes ends.
class LookBack final : public Recordings {
 public:
  /// Starts its thread.
  /// @throws std::runtime_error when the folder of the spool cannot be made
  explicit LookBack(LookBackOptions options);

  /// A smaller spool would hold no more than some seconds.
  static constexpr std::int64_t kLeastBytes = 10'000'000;

  /// Removes the spool.
  ~LookBack() override;
  LookBack(const LookBack&) = delete;
  LookBack& operator=(const LookBack&) = delete;

  /// Whether Append keeps messages of the channel: all that a page shows.
  static bool IsKept(std::string_view channel);

  /// A message came. Any one thread; returns at once.
  /// @param time  of reception
  void Append(Utime time, std::string_view channel, Bytes message);

  LookBackStatus Status() const;

  std::string SourcesText() override;
  Answer Find(const At& request) override;
  Answer Find(const Range& request) override;
  std::string Strip(const StripRequest& request) override;

  /// Waits until all that was appended can be found, or is lost.
  void Flush();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lookout::page
