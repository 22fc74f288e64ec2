// Writes bytes of events to files, in a thread of its own: a disk that stands still for seconds does not hold up the receiver.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::recorder {

/// The system calls of the writer; a test puts faults in their place.
struct Disk {
  std::function<ssize_t(int descriptor, const void* data, std::size_t size)> write;  // as write(2)
  std::function<int(int descriptor)> sync;                                           // as fdatasync(2)
  std::function<std::int64_t(const std::filesystem::path& folder)> free_bytes;       // -1 = not known
};

/// The system calls of the kernel.
Disk RealDisk();

struct DiskLimits {
  std::int64_t queue_bytes = 0;    // bytes of events that may wait for the disk; further events are lost
  std::int64_t reserve_bytes = 0;  // of the disk, which is left free
};

/// Counts of events, since the start.
struct DiskStatus {
  std::filesystem::path file = {};  // the file that is written, or was written last
  bool is_recording = false;
  bool is_waiting_for_file = false;       // a file was asked for and is not yet begun
  bool is_full = false;                   // not recording, for lack of room
  bool wants_new_file = false;            // recording goes on in a file that somebody moved, cut or wrote to, or that should have ended
  std::chrono::milliseconds standing{0};  // for how long the disk has not finished its last block; 0 while nothing waits
  std::string fault = {};                 // why events were lost last, or why the writer does not record
  std::int64_t num_events = 0;            // handed to the kernel
  std::int64_t num_bytes = 0;             // of these events, as in the files
  std::int64_t num_files = 0;
  std::int64_t num_faults = 0;           // of the disk
  std::int64_t num_disturbed = 0;        // files that somebody deleted, moved, cut or wrote to while they were recorded
  std::int64_t num_lost_fault = 0;       // events that the disk did not accept, or that were in a file that was deleted or cut
  std::int64_t num_lost_full = 0;        // events while there was no room
  std::int64_t num_lost_queue_full = 0;  // events, while the disk stood still
  std::int64_t num_lost_bytes = 0;       // of all lost events
  std::int64_t queue_bytes = 0;
  std::int64_t queue_peak_bytes = 0;
  std::int64_t free_bytes = -1;  // as seen last; -1 = not known

  std::int64_t num_lost() const { return num_lost_fault + num_lost_full + num_lost_queue_full; }
};

/// Files are written in blocks of complete events. A block that the disk does not take whole is cut off again, so that a log ends with a complete
/// event, and its file is closed; events until the next BeginFile are lost. The file is locked (flock). After each block and each sync the file is
/// checked: a deleted or cut file has lost its events; a file that has lost its name, or to which another program writes, is written on until the
/// next BeginFile. Each event is on the disk (fdatasync) at most 0.7 s after Append, unless the disk itself needs longer.
class DiskWriter {
 public:
  /// Starts the thread.
  /// @param folder  of the files; made anew when it is gone
  DiskWriter(std::filesystem::path folder, const DiskLimits& limits, Disk disk);

  /// Writes the waiting events, as far as the disk accepts them.
  ~DiskWriter();
  DiskWriter(const DiskWriter&) = delete;
  DiskWriter& operator=(const DiskWriter&) = delete;

  /// Later events go into a new file. Where none can be made, the file before is written on and wants_new_file is set; where there is none either, or
  /// no room, events are lost until the next call that succeeds; no empty file stays.
  ///
  /// @param stem         of its name; where that is taken "001", "002", ... is put behind it. No file is overwritten
  /// @param first_event  its bytes; not counted as lost with a file that cannot be begun
  void BeginFile(std::string stem, std::vector<std::uint8_t> first_event);

  /// @param event  the bytes of one event
  /// @return whether it waits for the disk; else it is lost and counted
  bool Append(Bytes event);

  /// Waits until all that was appended is on the disk, or lost.
  void Flush();

  DiskStatus Status() const;

 private:
  struct Block {
    std::string stem;  // not empty: begins a file
    std::vector<std::uint8_t> bytes;
    std::int64_t num_events = 0;
  };

  void Run();
  void WriteBlock(const Block& block);
  void AddMark(std::int64_t num_events);
  bool HasRoomFor(const Block& block);
  bool OpenFile(const std::string& stem);
  void CutTorn(std::int64_t torn_bytes, std::string& reason);
  bool SyncToDisk();
  void SyncFile();
  void CheckFile(const Block* last_block);
  void Disturb(const std::string& reason);
  void CloseFile();
  void Fail(const std::string& reason);  // mutex_ is held

  const std::filesystem::path folder_;
  const DiskLimits limits_;
  const Disk disk_;

  mutable std::mutex mutex_;  // guards the members from wake_ to num_flushes_done_
  std::condition_variable wake_;
  std::condition_variable done_;
  std::deque<Block> queue_;
  DiskStatus status_;
  bool is_stopping_ = false;
  std::optional<std::chrono::steady_clock::time_point> given_;  // when the disk was given its unfinished block
  std::int64_t num_flushes_wanted_ = 0;
  std::int64_t num_flushes_done_ = 0;

  // Members that the thread alone uses.
  int descriptor_ = -1;
  // The end of a block in the file, and the events up to there.
  struct Mark {
    std::int64_t end_bytes = 0;
    std::int64_t num_events = 0;
  };
  std::filesystem::path file_;
  std::int64_t file_bytes_ = 0;
  std::vector<Mark> marks_;  // of the file
  bool is_disturbed_ = false;
  bool can_tell_name_ = false;     // the file system can tell whether a name leads to the open file
  std::int64_t num_unsynced_ = 0;  // events that the kernel has and the disk may not
  std::int64_t unsynced_bytes_ = 0;
  std::chrono::steady_clock::time_point last_sync_;

  std::thread thread_;  // last, so that the thread begins when all other members are there
};

}  // namespace lookout::recorder
