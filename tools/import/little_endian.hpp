// Records of little-endian numbers and of texts with their length in front, read with every length checked.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "common/core/bytes.hpp"

namespace lookout::importer {

/// Reads from the front on. Behind the first number that is not there everything is 0 and empty, and is_good() is false.
class FieldsFromFront {
 public:
  explicit FieldsFromFront(Bytes bytes) : rest_(bytes) {}

  bool is_good() const { return is_good_; }
  Bytes rest() const { return rest_; }

  std::uint8_t U8() { return Take(1).size() == 1 ? taken_[0] : std::uint8_t{0}; }
  std::uint16_t U16() { return Take(2).size() == 2 ? ReadU16LittleEndian(taken_, 0) : std::uint16_t{0}; }
  std::uint32_t U32() { return Take(4).size() == 4 ? ReadU32LittleEndian(taken_, 0) : 0; }
  std::uint64_t U64() { return Take(8).size() == 8 ? ReadU64LittleEndian(taken_, 0) : 0; }
  std::string_view Text() {
    const auto bytes = Take(U32());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  Bytes Take(std::uint64_t count) {
    is_good_ = is_good_ && count <= rest_.size();
    taken_ = is_good_ ? rest_.first(static_cast<std::size_t>(count)) : Bytes();
    rest_ = is_good_ ? rest_.subspan(static_cast<std::size_t>(count)) : Bytes();
    return taken_;
  }

 private:
  Bytes rest_;
  Bytes taken_;
  bool is_good_ = true;
};

}  // namespace lookout::importer
