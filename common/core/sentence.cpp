#include "common/core/sentence.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace lookout {

namespace {

using std::chrono::microseconds;

bool IsDigit(char character) { return character >= '0' && character <= '9'; }

bool AreDigits(std::string_view text) { return std::ranges::all_of(text, IsDigit); }

// digits[.digits], at least one digit.
bool IsUnsignedNumber(std::string_view text) {
  const auto point = text.find('.');
  const auto whole = text.substr(0, point);
  const auto fraction = point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
  return whole.size() + fraction.size() > 0 && AreDigits(whole) && AreDigits(fraction);
}

// Precondition: IsUnsignedNumber, with a sign - in front or none.
double ToDouble(std::string_view text) {
  double value = kNan;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// Years 80 to 99 are of the 20th century.
int FullYear(int short_year) { return short_year + (short_year >= 80 ? 1900 : 2000); }

// Precondition: AreDigits, at most 9 of them.
int ToInt(std::string_view digits) {
  int value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

// Some receivers fill a field with spaces to its width: "3.890, 90.0,".
std::string_view WithoutSpacesAround(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

unsigned ChecksumOf(std::string_view body) {
  unsigned checksum = 0;
  for (const char character : body) checksum ^= static_cast<unsigned char>(character);
  return checksum;
}

// Behind the digits there may be blanks.
bool IsChecksumOf(std::string_view digits, std::string_view body) {
  while (!digits.empty() && (digits.back() == ' ' || digits.back() == '\t')) digits.remove_suffix(1);
  if (digits.size() != 2) return false;
  unsigned stated = 0;
  const auto* const end = digits.data() + digits.size();
  const bool is_hexadecimal = std::from_chars(digits.data(), end, stated, 16).ptr == end;
  return is_hexadecimal && stated == ChecksumOf(body);
}

}  // namespace

std::string WithChecksum(std::string_view body) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  const auto checksum = ChecksumOf(body);
  return "$" + std::string(body) + "*" + kDigits[checksum >> 4] + kDigits[checksum & 15];
}

FrameResult Frame(std::string_view line, bool requires_checksum) {
  const auto star = line.rfind('*');
  const bool has_star = star != std::string_view::npos && star != 0;
  if (!has_star && (requires_checksum || line.empty())) return {SentenceFault::kNoChecksum, {}};
  auto body = has_star ? line.substr(1, star - 1) : line.substr(1);
  if (has_star && !IsChecksumOf(line.substr(star + 1), body)) return {SentenceFault::kBadChecksum, {}};

  FrameResult result;
  const auto address_end = std::min(body.find(','), body.size());
  result.sentence.address = body.substr(0, address_end);
  body.remove_prefix(address_end);
  while (!body.empty()) {
    body.remove_prefix(1);  // the comma
    const auto end = std::min(body.find(','), body.size());
    result.sentence.fields.push_back(WithoutSpacesAround(body.substr(0, end)));
    body.remove_prefix(end);
  }
  return result;
}

std::string_view FieldReader::Text(std::size_t index) {
  return index < fields_.size() ? fields_[index] : Fail(SentenceFault::kBadField, std::string_view{});
}

double FieldReader::Number(std::size_t index, double min, double max) {
  auto text = Text(index);
  if (text.empty()) return kNan;
  const bool has_sign = text.front() == '+' || text.front() == '-';
  if (!IsUnsignedNumber(text.substr(has_sign ? 1 : 0))) return Fail(SentenceFault::kBadField, kNan);
  if (text.front() == '+') text.remove_prefix(1);
  const double value = ToDouble(text);
  if (!(value >= min && value <= max)) return Fail(SentenceFault::kImplausible, kNan);
  return value;
}

int FieldReader::Count(std::size_t index, int max) {
  const auto text = Text(index);
  if (text.empty()) return -1;
  if (!AreDigits(text) || text.size() > 9) return Fail(SentenceFault::kBadField, -1);
  const int value = ToInt(text);
  if (value > max) return Fail(SentenceFault::kImplausible, -1);
  return value;
}

char FieldReader::Letter(std::size_t index, std::string_view allowed) {
  const auto text = Text(index);
  if (text.empty()) return '\0';
  if (text.size() != 1 || allowed.find(text.front()) == std::string_view::npos) return Fail(SentenceFault::kBadField, '\0');
  return text.front();
}

double FieldReader::NumberWithUnit(std::size_t index, char unit, double min, double max) {
  const double value = Number(index, min, max);
  const char letter = Letter(index + 1, std::string_view(&unit, 1));
  return !std::isnan(value) && letter == '\0' ? Fail(SentenceFault::kBadField, value) : value;
}

double FieldReader::NumberWithSide(std::size_t index, double max) {
  const double value = Number(index, 0.0, max);
  const char side = Letter(index + 1, "EW");
  if (!std::isnan(value) && side == '\0') return Fail(SentenceFault::kBadField, kNan);
  return side == 'W' ? -value : value;
}

int FieldReader::Hex(std::size_t index) {
  constexpr std::size_t kMaxDigits = 4;
  constexpr int kBase = 16;
  const auto text = Text(index);
  if (text.empty()) return -1;
  int value = -1;
  const auto end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, kBase);
  if (text.size() > kMaxDigits || error != std::errc{} || stop != end || value < 0) return Fail(SentenceFault::kBadField, -1);
  return value;
}

std::optional<microseconds> FieldReader::TimeOfDay(std::size_t index) {
  using namespace std::chrono_literals;
  const auto text = Text(index);
  if (text.empty()) return std::nullopt;
  const auto whole = text.substr(0, text.find('.'));
  if (whole.size() != 6 || !IsUnsignedNumber(text)) return Fail(SentenceFault::kBadField, std::nullopt);
  const int hour = ToInt(whole.substr(0, 2));
  const int minute = ToInt(whole.substr(2, 2));
  const int second = ToInt(whole.substr(4, 2));
  const bool is_leap_second = hour == 23 && minute == 59 && second == 60;
  if (hour > 23 || minute > 59 || (second > 59 && !is_leap_second)) return Fail(SentenceFault::kImplausible, std::nullopt);
  // Parts of a microsecond are dropped.
  microseconds time = std::chrono::hours(hour) + std::chrono::minutes(minute) + std::chrono::seconds(second);
  microseconds unit = 100ms;
  for (std::size_t i = whole.size() + 1; i < text.size() && unit > 0us; ++i, unit /= 10) time += (text[i] - '0') * unit;
  return time;
}

std::optional<std::chrono::sys_days> FieldReader::Date(std::size_t index) {
  const auto text = Text(index);
  if (text.empty()) return std::nullopt;
  if (text.size() != 6 || !AreDigits(text)) return Fail(SentenceFault::kBadField, std::nullopt);
  return Checked(ToInt(text.substr(0, 2)), ToInt(text.substr(2, 2)), FullYear(ToInt(text.substr(4, 2))));
}

std::optional<std::chrono::sys_days> FieldReader::Date(std::size_t day_index, std::size_t month_index, std::size_t year_index) {
  constexpr int kLastYear = 2199;  // Utime ends before 2200
  const int day = Count(day_index, 31);
  const int month = Count(month_index, 12);
  const int year = Count(year_index, kLastYear);
  if (day < 0 && month < 0 && year < 0) return std::nullopt;
  if (day < 0 || month < 0 || year < 0) return Fail(SentenceFault::kBadField, std::nullopt);
  // Plotters that write ZDA themselves write two digits (B&G, in SignalK's recording of a boat's network).
  return Checked(day, month, year < 100 ? FullYear(year) : year);
}

std::optional<std::chrono::sys_days> FieldReader::Checked(int day, int month, int year) {
  constexpr int kFirstYear = 1980;  // GPS begins
  const std::chrono::year_month_day date(std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (!date.ok() || year < kFirstYear) return Fail(SentenceFault::kImplausible, std::nullopt);
  return std::chrono::sys_days(date);
}

// The last two digits before the point are minutes, what stands before them is degrees, padded or not: 01012.000, 1012.000, 0.840 and .840.
double FieldReader::Angle(std::size_t index, double max_deg) {
  constexpr std::size_t kMinuteDigits = 2;
  constexpr std::size_t kMaxDigits = 9;
  const auto text = Text(index);
  const auto num_digits = text.substr(0, text.find('.')).size();
  if (num_digits > kMaxDigits || !IsUnsignedNumber(text)) return Fail(SentenceFault::kBadField, kNan);
  const auto num_degree_digits = num_digits - std::min(num_digits, kMinuteDigits);
  const double minutes = ToDouble(text.substr(num_degree_digits));
  const double angle_deg = ToInt(text.substr(0, num_degree_digits)) + minutes / 60.0;
  if (minutes >= 60.0 || angle_deg > max_deg) return Fail(SentenceFault::kImplausible, kNan);
  return angle_deg;
}

// A place in degrees and their fraction (54.5,N,10.2,E), as some programs write it by mistake, would be read as minutes, and lie elsewhere. It has at
// most two digits before the point of its latitude and three of its longitude. So has, not padded, a place within a degree of the equator and ten of
// Greenwich: that one is refused with it.
bool FieldReader::MayBeInDegrees(std::size_t index) {
  constexpr std::size_t kMaxLatitudeDigits = 2;
  constexpr std::size_t kMaxLongitudeDigits = 3;
  const auto num_digits = [this](std::size_t field) { return Text(field).substr(0, Text(field).find('.')).size(); };
  return num_digits(index) <= kMaxLatitudeDigits && num_digits(index + 2) <= kMaxLongitudeDigits;
}

std::optional<GeodeticPlace> FieldReader::Position(std::size_t index) {
  if (IsEmpty(index) && IsEmpty(index + 1) && IsEmpty(index + 2) && IsEmpty(index + 3)) return std::nullopt;
  if (MayBeInDegrees(index)) return Fail(SentenceFault::kBadField, std::nullopt);
  GeodeticPlace position{Angle(index, 90.0), Angle(index + 2, 180.0)};
  const char latitude_letter = Letter(index + 1, "NS");
  const char longitude_letter = Letter(index + 3, "EW");
  if (latitude_letter == '\0' || longitude_letter == '\0') return Fail(SentenceFault::kBadField, std::nullopt);
  if (fault_ != SentenceFault::kNone) return std::nullopt;
  if (latitude_letter == 'S') position.latitude_deg = -position.latitude_deg;
  if (longitude_letter == 'W') position.longitude_deg = -position.longitude_deg;
  return position;
}

}  // namespace lookout
