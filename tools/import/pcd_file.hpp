// Numbers of the points of a PCD file, point by point: text, binary or compressed.
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

enum class PcdForm { kText, kBinary, kCompressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t num_points = 0;
  std::size_t point_bytes = 0;    // of the binary form
  std::size_t point_columns = 0;  // of the text form
  PcdForm form = PcdForm::kText;
  std::size_t data_offset = 0;  // of the first byte behind the header
  int data_line = 0;            // number of the first line behind the header, from 1
};

/// More points are no scan.
inline constexpr std::size_t kMaxPcdPoints = std::size_t{1} << 21;

/// Version 0.7 of the format. Source: "The PCD (Point Cloud Data) file format", pointclouds.org
class PcdReader {
 public:
  /// Whether a file that ends before its last point is read as far as it goes.
  enum class Cut { kRefused, kRead };

  /// @param bytes  outlive this
  /// @throws PointFileError for a header that lacks, repeats or contradicts something, a viewpoint that is not the origin, and compressed points that
  ///         do not unpack to what the header says; with Cut::kRefused for too few or too many bytes
  PcdReader(std::string_view bytes, std::string name, Cut cut);

  const std::string& name() const { return name_; }
  const PcdHeader& header() const { return header_; }

  /// @return nullptr where there is none of this name
  /// @throws PointFileError when there are two, or it is more than one number
  const PcdField* Find(std::string_view field_name) const;

  /// Goes to the first point, to the next.
  /// @return false behind the last one
  /// @throws PointFileError for a line of another number of columns, and where the file ends before the last point
  bool Next();

  /// The number in a field of this point. @throws PointFileError for text that is no number
  double Number(const PcdField& field) const;

  /// @throws PointFileError with the place of this point
  [[noreturn]] void Refuse(const std::string& reason) const;

 private:
  bool NextTextPoint();

  std::string_view bytes_;
  std::string name_;
  PcdHeader header_;
  std::string unpacked_;  // of compressed points: all numbers of the first field, of the second, ...
  std::string_view rest_;
  std::vector<std::string_view> words_;
  int line_ = 0;
  std::size_t num_read_ = 0;
};

/// Unpacks LZF, as PCD uses it. Source: M. Lehmann, liblzf (format of lzf_d.c)
/// @return whether `packed` is whole and gives `size` bytes; memory is taken only where that is possible
bool UnpackLzf(std::string_view packed, std::size_t size, std::string& unpacked);

}  // namespace lookout::importer
