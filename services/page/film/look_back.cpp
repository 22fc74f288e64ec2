#include "services/page/film/look_back.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "services/page/core/replies.hpp"
#include "services/page/film/log_indexer.hpp"
#include "services/page/film/recording.hpp"
#include "services/page/film/source_text.hpp"
#include "services/page/film/spool.hpp"
#include "services/page/film/strip.hpp"

namespace lookout::page {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPeriod(200);
constexpr int kPeriodsOfALook = 5;   // at the recorder's folder: once a second
constexpr int kLooksUntilStill = 5;  // a log that has not grown so often is not being recorded
constexpr std::int64_t kFollowedBytes = 8 * 1024 * 1024;
constexpr std::int64_t kFilesOfTheSpool = 10;
constexpr int kRetryPeriods = 50;  // 10 s after a fault of the disk
constexpr const char* kNoSuchSource = "no such source";

// The recorder's logs, in their order.
std::vector<fs::path> LogsIn(const fs::path& folder) {
  std::vector<fs::path> logs;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".lcmlog" && entry.is_regular_file(error)) logs.push_back(entry.path());
  }
  std::ranges::sort(logs);
  return logs;
}

}  // namespace

struct LookBack::Implementation {
  explicit Implementation(LookBackOptions some_options) : options(std::move(some_options)), spool(options.spool_folder) {
    UpdateSourcesText();
    thread = std::thread([this] { Run(); });
  }

  ~Implementation() {
    {
      const std::scoped_lock lock(queue_mutex);
      is_stopping = true;
    }
    wake.notify_all();
    thread.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  // ---- the thread
  void Run() {
    std::unique_lock lock(queue_mutex);
    while (!is_stopping) {
      const bool is_asked = wake.wait_for(lock, kPeriod, [this] { return is_stopping || num_flushes_wanted > num_flushes_done; });
      const auto num_wanted = num_flushes_wanted;
      auto messages = std::exchange(queue, {});
      queue_bytes = 0;
      lock.unlock();
      try {
        if (!is_following) WriteToSpool(messages);
        if (!is_asked) OnPeriod();
        if (is_following) Follow();
        Trim();
        UpdateSourcesText();
        SetFault({});
      } catch (const std::exception& error) {
        SetFault(error.what());
      }
      lock.lock();
      num_flushes_done = num_wanted;
      flushed.notify_all();
    }
  }

  void OnPeriod() {
    if (retry_periods > 0) --retry_periods;
    if (++num_periods % kPeriodsOfALook != 0) return;
    if (options.recorder_folder) LookAtRecorder();
    std::optional<Utime> end;
    {
      const std::scoped_lock lock(mutex);
      recording.CloseRemoved();
      if (!recording.timeline().is_empty()) end = recording.timeline().end();
    }
    if (std::exchange(end_told, end) != end && options.on_sources) options.on_sources();
  }

  // The room that the disk's reserve leaves to the spool, and why it is too little. Where the room is not known, writing will fail.
  std::string TakeRoom() {
    const auto free_bytes = options.free_bytes(options.spool_folder);
    room_bytes = options.max_bytes;
    if (free_bytes < 0) return {};
    room_bytes = std::min(options.max_bytes, options.reserve.BytesForOthers(free_bytes, spool.num_bytes()));
    room_text = options.spool_folder.string() + ": " + options.reserve.Text(free_bytes) + "; move or delete logs";
    return room_bytes < std::min(options.max_bytes, kLeastBytes) ? room_text : std::string();
  }

  void StopSpool(const std::string& fault, std::size_t num_lost) {
    if (retry_periods == 0) retry_periods = kRetryPeriods;
    if (!std::exchange(is_stop_told, true)) Tell("the spool of the last minutes is not written: " + fault);
    const std::scoped_lock lock(status_mutex);
    status.num_lost += static_cast<std::int64_t>(num_lost);
    status.fault = fault;
    status.shortage.clear();
  }

  // Spooled files go back to the disk, and out of the picture: nobody can read them any more.
  void GiveUpSpool() {
    if (spool.num_files() == 0) return;
    ClearSpool();
    const std::scoped_lock lock(mutex);
    recording = Recording();
  }

  void ClearSpool() {
    spool.Clear();
    spool_indexer.reset();
    spool_file.clear();
    spool_numbers.clear();
  }

  void WriteToSpool(const std::vector<SpooledMessage>& messages) {
    if (messages.empty()) return;
    if (const auto why = TakeRoom(); !why.empty()) {
      GiveUpSpool();
      return StopSpool(why, messages.size());
    }
    if (retry_periods > 0 || !spool.Write(messages, room_bytes / kFilesOfTheSpool)) return StopSpool(FaultNow(), messages.size());
    std::int64_t num_bytes = 0;
    for (const auto& message : messages) num_bytes += static_cast<std::int64_t>(message.bytes.size());
    if (spool.file() != spool_file) {
      spool_indexer.emplace(spool.file(), true);
      const std::scoped_lock lock(mutex);
      spool_number = recording.AddLog(spool.file());
      spool_numbers[spool.file()] = spool_number;
      spool_file = spool.file();
    }
    ReadOn(*spool_indexer, spool_number);
    const std::scoped_lock lock(status_mutex);
    status.num_spooled += static_cast<std::int64_t>(messages.size());
    status.num_spooled_bytes += num_bytes;
    status.fault.clear();
    is_stop_told = false;
    if (room_bytes >= options.max_bytes) status.shortage.clear();
  }

  // While it is not tried again the reason stays.
  std::string FaultNow() const {
    const std::scoped_lock lock(status_mutex);
    return retry_periods > 0 && !status.fault.empty() ? status.fault : spool.fault();
  }

  // @return when the log is read as far as it goes
  void ReadOn(LogIndexer& indexer, std::uint16_t number) {
    bool goes_on = true;
    while (goes_on && !is_stopping) {
      LogPart part;
      goes_on = indexer.Read(kFollowedBytes, part);
      const std::scoped_lock lock(mutex);
      recording.Append(number, part);
      if (!recording.timeline().is_empty()) recording.DropBefore(recording.timeline().end() - options.span);
    }
  }

  void LookAtRecorder() {
    const auto logs = LogsIn(*options.recorder_folder);
    std::error_code error;
    const auto newest = logs.empty() ? fs::path() : logs.back();
    const auto size = logs.empty() ? 0 : fs::file_size(newest, error);
    const bool has_grown = has_looked && !logs.empty() && (newest != seen_log || size > seen_size);
    seen_log = newest;
    seen_size = size;
    has_looked = true;
    num_still = has_grown ? 0 : num_still + 1;
    if (has_grown && !is_following) BeginFollowing(logs);
    if (is_following && num_still >= kLooksUntilStill) StopFollowing();
  }

  void BeginFollowing(const std::vector<fs::path>& logs) {
    std::error_code error;
    const auto newest = fs::last_write_time(logs.back(), error);
    to_follow.clear();
    for (const auto& log : logs) {
      if (newest - fs::last_write_time(log, error) <= options.span) to_follow.push_back(log);
    }
    followed.reset();
    ClearSpool();
    is_following = true;
    {
      const std::scoped_lock lock(status_mutex);
      status.fault.clear();  // the spool is not needed any more
      status.shortage.clear();
    }
    const std::scoped_lock lock(mutex);
    recording = Recording();  // the recorder's log holds the messages of the spool
  }

  // Entries that were read stay; the spool goes on.
  void StopFollowing() {
    followed.reset();
    is_following = false;
  }

  // The first log to follow. A log that cannot be opened (it was removed meanwhile, or is not readable) is left out.
  bool OpenNext() try {
    followed.emplace(to_follow.front(), true);
    followed_file = to_follow.front();
    const std::scoped_lock lock(mutex);
    followed_number = recording.AddLog(followed_file);
    return true;
  } catch (const std::exception& error) {
    Tell(to_follow.front().string() + " is not followed: " + error.what());
    followed.reset();
    to_follow.erase(to_follow.begin());
    return false;
  }

  void Follow() {
    while (!is_stopping) {
      std::error_code error;
      if (!followed) {
        if (to_follow.empty()) return StopFollowing();
        if (!OpenNext()) continue;
      }
      const auto size = fs::file_size(followed_file, error);
      if (error || std::cmp_less(size, followed->position_bytes())) {
        Tell(followed_file.string() + " was taken away or cut while it was followed");
        return StopFollowing();
      }
      ReadOn(*followed, followed_number);
      for (const auto& log : LogsIn(*options.recorder_folder)) {
        if (log > to_follow.back()) to_follow.push_back(log);
      }
      if (to_follow.size() == 1) return;
      ReadOn(*followed, followed_number);  // entries written before the next was begun
      to_follow.erase(to_follow.begin());
      followed.reset();
    }
  }

  void Trim() {
    const std::scoped_lock lock(mutex);
    if (recording.timeline().is_empty()) return;
    auto from = recording.timeline().end() - options.span;
    while (spool.num_files() > 1) {
      const bool is_too_large = spool.num_bytes() > room_bytes;
      // `last` is the time that is shown: where the host's clock was set back, the file was written earlier. While the recording has a file open, the
      // file's bytes stay on the disk.
      const auto number = spool_numbers.find(spool.oldest_file());
      const auto last = number == spool_numbers.end() ? std::nullopt : recording.LastOf(number->second);
      if (!is_too_large && last && *last >= from) break;
      if (is_too_large && last && *last >= from && room_bytes < options.max_bytes) TellShortage();
      if (is_too_large && last) from = std::max(from, *last + std::chrono::microseconds(1));
      if (number != spool_numbers.end()) spool_numbers.erase(number);
      spool.DropOldest();
    }
    recording.DropBefore(from);
    // Whole files are dropped, so the spool may be short by less than a file.
    if (recording.timeline().is_empty() || 10 * (recording.timeline().end() - recording.timeline().begin()) < 9 * options.span) return;
    const std::scoped_lock status_lock(status_mutex);
    status.shortage.clear();  // the spool holds the whole span again
  }

  void TellShortage() {
    const std::scoped_lock lock(status_mutex);
    status.shortage = room_text;
  }

  void UpdateSourcesText() {
    const SourceFacts facts{.id = 0, .name = "live", .is_growing = true, .is_indexed = true, .boat_text = options.boat_text};
    std::string text;
    {
      const std::scoped_lock lock(mutex);
      text = SourcesTextOf({{facts, &recording.timeline()}});
    }
    const std::scoped_lock lock(status_mutex);
    sources_text = std::move(text);
  }

  // Keeps the fault of the thread's work, and reports it when it changes.
  void SetFault(const std::string& fault) {
    {
      const std::scoped_lock lock(status_mutex);
      if (fault == turn_fault) return;
      turn_fault = fault;
    }
    if (!fault.empty()) Tell(fault);
  }

  void Tell(const std::string& line) const {
    if (options.tell) options.tell(line);
  }

  template <typename Asked>
  Answer Find(const Asked& request) {
    const std::scoped_lock lock(mutex);
    if (request.source == 0) return recording.Find(request);
    Answer answer;
    answer.refusal = kNoSuchSource;
    return answer;
  }

  const LookBackOptions options;

  // Between Append and the thread.
  std::mutex queue_mutex;
  std::condition_variable wake;
  std::condition_variable flushed;
  std::vector<SpooledMessage> queue;
  std::int64_t queue_bytes = 0;
  std::int64_t num_lost_queue = 0;
  std::int64_t num_flushes_wanted = 0;
  std::int64_t num_flushes_done = 0;
  std::atomic<bool> is_stopping = false;
  std::atomic<bool> is_following = false;

  // Guards the recordings. Held while a disk is read, never while one is written or a log is looked through.
  mutable std::mutex mutex;
  Recording recording;

  mutable std::mutex status_mutex;  // guards the next three members; never held while a disk is used
  LookBackStatus status;
  std::string turn_fault;
  std::string sources_text = "[]";

  // Members that the thread alone uses.
  Spool spool;
  fs::path spool_file;
  std::uint16_t spool_number = 0;
  std::map<fs::path, std::uint16_t> spool_numbers;  // of the spool's files in the recording
  std::optional<LogIndexer> spool_indexer;
  std::vector<fs::path> to_follow;  // the first is followed
  std::optional<LogIndexer> followed;
  fs::path followed_file;
  std::uint16_t followed_number = 0;
  fs::path seen_log;
  std::uintmax_t seen_size = 0;
  bool has_looked = false;
  int num_still = 0;
  int num_periods = 0;
  int retry_periods = 0;
  bool is_stop_told = false;
  std::int64_t room_bytes = options.max_bytes;  // room that the disk's reserve leaves to the spool
  std::string room_text;
  std::optional<Utime> end_told;

  std::thread thread;  // last, so that the thread begins when all other members are there
};

LookBack::LookBack(LookBackOptions options) : implementation_(std::make_unique<Implementation>(std::move(options))) {}

LookBack::~LookBack() = default;

bool LookBack::IsKept(std::string_view channel) { return HasEntries(channel); }

void LookBack::Append(Utime time, std::string_view channel, Bytes message) {
  auto& in = *implementation_;
  if (in.is_following || !IsKept(channel)) return;
  const std::scoped_lock lock(in.queue_mutex);
  if (in.queue_bytes + static_cast<std::int64_t>(message.size()) > in.options.queue_bytes) {
    ++in.num_lost_queue;
    return;
  }
  in.queue_bytes += static_cast<std::int64_t>(message.size());
  in.queue.push_back({time, bus::FindChannel(channel)->name, {message.begin(), message.end()}});
}

LookBackStatus LookBack::Status() const {
  auto& in = *implementation_;
  LookBackStatus status;
  {
    const std::scoped_lock lock(in.status_mutex);
    status = in.status;
    if (status.fault.empty()) status.fault = in.turn_fault;
  }
  status.is_following = in.is_following;
  const std::scoped_lock lock(in.queue_mutex);
  status.num_lost += in.num_lost_queue;
  return status;
}

std::string LookBack::SourcesText() {
  const std::scoped_lock lock(implementation_->status_mutex);
  return implementation_->sources_text;
}

Answer LookBack::Find(const At& request) { return implementation_->Find(request); }

Answer LookBack::Find(const Range& request) { return implementation_->Find(request); }

std::string LookBack::Strip(const StripRequest& request) {
  if (request.source != 0) return RefusedText(request.id, kNoSuchSource);
  const std::scoped_lock lock(implementation_->mutex);
  return StripText(implementation_->recording.timeline(), request);
}

void LookBack::Flush() {
  auto& in = *implementation_;
  std::unique_lock lock(in.queue_mutex);
  const auto wanted = ++in.num_flushes_wanted;
  in.wake.notify_all();
  in.flushed.wait(lock, [&] { return in.num_flushes_done >= wanted; });
}

}  // namespace lookout::page
