#include "services/page/film/index_file.hpp"

#include <sys/stat.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "common/bus/schema.hpp"
#include "common/io/output_file.hpp"
#include "services/page/film/log_indexer.hpp"

namespace lookout::page {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "lookout page index 2\n";  // version 2: parts of a second lidar's scans
constexpr std::size_t kDigestBytes = 64;                       // hexadecimal
constexpr std::int64_t kEndBytes = 64 * 1024;
constexpr std::int64_t kSliceBytes = 8 * 1024 * 1024;
constexpr std::int64_t kMaxIndexBytes = std::int64_t{1} * 1024 * 1024 * 1024;
static_assert(std::endian::native == std::endian::little);  // as everywhere (lcmtypes/arrays.hpp)

class Out {
 public:
  template <typename Number>
  void Put(Number number) {
    std::array<std::uint8_t, sizeof(Number)> bytes{};
    std::memcpy(bytes.data(), &number, sizeof(Number));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void PutText(std::string_view text) {
    Put(static_cast<std::uint32_t>(text.size()));
    PutRaw(text);
  }
  void PutRaw(std::string_view text) { bytes_.insert(bytes_.end(), text.begin(), text.end()); }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

class Fault : public std::exception {};

class In {
 public:
  explicit In(Bytes bytes) : bytes_(bytes) {}

  template <typename Number>
  Number Take() {
    Number number{};
    std::memcpy(&number, Next(sizeof(Number)).data(), sizeof(Number));
    return number;
  }
  std::string TakeText(std::size_t max_bytes) {
    const auto size = Take<std::uint32_t>();
    if (size > max_bytes) throw Fault();
    return TakeRaw(size);
  }
  std::string TakeRaw(std::size_t size) {
    const auto bytes = Next(size);
    return {bytes.begin(), bytes.end()};
  }
  // A count of entries that take `least_bytes` each: no more than there can be.
  std::size_t TakeCount(std::size_t least_bytes, std::size_t max_count = SIZE_MAX) {
    const auto count = Take<std::uint64_t>();
    if (count > bytes_.size() / least_bytes || count > max_count) throw Fault();
    return count;
  }
  Utime TakeTime() {
    const auto time = UtimeFromWire(Take<std::int64_t>());
    if (!time) throw Fault();
    return *time;
  }
  bool is_at_end() const { return bytes_.empty(); }

 private:
  Bytes Next(std::size_t size) {
    if (size > bytes_.size()) throw Fault();
    const auto next = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return next;
  }

  Bytes bytes_;
};

std::string DigestOf(Bytes bytes) {
  bus::Sha256 digest;
  digest.Add(bytes.data(), bytes.size());
  return digest.Finish();
}

constexpr std::size_t kEntryBytes = 36;
constexpr std::size_t kCellBytes = 18;

void PutPart(Out& out, const LogPart& part) {
  out.Put(static_cast<std::uint64_t>(part.processes.size()));
  for (const auto& process : part.processes) out.PutText(process);
  out.Put(static_cast<std::uint64_t>(part.entries.size()));
  for (const auto& entry : part.entries) {
    out.Put(ToUtimeUs(entry.time));
    out.Put(entry.utime_us);
    out.Put(entry.offset_bytes);
    out.Put(entry.size_bytes);
    out.Put(entry.duration_us);
    out.Put(entry.channel);
    out.Put(entry.part);
  }
  out.Put(static_cast<std::uint64_t>(part.cells.size()));
  for (const auto& cell : part.cells) {
    out.Put(cell.second);
    out.Put(cell.num_tracks);
    out.Put(cell.num_lost);
    out.Put(cell.alert_level);
    out.Put(cell.health);
  }
  out.Put(static_cast<std::uint64_t>(part.events.size()));
  for (const auto& event : part.events) {
    out.Put(ToUtimeUs(event.time));
    out.Put(static_cast<std::uint8_t>(event.kind));
    out.Put(event.level);
    out.PutText(event.text);
  }
}

LogPart TakePart(In& in, std::int64_t log_bytes) {
  LogPart part;
  part.processes.resize(in.TakeCount(4, kMaxFilmProcesses));
  for (auto& process : part.processes) process = in.TakeText(bus::kMaxLogChannelBytes);
  part.entries.resize(in.TakeCount(kEntryBytes));
  std::int64_t end_bytes = 0;
  auto last = Utime::min();
  for (auto& entry : part.entries) {
    entry.time = in.TakeTime();
    entry.utime_us = in.Take<std::int64_t>();
    entry.offset_bytes = in.Take<std::int64_t>();
    entry.size_bytes = in.Take<std::uint32_t>();
    entry.duration_us = in.Take<std::uint32_t>();
    entry.channel = in.Take<std::uint16_t>();
    entry.part = in.Take<std::uint16_t>();
    if (entry.offset_bytes < end_bytes || entry.offset_bytes > log_bytes || entry.size_bytes > bus::kMaxLogDataBytes) throw Fault();
    end_bytes = entry.offset_bytes + entry.size_bytes;
    if (end_bytes > log_bytes || entry.time < last || !UtimeFromWire(entry.utime_us)) throw Fault();
    last = entry.time;
    if (entry.channel >= bus::kChannels.size() || !HasEntries(bus::kChannels[entry.channel].name)) throw Fault();
    if (bus::kChannels[entry.channel].name == bus::kHealth.name && entry.part >= part.processes.size()) throw Fault();
  }
  part.cells.resize(in.TakeCount(kCellBytes));
  std::int64_t second = kMinUtimeUs / 1'000'000 - 1;
  for (auto& cell : part.cells) {
    cell.second = in.Take<std::int64_t>();
    cell.num_tracks = in.Take<std::int32_t>();
    cell.num_lost = in.Take<std::int32_t>();
    cell.alert_level = in.Take<std::int8_t>();
    cell.health = in.Take<std::int8_t>();
    if (cell.second < second || cell.second > kMaxUtimeUs / 1'000'000 || cell.num_tracks < -1 || cell.num_lost < 0) throw Fault();
    if (cell.alert_level < 0 || cell.alert_level > 2 || cell.health < -1 || cell.health > 2) throw Fault();
    second = cell.second;
  }
  part.events.resize(in.TakeCount(14, kMaxFilmEvents));
  for (auto& event : part.events) {
    event.time = in.TakeTime();
    const auto kind = in.Take<std::uint8_t>();
    event.kind = static_cast<FilmEventKind>(kind);
    event.level = in.Take<std::uint8_t>();
    event.text = in.TakeText(kMaxFilmTextBytes);
    if (kind > static_cast<std::uint8_t>(FilmEventKind::kGap) || event.level > 2) throw Fault();
  }
  return part;
}

std::optional<LogPart> ReadIndexFile(const fs::path& file, const LogIdentity& identity) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  const auto size = fs::file_size(file, error);
  if (error || size > kMaxIndexBytes) return std::nullopt;
  std::vector<std::uint8_t> bytes(size);
  std::ifstream in(file, std::ios::binary);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as characters
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) return std::nullopt;
  return FromIndexBytes(bytes, identity);
}

}  // namespace

LogIdentity IdentityOf(const fs::path& log) {
  struct stat state {};
  std::ifstream in(log, std::ios::binary);
  if (stat(log.c_str(), &state) != 0 || !S_ISREG(state.st_mode) || !in) throw std::runtime_error(log.string() + ": cannot be read");
  LogIdentity identity{
      .size_bytes = state.st_size, .modified_ns = std::int64_t{state.st_mtim.tv_sec} * 1'000'000'000 + state.st_mtim.tv_nsec, .digest = {}};
  bus::Sha256 digest;
  std::vector<char> bytes(kEndBytes);
  for (const auto offset : {std::int64_t{0}, std::max<std::int64_t>(0, identity.size_bytes - kEndBytes)}) {
    in.clear();
    in.seekg(offset);
    in.read(bytes.data(), kEndBytes);
    digest.Add(bytes.data(), static_cast<std::size_t>(in.gcount()));
  }
  identity.digest = digest.Finish();
  return identity;
}

fs::path IndexFileOf(const fs::path& log) {
  auto file = log;
  file += ".index";
  return file;
}

std::vector<std::uint8_t> ToIndexBytes(const LogIdentity& identity, const LogPart& part) {
  Out out;
  out.bytes().reserve(kMagic.size() + 4096 + kEntryBytes * part.entries.size() + kCellBytes * part.cells.size() + 64 * part.events.size());
  out.PutRaw(kMagic);
  out.PutText(bus::SchemaDigest());  // the index depends on the channel table
  out.Put(static_cast<std::uint32_t>(bus::kChannels.size()));
  for (const auto& channel : bus::kChannels) out.PutText(channel.name);
  out.Put(identity.size_bytes);
  out.Put(identity.modified_ns);
  out.PutText(identity.digest);
  PutPart(out, part);
  out.PutRaw(DigestOf(out.bytes()));
  return std::move(out.bytes());
}

std::optional<LogPart> FromIndexBytes(Bytes bytes, const LogIdentity& identity) try {
  if (bytes.size() < kMagic.size() + kDigestBytes) return std::nullopt;
  const auto content = bytes.first(bytes.size() - kDigestBytes);
  const auto digest = bytes.last(kDigestBytes);
  In in(content);
  if (in.TakeRaw(kMagic.size()) != kMagic || in.TakeText(kDigestBytes) != bus::SchemaDigest()) return std::nullopt;
  if (in.Take<std::uint32_t>() != bus::kChannels.size()) return std::nullopt;
  for (const auto& channel : bus::kChannels) {
    if (in.TakeText(bus::kMaxLogChannelBytes) != channel.name) return std::nullopt;
  }
  LogIdentity found;
  found.size_bytes = in.Take<std::int64_t>();
  found.modified_ns = in.Take<std::int64_t>();
  found.digest = in.TakeText(kDigestBytes);
  if (found != identity || DigestOf(content) != std::string(digest.begin(), digest.end())) return std::nullopt;
  auto part = TakePart(in, identity.size_bytes);
  if (!in.is_at_end()) return std::nullopt;
  return part;
} catch (const Fault&) {
  return std::nullopt;
}

std::optional<LogPart> LoadIndex(const fs::path& log, bool writes_index, const std::function<bool(std::int64_t)>& on_progress,
                                 const std::function<void(const std::string&)>& tell) {
  const auto identity = IdentityOf(log);
  const auto file = IndexFileOf(log);
  if (auto part = ReadIndexFile(file, identity)) return part;
  LogPart part;
  LogIndexer indexer(log, false);
  while (indexer.Read(kSliceBytes, part)) {
    if (on_progress && !on_progress(indexer.position_bytes())) return std::nullopt;
  }
  if (!writes_index) return part;
  try {
    if (IdentityOf(log) != identity) throw std::runtime_error(log.string() + " is being written");
    io::OutputFile out(file, {.force = true, .inputs = {log}, .tell = [](const std::string&) {}});
    out.Write(ToIndexBytes(identity, part));
    out.Commit();
  } catch (const std::exception& error) {
    if (tell) tell("the index of the log is kept in memory, and made again next time: " + std::string(error.what()));
  }
  return part;
}

}  // namespace lookout::page
