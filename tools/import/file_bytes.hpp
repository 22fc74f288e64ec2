// Whole files of bounded size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace lookout::importer {

/// The fault of a file: "file:line: reason" in its text, "file: byte N: reason" in its binary part.
class PointFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// 2^21 points of 128 bytes each.
inline constexpr std::uintmax_t kMaxPointFileBytes = std::uintmax_t{256} << 20;

/// @throws PointFileError when it cannot be read or is larger than kMaxPointFileBytes
std::string ReadFileBytes(const std::filesystem::path& file);

[[noreturn]] void RefuseByte(const std::string& name, std::size_t offset, const std::string& reason);
[[noreturn]] void RefuseLine(const std::string& name, int line, const std::string& reason);

}  // namespace lookout::importer
