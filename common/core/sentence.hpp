// A sentence of NMEA 0183: its checksum, and its fields as values, strictly. A field has its exact form and its range, or the sentence is refused as
// a whole.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/geodesy.hpp"

namespace lookout {

/// Why a line is not a sentence, or not one with values that can be.
enum class SentenceFault {
  kNone,
  kNoChecksum,   // no * in the line
  kBadChecksum,  // the two hexadecimal digits behind the * are not the exclusive or of the characters before it
  kBadField,     // a field is missing or does not have its form
  kImplausible,  // a value is out of its range
};

/// "$" body "*" checksum, without CR LF.
std::string WithChecksum(std::string_view body);

/// A line whose checksum is right. Views into the line.
struct FramedSentence {
  std::string_view address;              // talker and type: "GPRMC", "PASHR", "04HDM"
  std::vector<std::string_view> fields;  // behind the address, without spaces around; empty = not said
};

struct FrameResult {
  SentenceFault fault = SentenceFault::kNone;
  FramedSentence sentence;
};

/// @param line               from $ or ! to its end, without CR LF; must outlive the result
/// @param requires_checksum  false: a line without * is accepted too
FrameResult Frame(std::string_view line, bool requires_checksum = true);

/// Reads fields by index and remembers the first fault. An empty field is no fault: it says nothing (NaN or nullopt). A field behind the last
/// is a fault.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::string_view> fields) : fields_(fields) {}

  SentenceFault fault() const { return fault_; }
  std::size_t size() const { return fields_.size(); }

  /// Remembers the fault, unless there was one before. @return `value`
  template <typename T>
  T Fail(SentenceFault fault, T value) {
    if (fault_ == SentenceFault::kNone) fault_ = fault;
    return value;
  }

  /// As it stands. @return empty when at fault
  std::string_view Text(std::size_t index);

  bool IsEmpty(std::size_t index) { return Text(index).empty(); }

  /// [+-]digits[.digits], between min and max. @return NaN when empty or at fault
  double Number(std::size_t index, double min, double max);

  /// digits, between 0 and max. @return -1 when empty or at fault
  int Count(std::size_t index, int max);

  /// One character out of `allowed`. @return '\0' when empty or at fault
  char Letter(std::size_t index, std::string_view allowed);

  /// A number, and behind it the letter of its unit, which must stand there when the number does.
  double NumberWithUnit(std::size_t index, char unit, double min, double max);

  /// A number of degrees, and behind it E or W, which must stand there when the number does. @return negative for W
  double NumberWithSide(std::size_t index, double max);

  /// Hexadecimal digits, at most four. @return -1 when empty or at fault
  int Hex(std::size_t index);

  /// hhmmss[.s...], UTC. @return since midnight; 24 h for the leap second 235960, which Utime does not count
  std::optional<std::chrono::microseconds> TimeOfDay(std::size_t index);

  /// ddmmyy. Years 80 to 99 are of the 20th century (GPS begins in 1980).
  std::optional<std::chrono::sys_days> Date(std::size_t index);

  /// Day, month and year (of four digits, or two as above), each a field: all there or all empty.
  std::optional<std::chrono::sys_days> Date(std::size_t day_index, std::size_t month_index, std::size_t year_index);

  /// ddmm[.m...],N|S,dddmm[.m...],E|W: four fields, all there or all empty; degrees padded with zeros to any width, or not. The height stays 0.
  std::optional<GeodeticPlace> Position(std::size_t index);

 private:
  std::optional<std::chrono::sys_days> Checked(int day, int month, int year);
  double Angle(std::size_t index, double max_deg);
  bool MayBeInDegrees(std::size_t index);

  std::span<const std::string_view> fields_;
  SentenceFault fault_ = SentenceFault::kNone;
};

}  // namespace lookout
