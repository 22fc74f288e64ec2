#include "common/io/text_file.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

namespace lookout::io {

namespace {

constexpr std::size_t kTextBufferBytes = 64UL * 1024;
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
constexpr std::string_view kLittleEndianMark = "\xFF\xFE";
constexpr std::string_view kBigEndianMark = "\xFE\xFF";

bool IsAscii(std::uint8_t byte) { return (byte >= 0x20 && byte < 0x7F) || byte == '\t' || byte == '\n' || byte == '\r'; }

// Whether the first letters are ASCII with a zero byte each, before or behind it.
bool BeginsInAscii(std::span<const std::uint8_t> bytes, std::size_t zero_at) {
  constexpr std::size_t kNumLetters = 32;
  if (bytes.size() < 2 * kNumLetters) return false;
  for (std::size_t i = 0; i < 2 * kNumLetters; i += 2) {
    if (bytes[i + zero_at] != 0 || !IsAscii(bytes[i + 1 - zero_at])) return false;
  }
  return true;
}

}  // namespace

TextFile::TextFile(std::filesystem::path file) : file_(std::move(file)), bytes_(file_) { Begin(); }

void TextFile::Begin() {
  Fill();
  const std::string_view start(reinterpret_cast<const char*>(buffer_.data()), buffer_.size());
  if (start.starts_with(kUtf8Mark)) {
    next_ = kUtf8Mark.size();
  } else if (start.starts_with(kLittleEndianMark)) {
    next_ = kLittleEndianMark.size();
    coding_ = Coding::kUtf16LittleEndian;
  } else if (start.starts_with(kBigEndianMark)) {
    next_ = kBigEndianMark.size();
    coding_ = Coding::kUtf16BigEndian;
  } else if (BeginsInAscii(buffer_, 1)) {
    coding_ = Coding::kUtf16LittleEndian;
  } else if (BeginsInAscii(buffer_, 0)) {
    coding_ = Coding::kUtf16BigEndian;
  }
  mark_bytes_ = static_cast<std::int64_t>(next_);
}

void TextFile::Seek(std::int64_t position) {
  position = std::max(position, mark_bytes_);
  if (position < buffer_begin_) {
    bytes_ = UnpackedFile(file_);
    buffer_.clear();
    buffer_begin_ = 0;
    next_ = 0;
    Begin();
  }
  // Bytes before the position are not kept on the way to it.
  while (position > buffer_begin_ + static_cast<std::int64_t>(buffer_.size())) {
    next_ = buffer_.size();
    if (!Fill()) break;
  }
  next_ = static_cast<std::size_t>(std::min(position - buffer_begin_, static_cast<std::int64_t>(buffer_.size())));
}

// Adds the next bytes to the buffer, and drops those before the kept part.
bool TextFile::Fill() {
  const std::size_t num_dropped = next_ > kKeptBytes ? next_ - kKeptBytes : 0;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(num_dropped));
  buffer_begin_ += static_cast<std::int64_t>(num_dropped);
  next_ -= num_dropped;
  const auto size = buffer_.size();
  buffer_.resize(size + kTextBufferBytes);
  buffer_.resize(size + bytes_.Read(std::span(buffer_).subspan(size)));
  return buffer_.size() > size;
}

bool TextFile::Get(char& letter) {
  while (buffer_.size() - next_ < BytesPerLetter()) {
    if (!Fill()) return false;
  }
  const auto first = buffer_[next_];
  if (coding_ == Coding::kBytes) {
    letter = static_cast<char>(first);
  } else {
    constexpr char kNoLetter = '\xFF';
    const auto second = buffer_[next_ + 1];
    const bool is_little = coding_ == Coding::kUtf16LittleEndian;
    letter = (is_little ? second : first) == 0 ? static_cast<char>(is_little ? first : second) : kNoLetter;
  }
  next_ += BytesPerLetter();
  return true;
}

}  // namespace lookout::io
