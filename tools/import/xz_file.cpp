#include "tools/import/xz_file.hpp"

#include <lzma.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
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

XzCsv::XzCsv(const std::filesystem::path& file, std::span<const std::string_view> columns)
    : file_(file), bytes_(file, kMaxBytes), block_(kBlockBytes), names_(columns.begin(), columns.end()) {
  if (!ReadLine()) Refuse("empty: a header is missing");
  Split();
  num_columns_ = cells_.size();
  for (const auto& name : names_) {
    const auto found = std::ranges::find(cells_, name);
    if (found == cells_.end()) Refuse("the header lacks the column " + name);
    place_.push_back(static_cast<std::size_t>(found - cells_.begin()));
  }
}

bool XzCsv::Next() {
  if (!ReadLine()) return false;
  Split();
  if (cells_.size() != num_columns_) {
    Refuse(std::to_string(cells_.size()) + " columns, where the header has " + std::to_string(num_columns_));
  }
  return true;
}

std::int64_t XzCsv::WholeNumber(std::size_t column, std::int64_t min, std::int64_t max) const {
  const auto cell = Text(column);
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size()) Refuse(names_[column] + ": not a whole number: " + std::string(cell));
  if (value < min || value > max) {
    Refuse(names_[column] + ": " + std::string(cell) + " is not within " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

double XzCsv::Number(std::size_t column) const {
  const auto cell = Text(column);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    Refuse(names_[column] + ": not a finite number: " + std::string(cell));
  }
  return value;
}

void XzCsv::Refuse(const std::string& reason) const {
  throw std::runtime_error(file_.string() + ":" + std::to_string(std::max<std::int64_t>(1, line_number_)) + ": " + reason);
}

bool XzCsv::ReadLine() {
  line_.clear();
  ++line_number_;
  for (;;) {
    if (block_begin_ == block_end_) {
      block_begin_ = 0;
      try {
        block_end_ = bytes_.Read(block_);
      } catch (const std::runtime_error& error) {
        Refuse(error.what());
      }
      if (block_end_ == 0) return !line_.empty();
    }
    const auto begin = block_.begin() + static_cast<std::ptrdiff_t>(block_begin_);
    const auto end = block_.begin() + static_cast<std::ptrdiff_t>(block_end_);
    const auto newline = std::find(begin, end, std::uint8_t{'\n'});
    if (line_.size() + static_cast<std::size_t>(newline - begin) > kMaxLineBytes)
      Refuse("a line of more than " + std::to_string(kMaxLineBytes) + " bytes");
    line_.append(begin, newline);
    block_begin_ += static_cast<std::size_t>(newline - begin) + (newline == end ? 0 : 1);
    if (newline == end) continue;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    return true;
  }
}

void XzCsv::Split() {
  cells_.clear();
  std::string_view rest(line_);
  for (;;) {
    const auto comma = rest.find(',');
    cells_.push_back(rest.substr(0, comma));
    if (comma == std::string_view::npos) return;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace lookout::importer
