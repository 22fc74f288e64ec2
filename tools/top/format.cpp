#include "tools/top/format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::top {

namespace {

std::size_t SizeOf(int width) { return static_cast<std::size_t>(std::max(width, 0)); }

}  // namespace

std::string Left(std::string_view text, int width) { return fmt::format("{:<{}.{}}", text, SizeOf(width), SizeOf(width)); }

std::string Right(std::string_view text, int width) { return fmt::format("{:>{}.{}}", text, SizeOf(width), SizeOf(width)); }

std::string Number(double value, int width, int decimals) {
  if (!std::isfinite(value)) return Right("-", width);
  // Beyond any column's width; a larger number would print hundreds of digits.
  constexpr double kTooLarge = 1e15;
  for (int places = decimals; places >= 0 && std::abs(value) < kTooLarge; --places) {
    std::string text = fmt::format("{:.{}f}", value, places);
    if (text.find_first_not_of("-0.") == std::string::npos) text.erase(0, text.front() == '-' ? 1 : 0);  // no "-0.0"
    if (text.size() <= SizeOf(width)) return Right(text, width);
  }
  return std::string(SizeOf(width), '#');
}

std::string Count(std::int64_t count, int width) {
  std::string text = fmt::format("{}", count);
  for (const char unit : {'k', 'M', 'G'}) {
    if (text.size() <= SizeOf(width)) return Right(text, width);
    count /= 1000;
    text = fmt::format("{}{}", count, unit);
  }
  return text.size() <= SizeOf(width) ? Right(text, width) : std::string(SizeOf(width), '#');
}

std::string Fitting(const std::vector<std::string>& cells, int width) {
  std::string line;
  for (const auto& cell : cells) {
    if (line.empty()) {
      line = cell.substr(0, SizeOf(width));
    } else if (line.size() + cell.size() <= SizeOf(width)) {
      line += cell;
    } else {
      break;
    }
  }
  return line;
}

std::vector<std::string> Wrapped(std::string_view text, int width, int max_lines) {
  const std::size_t line_size = SizeOf(width);
  std::vector<std::string> lines;
  while (!text.empty()) {
    if (lines.size() == SizeOf(max_lines)) {
      auto& last = lines.back();
      last = last.substr(0, std::min(last.size(), line_size - 2)) + "..";
      break;
    }
    std::size_t size = text.size();
    if (size > line_size) {
      const auto space = text.rfind(' ', line_size);
      size = space == std::string_view::npos || space == 0 ? line_size : space;
    }
    lines.emplace_back(text.substr(0, size));
    text.remove_prefix(std::min(text.size(), text.find_first_not_of(' ', size)));
  }
  return lines;
}

std::string Degrees(double angle_rad) {
  if (!std::isfinite(angle_rad)) return "-";
  return fmt::format("{:03}", std::lround(RadToDeg(WrapTo2Pi(angle_rad))) % 360);
}

}  // namespace lookout::top
