#include "lab/eval/tracks/alert_kept.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/schema.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

// A file: fingerprint; messages (time, channel, size, bytes); the returns of each scan (utime_us, objects, then id and count of each); how many
// scans, and where the messages end. Numbers are of 8 bytes, as this computer has them: the file is for this computer alone.
constexpr std::size_t kFingerprintSize = 64;
constexpr std::size_t kNumberSize = sizeof(std::int64_t);
constexpr std::int64_t kEndMark = 0x6e75725f64707421;
constexpr std::streamoff kFooterSize = 3 * static_cast<std::streamoff>(kNumberSize);
// More than any message of the bus has.
constexpr std::int64_t kMostBytes = 64'000'000;
constexpr std::array kKeptChannels{bus::kLidarScan.name, bus::kSegments.name, bus::kObstacles.name, bus::kPose.name};

std::string TextOfFile(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(in), {});
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return text;
}

[[noreturn]] void RefuseKept(const fs::path& file) { throw std::runtime_error(file.string() + ": damaged; remove it"); }

std::int64_t ReadNumber(std::ifstream& in, const fs::path& file) {
  std::array<char, kNumberSize> bytes{};
  if (!in.read(bytes.data(), bytes.size())) RefuseKept(file);
  return std::bit_cast<std::int64_t>(bytes);
}

}  // namespace

std::string FingerprintOfRun(const fs::path& config_folder, const fs::path& scene_file, std::uint64_t seed, double seconds) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(config_folder)) {
    if (entry.path().extension() == ".txtpb" && entry.path().filename() != "tracker.txtpb") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  bus::Sha256 digest;
  const auto add = [&digest](const std::string& text) {
    const auto part = fmt::format("{}\n{}", text.size(), text);
    digest.Add(part.data(), part.size());
  };
  for (const auto& file : files) {
    add(file.filename().string());
    add(TextOfFile(file));
  }
  add(TextOfFile(scene_file));
  add(fmt::format("{} {}", seed, seconds));
  return digest.Finish();
}

KeptRunWriter::KeptRunWriter(const fs::path& file, const std::string& fingerprint) : file_(file, {.force = true}) {
  if (fingerprint.size() != kFingerprintSize) throw std::logic_error("a fingerprint of another size");
  file_.Write(std::string_view(fingerprint));
  num_bytes_ = static_cast<std::int64_t>(fingerprint.size());
}

void KeptRunWriter::WriteNumber(std::int64_t value) {
  const auto bytes = std::bit_cast<std::array<char, kNumberSize>>(value);
  file_.Write(std::string_view(bytes.data(), bytes.size()));
  num_bytes_ += static_cast<std::int64_t>(kNumberSize);
}

void KeptRunWriter::AddMessage(Utime time, std::string_view channel, Bytes bytes) {
  const auto kept = std::ranges::find(kKeptChannels, channel);
  if (kept == kKeptChannels.end()) return;
  WriteNumber(ToUtimeUs(time));
  WriteNumber(kept - kKeptChannels.begin());
  WriteNumber(static_cast<std::int64_t>(bytes.size()));
  file_.Write(bytes);
  num_bytes_ += static_cast<std::int64_t>(bytes.size());
}

void KeptRunWriter::Commit() {
  const auto messages_end = num_bytes_;
  for (const auto& [utime_us, counts] : returns_) {
    WriteNumber(utime_us);
    WriteNumber(static_cast<std::int64_t>(counts.size()));
    for (const auto& [object, count] : counts) {
      WriteNumber(object);
      WriteNumber(count);
    }
  }
  WriteNumber(static_cast<std::int64_t>(returns_.size()));
  WriteNumber(messages_end);
  WriteNumber(kEndMark);
  file_.Commit();
}

bool KeptRun::IsThere(const fs::path& file, const std::string& fingerprint) {
  std::ifstream in(file, std::ios::binary);
  std::string read(kFingerprintSize, '\0');
  return in.read(read.data(), static_cast<std::streamsize>(read.size())) && read == fingerprint;
}

KeptRun::KeptRun(const fs::path& file) : file_(file) {
  constexpr std::int64_t kMostObjects = 1'000'000;
  std::ifstream in(file, std::ios::binary);
  in.seekg(-kFooterSize, std::ios::end);
  const std::streamoff returns_end = in.tellg();
  const auto num_scans = ReadNumber(in, file);
  messages_end_ = ReadNumber(in, file);
  if (ReadNumber(in, file) != kEndMark) RefuseKept(file);
  in.seekg(messages_end_);
  for (std::int64_t i = 0; i < num_scans; ++i) {
    auto& counts = returns_[ReadNumber(in, file)];
    const auto num_objects = ReadNumber(in, file);
    if (num_objects < 0 || num_objects > kMostObjects) RefuseKept(file);
    for (std::int64_t k = 0; k < num_objects; ++k) {
      const auto object = static_cast<int>(ReadNumber(in, file));
      counts[object] = static_cast<int>(ReadNumber(in, file));
    }
  }
  if (in.tellg() != returns_end) RefuseKept(file);
}

void KeptRun::Send(const MessageHandler& on_message) const {
  std::ifstream in(file_, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(kFingerprintSize));
  std::vector<std::uint8_t> bytes;
  while (in.tellg() < messages_end_) {
    const Utime time{std::chrono::microseconds(ReadNumber(in, file_))};
    const auto channel = ReadNumber(in, file_);
    const auto size = ReadNumber(in, file_);
    if (channel < 0 || !std::cmp_less(channel, kKeptChannels.size()) || size < 0 || size > kMostBytes) RefuseKept(file_);
    bytes.resize(static_cast<std::size_t>(size));
    if (!in.read(reinterpret_cast<char*>(bytes.data()), size)) RefuseKept(file_);
    on_message(time, kKeptChannels[static_cast<std::size_t>(channel)], bytes);
  }
}

}  // namespace lookout::eval
