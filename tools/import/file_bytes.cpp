#include "tools/import/file_bytes.hpp"

#include <fstream>
#include <system_error>

namespace lookout::importer {

std::string ReadFileBytes(const std::filesystem::path& file) {
  std::error_code fault;
  const auto size = std::filesystem::file_size(file, fault);
  if (fault) throw PointFileError(file.string() + ": cannot be read: " + fault.message());
  if (size > kMaxPointFileBytes) {
    throw PointFileError(file.string() + ": " + std::to_string(size) + " bytes are more than the " + std::to_string(kMaxPointFileBytes) +
                         " that a scan may take");
  }
  std::string bytes(size, '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) throw PointFileError(file.string() + ": cannot be read to its end");
  return bytes;
}

void RefuseByte(const std::string& name, std::size_t offset, const std::string& reason) {
  throw PointFileError(name + ": byte " + std::to_string(offset) + ": " + reason);
}

void RefuseLine(const std::string& name, int line, const std::string& reason) {
  throw PointFileError(name + ":" + std::to_string(line) + ": " + reason);
}

}  // namespace lookout::importer
