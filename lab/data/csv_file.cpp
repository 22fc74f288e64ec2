#include "lab/data/csv_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "lab/data/xz_file.hpp"

namespace lookout::data {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 16;

std::function<std::size_t(std::span<std::uint8_t>)> Reader(const std::filesystem::path& file) {
  if (file.extension() == ".xz") {
    return [packed = std::make_shared<XzFile>(file, CsvFile::kMaxUnpackedBytes)](std::span<std::uint8_t> out) { return packed->Read(out); };
  }
  auto plain = std::make_shared<std::ifstream>(file, std::ios::binary);
  if (!*plain) throw std::runtime_error(file.string() + ": cannot be opened");
  return [plain](std::span<std::uint8_t> out) {
    plain->read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    return static_cast<std::size_t>(plain->gcount());
  };
}

}  // namespace

CsvFile::CsvFile(const std::filesystem::path& file, std::initializer_list<std::string_view> columns, std::initializer_list<std::string_view> optional)
    : file_(file), read_(Reader(file)), block_(kReadBytes), names_(columns.begin(), columns.end()) {
  names_.insert(names_.end(), optional.begin(), optional.end());
  if (!ReadLine()) Refuse("empty: a header is missing");
  Split();
  num_columns_ = cells_.size();
  for (const auto& name : names_) {
    place_.push_back(static_cast<std::size_t>(std::ranges::find(cells_, name) - cells_.begin()));
    if (place_.size() <= columns.size() && !Has(place_.size() - 1)) Refuse("the header lacks the column " + name);
  }
}

bool CsvFile::Next() {
  if (!ReadLine()) return false;
  Split();
  if (cells_.size() != num_columns_) {
    Refuse(std::to_string(cells_.size()) + " columns, where the header has " + std::to_string(num_columns_));
  }
  return true;
}

std::int64_t CsvFile::WholeNumber(std::size_t column, std::int64_t min, std::int64_t max) const {
  const auto cell = Text(column);
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size()) Refuse(names_[column] + ": not a whole number: " + std::string(cell));
  if (value < min || value > max) {
    Refuse(names_[column] + ": " + std::string(cell) + " is not within " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

double CsvFile::Number(std::size_t column) const {
  const auto cell = Text(column);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    Refuse(names_[column] + ": not a finite number: " + std::string(cell));
  }
  return value;
}

void CsvFile::Refuse(const std::string& reason) const {
  throw std::runtime_error(file_.string() + ":" + std::to_string(std::max<std::int64_t>(1, line_number_)) + ": " + reason);
}

bool CsvFile::ReadLine() {
  line_.clear();
  ++line_number_;
  for (;;) {
    if (block_begin_ == block_end_) {
      block_begin_ = 0;
      try {
        block_end_ = read_(block_);
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

void CsvFile::Split() {
  cells_.clear();
  std::string_view rest(line_);
  for (;;) {
    const auto comma = rest.find(',');
    cells_.push_back(rest.substr(0, comma));
    if (comma == std::string_view::npos) return;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace lookout::data
