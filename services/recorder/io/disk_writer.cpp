#include "services/recorder/io/disk_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <system_error>
#include <utility>

#include "common/io/disk_reserve.hpp"
#include "common/io/output_file.hpp"

namespace lookout::recorder {

namespace {

using io::ErrnoText;
using io::IsNameOf;

// Waiting blocks go to the kernel so often: with the time of a sync below the promised second.
constexpr std::chrono::milliseconds kWritePeriod(100);
constexpr std::chrono::milliseconds kSyncPeriod(500);
// Events are gathered in blocks of this size; one full block wakes the thread early.
constexpr std::size_t kBlockBytes = 1024 * 1024;
// Marks of a file, one for each 0.1 s at first. When there are more, every second mark is dropped, so that the distance of marks stays a share of the
// file.
constexpr std::size_t kMaxMarks = 4096;

std::string Megabytes(std::int64_t size_bytes) { return std::to_string(size_bytes / 1'000'000) + " MB"; }

// "1234 events, 17.2 MB"
std::string AmountText(std::int64_t num_events, std::int64_t num_bytes) {
  const auto tenths = (num_bytes + 50'000) / 100'000;
  return std::to_string(num_events) + " events, " + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " MB";
}

constexpr const char* kAdvice = "begin a new log (SIGHUP) before the old one is moved, deleted or changed";

}  // namespace

Disk RealDisk() {
  Disk disk;
  disk.write = [](int descriptor, const void* data, std::size_t size) { return ::write(descriptor, data, size); };
  disk.sync = [](int descriptor) { return ::fdatasync(descriptor); };
  disk.free_bytes = io::FreeBytes;
  return disk;
}

DiskWriter::DiskWriter(std::filesystem::path folder, const DiskLimits& limits, Disk disk)
    : folder_(std::move(folder)), limits_(limits), disk_(std::move(disk)), thread_([this] { Run(); }) {}

DiskWriter::~DiskWriter() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void DiskWriter::BeginFile(std::string stem, std::vector<std::uint8_t> first_event) {
  const std::lock_guard lock(mutex_);
  status_.is_waiting_for_file = true;
  status_.queue_bytes += static_cast<std::int64_t>(first_event.size());
  queue_.push_back({std::move(stem), std::move(first_event), 1});
}

bool DiskWriter::Append(Bytes event) {
  bool is_block_full = false;
  const auto size_bytes = static_cast<std::int64_t>(event.size());
  {
    const std::lock_guard lock(mutex_);
    if (!status_.is_recording && !status_.is_waiting_for_file) {
      ++(status_.is_full ? status_.num_lost_full : status_.num_lost_fault);
      status_.num_lost_bytes += size_bytes;
      return false;
    }
    if (status_.queue_bytes + size_bytes > limits_.queue_bytes) {
      ++status_.num_lost_queue_full;
      status_.num_lost_bytes += size_bytes;
      status_.fault = "the disk stood still for so long that the queue of " + Megabytes(limits_.queue_bytes) + " was full";
      return false;
    }
    if (queue_.empty() || !queue_.back().stem.empty() || queue_.back().bytes.size() + event.size() > kBlockBytes) {
      queue_.emplace_back().bytes.reserve(kBlockBytes);
      is_block_full = queue_.size() > 1;
    }
    auto& block = queue_.back();
    block.bytes.insert(block.bytes.end(), event.begin(), event.end());
    ++block.num_events;
    status_.queue_bytes += size_bytes;
    status_.queue_peak_bytes = std::max(status_.queue_peak_bytes, status_.queue_bytes);
  }
  if (is_block_full) wake_.notify_one();
  return true;
}

void DiskWriter::Flush() {
  std::unique_lock lock(mutex_);
  const auto number = ++num_flushes_wanted_;
  wake_.notify_one();
  done_.wait(lock, [&] { return num_flushes_done_ >= number; });
}

DiskStatus DiskWriter::Status() const {
  const std::lock_guard lock(mutex_);
  auto status = status_;
  if (given_) status.standing = std::chrono::floor<std::chrono::milliseconds>(std::chrono::steady_clock::now() - *given_);
  return status;
}

void DiskWriter::Run() {
  for (bool is_last = false; !is_last;) {
    std::deque<Block> blocks;
    std::int64_t num_flushes = 0;
    bool must_sync = false;
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, kWritePeriod, [this] { return is_stopping_ || num_flushes_wanted_ > num_flushes_done_ || queue_.size() > 1; });
      blocks.swap(queue_);
      num_flushes = num_flushes_wanted_;
      is_last = is_stopping_;
      must_sync = is_last || num_flushes > num_flushes_done_;
      given_ = std::chrono::steady_clock::now();
    }
    // Taken from the front, so that memory goes with the queue.
    for (; !blocks.empty(); blocks.pop_front()) {
      WriteBlock(blocks.front());
      const std::lock_guard lock(mutex_);
      status_.queue_bytes -= static_cast<std::int64_t>(blocks.front().bytes.size());
      given_ = std::chrono::steady_clock::now();
    }
    if (must_sync || std::chrono::steady_clock::now() - last_sync_ >= kSyncPeriod) SyncFile();
    if (is_last) CloseFile();
    const std::lock_guard lock(mutex_);
    given_.reset();
    num_flushes_done_ = num_flushes;
    done_.notify_all();
  }
}

void DiskWriter::WriteBlock(const Block& block) {
  const bool begins = !block.stem.empty();
  if (begins) {
    SyncFile();  // and checks the file before the new file takes a name that may be the old one's
    std::error_code ignored;
    std::filesystem::create_directories(folder_, ignored);  // open() tells the fault; room is looked for on the right disk
  }
  if (HasRoomFor(block)) {
    if (begins && !OpenFile(block.stem)) return;
    std::size_t num_written = 0;
    while (descriptor_ >= 0 && num_written < block.bytes.size()) {
      const auto result = disk_.write(descriptor_, block.bytes.data() + num_written, block.bytes.size() - num_written);
      if (result > 0) {
        num_written += static_cast<std::size_t>(result);
      } else if (result == 0 || errno != EINTR) {
        std::string reason = "write failed: " + (result == 0 ? "nothing is taken" : ErrnoText());
        CutTorn(static_cast<std::int64_t>(num_written), reason);
        if (!SyncToDisk()) break;
        const std::lock_guard lock(mutex_);
        Fail(reason);
      }
    }
  }
  const auto size_bytes = static_cast<std::int64_t>(block.bytes.size());
  const bool is_written = descriptor_ >= 0;
  {
    const std::lock_guard lock(mutex_);
    if (begins) status_.is_waiting_for_file = false;
    if (is_written) {
      status_.num_events += block.num_events;
      status_.num_bytes += size_bytes;
    } else if (!begins) {
      (status_.is_full ? status_.num_lost_full : status_.num_lost_fault) += block.num_events;
      status_.num_lost_bytes += size_bytes;
    }
  }
  if (!is_written) return;
  file_bytes_ += size_bytes;
  num_unsynced_ += block.num_events;
  unsynced_bytes_ += size_bytes;
  AddMark(block.num_events);
  CheckFile(&block);
}

void DiskWriter::AddMark(std::int64_t num_events) {
  if (marks_.size() >= kMaxMarks) {  // one mark more than kMaxMarks where somebody cut off bytes that another program had written
    std::size_t num_kept = 0;
    for (auto i = (marks_.size() + 1) % 2; i < marks_.size(); i += 2) marks_[num_kept++] = marks_[i];  // the last mark stays
    marks_.resize(num_kept);
  }
  marks_.push_back({file_bytes_, (marks_.empty() ? 0 : marks_.back().num_events) + num_events});
}

bool DiskWriter::HasRoomFor(const Block& block) {
  if (block.stem.empty() && descriptor_ < 0) return false;
  const auto free_bytes = disk_.free_bytes(folder_);
  bool was_full = false;
  {
    const std::lock_guard lock(mutex_);
    status_.free_bytes = free_bytes;
    was_full = status_.is_full;
  }
  if (free_bytes < 0) return true;  // the write tells the fault
  const io::DiskReserve reserve(limits_.reserve_bytes);
  const auto needed_bytes = was_full ? reserve.bytes_to_go_on() : reserve.bytes();
  if (free_bytes - static_cast<std::int64_t>(block.bytes.size()) >= needed_bytes) return true;
  CloseFile();
  const std::lock_guard lock(mutex_);
  status_.is_full = true;
  status_.is_recording = false;
  status_.fault = folder_.string() + ": " + reserve.Text(free_bytes) + "; move or delete logs";
  return false;
}

// Opens a new file, and then closes the file before. @return false: no file could be made, and the file before is written on
bool DiskWriter::OpenFile(const std::string& stem) {
  auto file = folder_ / (stem + ".lcmlog");
  int made = -1;
  // The file is opened for appending, so that a file that somebody cuts goes on at its end, without a hole. Two recorders that start in the same
  // second get different files. Names differ by digits, as digits sort behind the dot of a name without them, in any locale.
  for (int i = 1; (made = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644)) < 0 && errno == EEXIST; ++i) {
    auto number = std::to_string(i);
    number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
    file = folder_ / (stem + number.append(".lcmlog"));
  }
  if (made < 0) {
    const std::string reason = "cannot be made: " + ErrnoText();
    const std::lock_guard lock(mutex_);
    if (descriptor_ < 0) {
      status_.file = file;
      Fail(reason);
      return true;
    }
    status_.fault = file.string() + ": " + reason + "; " + file_.string() + " is written on";
    status_.wants_new_file = true;
    status_.is_waiting_for_file = false;
    ++status_.num_faults;
    return false;
  }
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = made;
  flock(descriptor_, LOCK_EX | LOCK_NB);  // nobody else can hold it: the file is new
  file_ = file;
  file_bytes_ = 0;
  marks_.clear();
  marks_.reserve(kMaxMarks);
  is_disturbed_ = false;
  // A file system that gives an open file another number than its name has (some on networks) cannot tell a file that was moved.
  can_tell_name_ = IsNameOf(file_, descriptor_);
  num_unsynced_ = 0;
  unsynced_bytes_ = 0;
  {
    const std::lock_guard lock(mutex_);
    status_.file = file;
    status_.is_recording = true;
    status_.is_full = false;
    status_.wants_new_file = false;
    ++status_.num_files;
  }
  io::SyncName(file_);
  return true;
}

// A torn event is cut off: the log ends with a complete event. If somebody has cut the file as well it is not made longer, and the loss is counted.
// @param torn_bytes  of the last block, that were taken
void DiskWriter::CutTorn(std::int64_t torn_bytes, std::string& reason) {
  struct stat own {};
  const bool is_known = fstat(descriptor_, &own) == 0;
  const auto end_bytes = is_known ? std::clamp<std::int64_t>(own.st_size - torn_bytes, 0, file_bytes_) : file_bytes_;
  if (ftruncate(descriptor_, end_bytes) != 0) {
    reason += "; its last event is torn";
    return;
  }
  CheckFile(nullptr);
}

// @return whether the file is still open
bool DiskWriter::SyncToDisk() {
  last_sync_ = std::chrono::steady_clock::now();
  if (descriptor_ < 0) return false;
  const auto num_unsynced = std::exchange(num_unsynced_, 0);
  const auto unsynced_bytes = std::exchange(unsynced_bytes_, 0);
  if (num_unsynced == 0 || disk_.sync(descriptor_) == 0) return true;
  const std::string reason = "not on the disk: " + ErrnoText();
  const std::lock_guard lock(mutex_);
  status_.num_lost_fault += num_unsynced;  // some may be there; nobody knows which
  status_.num_events -= num_unsynced;
  status_.num_lost_bytes += unsynced_bytes;
  status_.num_bytes -= unsynced_bytes;
  Fail(reason);
  return false;
}

void DiskWriter::SyncFile() {
  if (SyncToDisk()) CheckFile(nullptr);
}

// @param last_block  written since the last look; nullptr: none
void DiskWriter::CheckFile(const Block* last_block) {
  struct stat own {};
  if (descriptor_ < 0 || fstat(descriptor_, &own) != 0) return;
  struct stat named {};
  const bool is_name_there = lstat(file_.c_str(), &named) == 0;
  const std::int64_t size_bytes = own.st_nlink == 0 ? 0 : own.st_size;
  if (size_bytes < file_bytes_) {
    // Cut to `kept_bytes`, behind which the later bytes stand.
    const auto last_bytes = last_block == nullptr ? 0 : static_cast<std::int64_t>(last_block->bytes.size());
    const bool has_last = last_block != nullptr && size_bytes >= last_bytes;
    const auto kept_bytes = size_bytes - (has_last ? last_bytes : 0);
    const auto total = marks_.back().num_events;
    const auto cut = std::ranges::upper_bound(marks_, kept_bytes, {}, &Mark::end_bytes);
    const auto num_kept = (cut == marks_.begin() ? 0 : std::prev(cut)->num_events) + (has_last ? last_block->num_events : 0);
    marks_.erase(cut, marks_.end());
    marks_.push_back({size_bytes, num_kept});
    const auto num_lost = total - num_kept;
    num_unsynced_ = std::min(num_unsynced_, num_kept);
    unsynced_bytes_ = std::min(unsynced_bytes_, size_bytes);
    auto num_lost_bytes = file_bytes_ - size_bytes;
    const auto old_bytes = std::exchange(file_bytes_, size_bytes);
    {
      const std::lock_guard lock(mutex_);
      num_lost_bytes = std::min(num_lost_bytes, status_.num_bytes);  // bytes of another program were never counted
      status_.num_lost_fault += num_lost;
      status_.num_events -= num_lost;
      status_.num_bytes -= num_lost_bytes;
      status_.num_lost_bytes += num_lost_bytes;
    }
    const std::string lost = AmountText(num_lost, num_lost_bytes) + " are lost; " + kAdvice;
    if (own.st_nlink > 0)
      return Disturb("was cut from " + std::to_string(old_bytes) + " to " + std::to_string(kept_bytes) + " bytes while it was recorded: " + lost);
    num_unsynced_ = 0;
    unsynced_bytes_ = 0;
    file_bytes_ = old_bytes;  // another file may have this name by now: nothing is removed
    const std::lock_guard lock(mutex_);
    ++status_.num_disturbed;
    Fail((is_name_there ? "was replaced by another file while it was recorded: " : "was deleted while it was recorded: ") + lost);
    return;
  }
  if (size_bytes > file_bytes_) {
    const auto num_foreign_bytes = size_bytes - std::exchange(file_bytes_, size_bytes);
    return Disturb("another program has written " + std::to_string(num_foreign_bytes) + " bytes to it; " + kAdvice);
  }
  if (can_tell_name_ && !is_disturbed_ && !IsNameOf(file_, descriptor_)) {
    Disturb(std::string("was moved or renamed") + (is_name_there ? ", and another file stands in its place" : "") +
            ": what was recorded is in it, wherever it is; " + kAdvice);
  }
}

// Nothing more is lost: the file is written on until the next one is begun.
void DiskWriter::Disturb(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  status_.fault = file_.string() + ": " + reason;
  if (!std::exchange(is_disturbed_, true)) ++status_.num_disturbed;
  status_.wants_new_file = true;
}

void DiskWriter::CloseFile() {
  if (descriptor_ < 0) return;
  SyncFile();
  if (descriptor_ < 0) return;
  close(descriptor_);
  descriptor_ = -1;
}

void DiskWriter::Fail(const std::string& reason) {
  if (descriptor_ >= 0) {
    // On a full disk there would be one more empty file with each attempt.
    if (file_bytes_ == 0 && (!can_tell_name_ || IsNameOf(status_.file, descriptor_))) {
      std::error_code ignored;
      std::filesystem::remove(status_.file, ignored);
      --status_.num_files;
    }
    close(descriptor_);
    descriptor_ = -1;
  }
  status_.is_recording = false;
  status_.is_full = false;
  status_.wants_new_file = false;
  status_.fault = status_.file.string() + ": " + reason;
  ++status_.num_faults;
}

}  // namespace lookout::recorder
