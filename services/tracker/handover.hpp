// State that one process of the tracker leaves to the next: its last ALERTS, and TRACKS that were acknowledged or have a name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

/// For KeptAcknowledgements and KeptNames.
struct Legacy {
  Utime time;  // end of its last scan
  Datum datum;
  std::vector<Alert> alerts;
  std::vector<Track> tracks;  // their places and velocities
  std::vector<std::pair<std::int64_t, std::string>> names;
};

/// @param tracks  those of the alerts
/// @return nullopt where they are not well-formed, or not of one scan
std::optional<Legacy> ToLegacy(const alerts_t& alerts, const tracks_t& tracks);

/// A file that is complete whenever a process is killed: an lcm-log of one ALERTS and one TRACKS. It stands in $RUNTIME_DIRECTORY, which the
/// supervisor (systemd, lookout-up) keeps from one start to the next; without one nothing is left and nothing found.
class Handover {
 public:
  explicit Handover(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Of this process.
  static Handover FromEnvironment();

  /// Of the process before; nullopt where there is none, or its file is damaged.
  std::optional<Legacy> Read();

  /// After each scan. Only acknowledged alerts and names are worth keeping: without any, the file is removed, but not before the alerts read from it
  /// had time to be raised again. Written when other alerts are acknowledged or others have names, else once a second: each time waits for the disk.
  /// On a full disk nothing is left, and the look-out goes on.
  void Write(const alerts_t& alerts, const tracks_t& tracks);

 private:
  std::filesystem::path File() const { return folder_ / "alerts.lcmlog"; }

  std::filesystem::path folder_;  // empty: none
  bool is_written_ = true;        // maybe, by the process before
  std::optional<Utime> keep_until_;
  std::optional<Utime> written_;
  std::vector<std::int64_t> written_ids_;
  std::vector<std::string> written_names_;
};

}  // namespace lookout::tracker
