#include "services/page/film/film.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/io/file_kind.hpp"
#include "lookout/run_info_t.hpp"
#include "services/page/core/replies.hpp"
#include "services/page/film/boat_text.hpp"
#include "services/page/film/index_file.hpp"
#include "services/page/film/recording.hpp"
#include "services/page/film/source_text.hpp"
#include "services/page/film/strip.hpp"

namespace lookout::page {

namespace {

namespace fs = std::filesystem;

constexpr const char* kBeingIndexed = "the index is being built";
constexpr double kToldStep = 0.005;
constexpr const char* kNoSource = "no such source";

std::string NameOf(const std::vector<fs::path>& logs) {
  std::string name = logs.front().filename().string();
  if (logs.size() > 1) name += " and " + std::to_string(logs.size() - 1) + " more";
  return name;
}

// A file that is no log is left out later, and told.
std::int64_t SizeOf(const fs::path& log) {
  std::error_code error;
  if (!fs::is_regular_file(log, error)) throw std::runtime_error(io::WhyNot(log, io::Wanted::kLog));
  return static_cast<std::int64_t>(fs::file_size(log));
}

}  // namespace

struct Film::Implementation {
  struct Source {
    std::vector<fs::path> logs;
    std::vector<std::int64_t> sizes_bytes;
    SourceFacts facts;
    Recording recording;
  };

  explicit Implementation(FilmOptions some_options) : options(std::move(some_options)) {
    if (options.logs.empty()) throw std::runtime_error("no log is given");
    for (const auto& logs : {options.logs, options.beside}) {
      if (logs.empty()) continue;
      auto& source = sources.emplace_back();
      source.logs = logs;
      source.facts = {
          .id = static_cast<int>(sources.size()) - 1, .name = NameOf(logs), .is_growing = false, .is_indexed = false, .boat_text = "null"};
      for (const auto& log : logs) source.sizes_bytes.push_back(SizeOf(log));
    }
    UpdateSourcesText();
    thread = std::thread([this] { MakeIndices(); });
  }

  ~Implementation() {
    is_stopping = true;
    thread.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void MakeIndices() {
    for (auto& source : sources) {
      std::vector<std::pair<fs::path, LogPart>> parts;
      std::int64_t total_bytes = 1;
      for (const auto size : source.sizes_bytes) total_bytes += size;
      std::int64_t done_bytes = 0;
      double share_told = 0.0;
      for (std::size_t i = 0; i < source.logs.size() && !is_stopping; ++i) {
        LoadOne(source, source.logs[i], done_bytes, total_bytes, share_told, parts);
        done_bytes += source.sizes_bytes[i];
      }
      if (is_stopping) break;
      Install(source, parts);
      if (options.on_indexing) options.on_indexing(source.facts.id, 1.0);
      if (options.on_sources) options.on_sources();
    }
    const std::scoped_lock lock(mutex);
    is_done = true;
    done.notify_all();
  }

  void LoadOne(const Source& source, const fs::path& log, std::int64_t done_bytes, std::int64_t total_bytes, double& share_told,
               std::vector<std::pair<fs::path, LogPart>>& parts) try {
    const auto progress = [&](std::int64_t position_bytes) {
      const auto share = std::min(1.0, static_cast<double>(done_bytes + position_bytes) / static_cast<double>(total_bytes));
      if (options.on_indexing && share - share_told >= kToldStep) options.on_indexing(source.facts.id, share_told = share);
      return !is_stopping;
    };
    if (auto part = LoadIndex(log, options.writes_index, progress, options.tell)) parts.emplace_back(log, std::move(*part));
  } catch (const std::exception& error) {
    if (options.tell) options.tell(log.string() + " is left out: " + error.what());
  }

  void Install(Source& source, std::vector<std::pair<fs::path, LogPart>>& parts) {
    const auto begin_of = [](const auto& item) { return item.second.entries.empty() ? Utime::max() : item.second.entries.front().time; };
    std::ranges::stable_sort(parts, {}, begin_of);
    const std::scoped_lock lock(mutex);
    for (auto& [log, part] : parts) {
      try {
        source.recording.Append(source.recording.AddLog(log), std::exchange(part, {}));
      } catch (const std::exception& error) {
        if (options.tell) options.tell(log.string() + " is left out: " + error.what());
      }
    }
    if (!parts.empty() && source.recording.timeline().is_empty() && options.tell) {
      options.tell(source.facts.name + " holds no message of Lookout that a page can show (lookout-log info FILE tells its channels)");
    }
    if (const auto info = bus::Decode<run_info_t>(source.recording.RunInfo())) source.facts.boat_text = BoatTextOf(*info);
    source.facts.is_indexed = true;
    UpdateSourcesText();
  }

  // The mutex is held, or nobody else is there yet.
  void UpdateSourcesText() {
    std::vector<std::pair<SourceFacts, const Timeline*>> shown;
    for (const auto& source : sources) shown.emplace_back(source.facts, &source.recording.timeline());
    const std::scoped_lock lock(text_mutex);
    sources_text = SourcesTextOf(shown);
  }

  // Why a request for this source is refused; empty where it can be answered. The mutex is held.
  std::string RefusalOf(int source) const {
    if (source < 0 || std::cmp_greater_equal(source, sources.size())) return kNoSource;
    return sources[static_cast<std::size_t>(source)].facts.is_indexed ? "" : kBeingIndexed;
  }

  template <typename Asked>
  Answer Find(const Asked& request) {
    const std::scoped_lock lock(mutex);
    Answer answer;
    answer.refusal = RefusalOf(request.source);
    if (!answer.refusal.empty()) return answer;
    return sources[static_cast<std::size_t>(request.source)].recording.Find(request);
  }

  FilmOptions options;
  mutable std::mutex mutex;  // of the sources' recordings and facts
  std::condition_variable done;
  std::deque<Source> sources;
  bool is_done = false;
  std::mutex text_mutex;  // never held while a disk is read
  std::string sources_text;
  std::atomic<bool> is_stopping = false;
  std::thread thread;
};

Film::Film(FilmOptions options) : implementation_(std::make_unique<Implementation>(std::move(options))) {}

Film::~Film() = default;

std::string Film::SourcesText() {
  const std::scoped_lock lock(implementation_->text_mutex);
  return implementation_->sources_text;
}

Answer Film::Find(const At& request) { return implementation_->Find(request); }

Answer Film::Find(const Range& request) { return implementation_->Find(request); }

std::string Film::Strip(const StripRequest& request) {
  const std::scoped_lock lock(implementation_->mutex);
  const auto refusal = implementation_->RefusalOf(request.source);
  if (!refusal.empty()) return RefusedText(request.id, refusal);
  return StripText(implementation_->sources[static_cast<std::size_t>(request.source)].recording.timeline(), request);
}

void Film::Wait() {
  std::unique_lock lock(implementation_->mutex);
  implementation_->done.wait(lock, [this] { return implementation_->is_done; });
}

}  // namespace lookout::page
