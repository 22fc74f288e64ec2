#include "tools/archive/csv_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "common/core/printable.hpp"
#include "common/io/output_file.hpp"

namespace lookout::archive {

namespace {

constexpr std::size_t kBufferBytes = 256UL * 1024;

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file) : file_(file), buffer_(kBufferBytes) {
  in_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  in_.open(file, std::ios::binary);
  if (!in_) throw std::runtime_error(file.string() + ": cannot be read: " + io::ErrnoText());
  Read(header_);
}

std::optional<std::size_t> CsvReader::Find(std::string_view column) const {
  const auto place = std::ranges::find(header_, column);
  if (place == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(place - header_.begin());
}

std::size_t CsvReader::Place(std::string_view column) const {
  const auto place = Find(column);
  if (!place) throw std::runtime_error(file_.string() + ": has no column " + std::string(column));
  return *place;
}

bool CsvReader::Next(Row& row) {
  if (!Read(row)) return false;
  row.resize(header_.size());
  return true;
}

bool CsvReader::Read(Row& row) {
  auto& bytes = *in_.rdbuf();
  std::size_t num_cells = 0;
  const auto cell = [&row, &num_cells]() -> std::string& {
    if (num_cells == row.size()) row.emplace_back();
    row[num_cells].clear();
    return row[num_cells++];
  };
  auto* text = &cell();
  bool is_quoted = false;
  bool is_any = false;
  for (;;) {
    const int letter = bytes.sbumpc();
    if (letter == std::char_traits<char>::eof()) break;
    is_any = true;
    if (is_quoted) {
      if (letter != '"') {
        *text += static_cast<char>(letter);
      } else if (bytes.sgetc() == '"') {
        *text += static_cast<char>(bytes.sbumpc());
      } else {
        is_quoted = false;
      }
    } else if (letter == '"') {
      is_quoted = true;
    } else if (letter == ',') {
      text = &cell();
    } else if (letter == '\n') {
      break;
    } else if (letter != '\r') {
      *text += static_cast<char>(letter);
    }
  }
  row.resize(num_cells);
  return is_any;
}

std::optional<double> NumberOf(const std::string& text) {
  double value = 0;
  const auto* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (text.empty() || result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace lookout::archive
