#include "tools/import/xz_file.hpp"

#include <lzma.h>

#include <stdexcept>
#include <string>
#include <system_error>

namespace lookout::importer {
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

struct XzFile::Decoder {
  Decoder() {
    if (lzma_stream_decoder(&stream, kMaxDecoderBytes, LZMA_CONCATENATED) != LZMA_OK) throw std::runtime_error("liblzma cannot be used");
  }
  ~Decoder() { lzma_end(&stream); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  lzma_stream stream = LZMA_STREAM_INIT;
  bool is_at_end = false;
};

XzFile::XzFile(const std::filesystem::path& file, std::uint64_t max_bytes)
    : in_(file, std::ios::binary), decoder_(std::make_unique<Decoder>()), packed_(kBlockBytes), num_left_(max_bytes) {
  std::error_code fault;
  if (!in_ || !std::filesystem::is_regular_file(file, fault)) throw std::runtime_error(file.string() + ": cannot be opened");
}

XzFile::~XzFile() = default;

std::size_t XzFile::Read(std::span<std::uint8_t> out) {
  auto& stream = decoder_->stream;
  stream.next_out = out.data();
  stream.avail_out = out.size();
  while (stream.avail_out > 0 && !decoder_->is_at_end) {
    if (stream.avail_in == 0 && in_) {
      // A byte of the file is a byte whatever type the stream gives it.
      in_.read(reinterpret_cast<char*>(packed_.data()), static_cast<std::streamsize>(packed_.size()));
      stream.next_in = packed_.data();
      stream.avail_in = static_cast<std::size_t>(in_.gcount());
    }
    const auto outcome = lzma_code(&stream, in_ ? LZMA_RUN : LZMA_FINISH);
    decoder_->is_at_end = outcome == LZMA_STREAM_END;
    if (outcome != LZMA_OK && outcome != LZMA_STREAM_END) throw std::runtime_error(ReasonOf(outcome));
  }
  const std::size_t count = out.size() - stream.avail_out;
  if (count > num_left_) throw std::runtime_error("larger, when unpacked, than a file of this kind may be");
  num_left_ -= count;
  return count;
}

}  // namespace lookout::importer
