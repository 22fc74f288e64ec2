#include "lab/data/xz_file.hpp"

#include <stdexcept>
#include <string>
#include <system_error>

namespace lookout::data {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 16;
constexpr std::uint64_t kMaxDecoderBytes = std::uint64_t{256} << 20;  // xz -9 asks for 65 MiB

std::string ReasonOf(lzma_ret outcome) {
  switch (outcome) {
    case LZMA_FORMAT_ERROR:
      return "not compressed by xz";
    case LZMA_BUF_ERROR:
      return "the compressed data is cut off";
    case LZMA_MEMLIMIT_ERROR:
      return "asks for too much memory to be unpacked";
    case LZMA_OPTIONS_ERROR:
      return "compressed in a way that is not understood";
    default:
      return "the compressed data is damaged";
  }
}

}  // namespace

XzFile::XzFile(const std::filesystem::path& file, std::uint64_t max_bytes) : in_(file, std::ios::binary), packed_(kBlockBytes), num_left_(max_bytes) {
  std::error_code fault;
  if (!in_ || !std::filesystem::is_regular_file(file, fault)) throw std::runtime_error(file.string() + ": cannot be opened");
  if (lzma_stream_decoder(&stream_, kMaxDecoderBytes, LZMA_CONCATENATED) != LZMA_OK) throw std::runtime_error("liblzma cannot be used");
}

XzFile::~XzFile() { lzma_end(&stream_); }

std::size_t XzFile::Read(std::span<std::uint8_t> out) {
  stream_.next_out = out.data();
  stream_.avail_out = out.size();
  while (stream_.avail_out > 0 && !is_at_end_) {
    if (stream_.avail_in == 0 && in_) {
      // A byte of the file is a byte whatever type the stream gives it.
      in_.read(reinterpret_cast<char*>(packed_.data()), static_cast<std::streamsize>(packed_.size()));
      stream_.next_in = packed_.data();
      stream_.avail_in = static_cast<std::size_t>(in_.gcount());
    }
    const auto outcome = lzma_code(&stream_, in_ ? LZMA_RUN : LZMA_FINISH);
    is_at_end_ = outcome == LZMA_STREAM_END;
    if (outcome != LZMA_OK && outcome != LZMA_STREAM_END) throw std::runtime_error(ReasonOf(outcome));
  }
  const std::size_t count = out.size() - stream_.avail_out;
  if (count > num_left_) throw std::runtime_error("larger, when unpacked, than a file of this kind may be");
  num_left_ -= count;
  return count;
}

}  // namespace lookout::data
