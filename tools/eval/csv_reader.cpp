#include "tools/eval/csv_reader.hpp"

#include <algorithm>

namespace lookout::eval {

CsvReader::CsvReader(const std::filesystem::path& file, std::string_view columns) : file_(file), in_(file, std::ios::binary) {
  if (!in_) throw std::runtime_error(file.string() + ": cannot be opened");
  ++line_number_;
  if (!std::getline(in_, line_) || line_.rfind(columns, 0) != 0) Refuse("the columns are not " + std::string(columns));
  header_ = line_;
  num_columns_ = static_cast<std::size_t>(std::ranges::count(header_, ',')) + 1;
}

std::optional<std::size_t> CsvReader::ColumnOf(std::string_view name) const {
  std::string_view rest(header_);
  for (std::size_t column = 0;; ++column) {
    const auto comma = rest.find(',');
    if (rest.substr(0, comma) == name) return column;
    if (comma == std::string_view::npos) return std::nullopt;
    rest.remove_prefix(comma + 1);
  }
}

bool CsvReader::Next() {
  if (!std::getline(in_, line_)) return false;
  ++line_number_;
  cells_.clear();
  std::string_view rest(line_);
  for (;;) {
    const auto comma = rest.find(',');
    cells_.push_back(rest.substr(0, comma));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (cells_.size() < num_columns_) Refuse("too few columns");
  return true;
}

void CsvReader::Refuse(const std::string& reason) const {
  throw std::runtime_error(file_.string() + ":" + std::to_string(line_number_) + ": " + reason);
}

}  // namespace lookout::eval
