// The text at the top of a PCD file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::importer {

struct PcdField {
  enum class Type { kSigned, kUnsigned, kFloat };

  std::string name;
  Type type = Type::kFloat;
  std::size_t size_bytes = 4;  // of one number: 1, 2, 4 or 8; a float 4 or 8
  std::size_t count = 1;
  std::size_t offset_bytes = 0;    // in a point of the binary form
  std::size_t offset_columns = 0;  // in a line of the text form
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t num_points = 0;
  std::size_t point_bytes = 0;    // of the binary form
  std::size_t point_columns = 0;  // of the text form
  bool is_binary = false;
  std::size_t data_offset = 0;  // of the first byte behind the header
  int data_line = 0;            // number of the first line behind the header, from 1
};

/// @param bytes  the whole file. The counts of the header are held against its size, so what is made of them is never larger than a small multiple
/// @throws PointFileError with the line
/// Source: "The PCD (Point Cloud Data) file format", pointclouds.org, version 0.7
PcdHeader ParsePcdHeader(std::string_view bytes, const std::string& name);

/// Takes the next line off, without its end. @return false at the end
bool NextLine(std::string_view& rest, std::string_view& line);

/// Words between blanks and tabs, into `words`, which is cleared first.
void SplitWords(std::string_view line, std::vector<std::string_view>& words);

}  // namespace lookout::importer
