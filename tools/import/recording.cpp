#include "tools/import/recording.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include "common/core/printable.hpp"
#include "tools/import/byte_source.hpp"
#include "tools/import/folder_recording.hpp"
#include "tools/import/mcap_file.hpp"
#include "tools/import/ros_bag.hpp"
#include "tools/import/rosbag2_database.hpp"

namespace lookout::importer {

namespace {

// The number at the end of a file's stem, which rosbag2 and rosbag split count; -1: none.
std::int64_t NumberOfFile(const std::filesystem::path& file) {
  const auto stem = file.stem().string();
  const auto last = stem.find_last_not_of("0123456789");
  const auto digits = last == std::string::npos ? stem : stem.substr(last + 1);
  constexpr std::size_t kMaxDigits = 18;
  return digits.empty() || digits.size() > kMaxDigits ? -1 : std::stoll(digits);
}

}  // namespace

void Losses::Damage(std::uint64_t offset, const std::string& reason) {
  ++num_damaged;
  if (first_fault.empty()) first_fault = "byte " + std::to_string(offset) + ": " + reason;
}

void Losses::DamageFile(const std::string& reason) {
  ++num_damaged;
  if (first_fault.empty()) first_fault = reason;
}

void Losses::BadMessage(const std::string& reason) {
  ++num_bad_messages;
  if (first_fault.empty()) first_fault = reason;
}

std::string PlainTypeName(std::string type) {
  const auto place = type.find("/msg/");
  if (place != std::string::npos) type.erase(place, 4);
  return type;
}

std::unique_ptr<Recording> OpenRecording(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) return std::make_unique<FolderRecording>(file);
  auto source = std::make_unique<FileSource>(file);
  std::array<std::uint8_t, 16> head{};
  const auto bytes = Bytes(head).first(source->Read(0, head));
  if (RosBag::IsBag(bytes)) return std::make_unique<RosBag>(std::move(source));
  if (McapFile::IsMcap(bytes)) return std::make_unique<McapFile>(std::move(source));
  if (Rosbag2Database::IsDatabase(bytes)) return std::make_unique<Rosbag2Database>(file);
  return nullptr;
}

std::vector<std::filesystem::path> FilesOfRecording(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::filesystem::path> files;
  bool has_packed = false;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    const auto extension = entry.path().extension();
    if (extension == ".db3" || extension == ".mcap") files.push_back(entry.path());
    has_packed = has_packed || extension == ".zstd";
  }
  // compression_mode: file
  if (files.empty() && FolderRecording::IsLayout(path)) return {path};
  if (files.empty() && has_packed) {
    throw std::runtime_error(PrintableLines(path.string()) +
                             ": is a folder with files that are packed as a whole; unpack them first: zstd -d *.zstd");
  }
  if (files.empty()) {
    throw std::runtime_error(PrintableLines(path.string()) +
                             ": is a folder without a recording that is known here: rosbag2 (*.db3, *.mcap), *.pcd, *.bin of KITTI");
  }
  std::ranges::sort(files, {}, [](const auto& file) { return std::pair(NumberOfFile(file), file.string()); });
  return files;
}

}  // namespace lookout::importer
