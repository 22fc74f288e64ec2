#include "tools/import/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "common/io/output_file.hpp"

namespace lookout::importer {

FileSource::FileSource(const std::filesystem::path& file) : descriptor_(open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  struct stat state {};
  if (descriptor_ < 0 || fstat(descriptor_, &state) != 0) {
    const auto reason = io::ErrnoText();
    if (descriptor_ >= 0) close(descriptor_);
    throw std::runtime_error(file.string() + ": cannot be read: " + reason);
  }
  size_ = static_cast<std::uint64_t>(state.st_size);
  posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

FileSource::~FileSource() { close(descriptor_); }

std::size_t FileSource::Read(std::uint64_t offset, std::span<std::uint8_t> out) const {
  std::size_t num_read = 0;
  while (num_read < out.size() && offset + num_read < size_) {
    const auto got = pread(descriptor_, out.data() + num_read, out.size() - num_read, static_cast<off_t>(offset + num_read));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    num_read += static_cast<std::size_t>(got);
  }
  return num_read;
}

std::size_t MemorySource::Read(std::uint64_t offset, std::span<std::uint8_t> out) const {
  if (offset >= bytes_.size()) return 0;
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), bytes_.size() - offset));
  if (count > 0) std::memcpy(out.data(), bytes_.data() + offset, count);
  return count;
}

Bytes SearchWindow::From(const ByteSource& source, std::uint64_t offset) {
  const bool is_inside = !bytes_.empty() && offset >= begin_ && offset < end();
  if (!is_inside) {
    begin_ = offset;
    bytes_ = ReadBytes(source, offset, kStepBytes + most_bytes_);
  }
  return Bytes(bytes_).subspan(std::min(static_cast<std::size_t>(offset - begin_), bytes_.size()));
}

std::vector<std::uint8_t> ReadBytes(const ByteSource& source, std::uint64_t offset, std::uint64_t count) {
  const std::uint64_t left = offset < source.size() ? source.size() - offset : 0;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(std::min(count, left)));
  bytes.resize(source.Read(offset, bytes));
  return bytes;
}

}  // namespace lookout::importer
