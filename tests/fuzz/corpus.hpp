// Folders of seeds, and what they are made of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace lookout::fuzz {

using Payload = std::vector<std::uint8_t>;

class Folder {
 public:
  explicit Folder(std::filesystem::path path) : path_(std::move(path)) { std::filesystem::create_directories(path_); }

  void Write(const std::string& name, const Payload& bytes) const {
    std::ofstream file(path_ / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) throw std::runtime_error((path_ / name).string() + ": cannot be written");
  }
  void Write(const std::string& name, const std::string& text) const { Write(name, Payload(text.begin(), text.end())); }

 private:
  std::filesystem::path path_;
};

inline Payload operator+(Payload a, const Payload& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline Payload BigEndian(std::uint64_t value, int num_bytes) {
  Payload bytes;
  for (int shift = 8 * (num_bytes - 1); shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  return bytes;
}

inline Payload LittleEndian(std::uint64_t value, int num_bytes) {
  Payload bytes = BigEndian(value, num_bytes);
  return {bytes.rbegin(), bytes.rend()};
}

/// ROS bags, MCAP files and databases of rosbag2, and messages of ROS: into the folders of their targets below `root`.
void WriteRecordings(const std::filesystem::path& root);

/// Packets of other lidars than a VLP-16, as the targets take them; metadata and angles.
void WriteHesaiPackets(const Folder& folder);
void WriteVelodynePackets(const Folder& folder);
void WriteOuster(const Folder& folder);

/// Texts that lookout-archive reads.
void WriteArchiveTexts(const Folder& folder);

/// Messages of an autopilot.
void WriteAutopilot(const Folder& folder);

// In corpus_ais.cpp
void WriteAis(const Folder& folder);

}  // namespace lookout::fuzz
