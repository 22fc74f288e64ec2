#include "common/io/unpacked_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace lookout::io {

namespace {

constexpr unsigned int kBufferBytes = 256 * 1024;

gzFile Open(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw std::runtime_error(file.string() + ": no such file");
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw std::runtime_error(file.string() + ": cannot be opened: " + std::strerror(errno));
  const gzFile opened = gzdopen(descriptor, "rb");
  if (opened == nullptr) {
    close(descriptor);
    throw std::runtime_error(file.string() + ": no memory to read it");
  }
  gzbuffer(opened, kBufferBytes);
  return opened;
}

}  // namespace

UnpackedFile::UnpackedFile(const std::filesystem::path& file) : file_(Open(file), &gzclose) {}

std::size_t UnpackedFile::Read(std::span<std::uint8_t> out) {
  std::size_t size_read = 0;
  while (size_read < out.size() && fault_.empty()) {
    const auto wanted = static_cast<unsigned int>(std::min<std::size_t>(out.size() - size_read, INT_MAX));
    const int outcome = gzread(file_.get(), out.data() + size_read, wanted);
    if (outcome > 0) size_read += static_cast<std::size_t>(outcome);
    if (outcome >= 0 && static_cast<unsigned int>(outcome) == wanted) continue;
    // The end. The packed file may end too early: zlib tells that beside the bytes that came.
    int code = Z_OK;
    const std::string reason = gzerror(file_.get(), &code);
    if (code == Z_BUF_ERROR) fault_ = "what gzip packed is cut short";
    if (code != Z_BUF_ERROR && code != Z_OK && code != Z_STREAM_END)
      fault_ = code == Z_ERRNO ? std::strerror(errno) : "what gzip packed is damaged: " + reason;
    break;
  }
  return size_read;
}

std::int64_t UnpackedFile::position_bytes() const { return gzoffset(file_.get()); }

}  // namespace lookout::io
