#include "services/page/film/spool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <stdexcept>

#include "common/bus/log_file.hpp"

namespace lookout::page {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::minutes kFileSpan(1);
constexpr std::string_view kPrefix = "look-back-";
constexpr std::string_view kEnding = ".lcmlog.partial";

bool IsOurs(const fs::path& file) {
  const auto name = file.filename().string();
  return name.starts_with(kPrefix) && name.ends_with(kEnding);
}

// Its writer locks it.
bool IsBeingWritten(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool is_locked = flock(descriptor, LOCK_SH | LOCK_NB) != 0;
  close(descriptor);
  return is_locked;
}

}  // namespace

Spool::Spool(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_)) throw std::runtime_error(folder_.string() + ": no folder can be made there for the spool");
  std::vector<fs::path> left;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    if (IsOurs(entry.path()) && entry.is_regular_file(error) && !entry.is_symlink(error)) left.push_back(entry.path());
  }
  for (const auto& file : left) {
    if (!IsBeingWritten(file)) fs::remove(file, error);
  }
}

void Spool::Begin(Utime time) {
  const auto name_of = [this](std::int64_t number) { return folder_ / fmt::format("{}{:06}.lcmlog", kPrefix, number); };
  const auto partial_of = [&](std::int64_t number) { return name_of(number) += ".partial"; };
  // Another process may have been given the same folder.
  while (IsBeingWritten(partial_of(num_files_begun_))) ++num_files_begun_;
  const auto number = num_files_begun_++;
  const auto name = name_of(number);
  File file{.partial = partial_of(number), .out = nullptr, .first = time};
  file.out = std::make_unique<io::OutputFile>(name, io::OutputOptions{.force = true, .inputs = {}, .tell = [](const std::string&) {}});
  files_.push_back(std::move(file));
  is_open_ = true;
}

bool Spool::Write(const std::vector<SpooledMessage>& messages, std::int64_t max_file_bytes) {
  if (messages.empty()) return true;
  try {
    const auto time = messages.front().time;
    const bool is_over =
        is_open_ && (time - files_.back().first >= kFileSpan || time < files_.back().first || files_.back().num_bytes >= max_file_bytes);
    if (!is_open_ || is_over) Begin(time);
    auto& file = files_.back();
    std::vector<std::uint8_t> block;
    for (const auto& message : messages) {
      bus::AppendLogEvent(block, file.num_events++, message.time, message.channel, message.bytes);
    }
    file.out->Write(block);
    file.out->Flush();
    file.num_bytes += static_cast<std::int64_t>(block.size());
    fault_.clear();
    return true;
  } catch (const std::exception& error) {
    is_open_ = false;  // the file may end in a torn event
    // On a full disk a file can be begun, and each attempt would leave an empty one and its descriptor behind.
    if (!files_.empty() && files_.back().num_bytes == 0) files_.pop_back();
    fault_ = error.what();
    return false;
  }
}

fs::path Spool::file() const { return files_.empty() ? fs::path() : files_.back().partial; }

std::int64_t Spool::num_bytes() const {
  std::int64_t sum = 0;
  for (const auto& file : files_) sum += file.num_bytes;
  return sum;
}

void Spool::DropOldest() {
  files_.pop_front();
  is_open_ = is_open_ && !files_.empty();
}

void Spool::Clear() {
  files_.clear();
  is_open_ = false;
}

}  // namespace lookout::page
