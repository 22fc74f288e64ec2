// Numbers and foreign text in columns of a fixed width. ASCII only.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::top {

/// Right-aligned. Where the number is too wide, decimals go first, then "###" stands for it; "-" for a value that is not finite.
std::string Number(double value, int width, int decimals);

/// Right-aligned. Where it is too wide: thousands "12k", millions "12M", billions "12G", else "###".
std::string Count(std::int64_t count, int width);

/// Left-aligned, cut to the width.
std::string Left(std::string_view text, int width);

/// Right-aligned, cut to the width.
std::string Right(std::string_view text, int width);

/// As many of the cells, one beside the other, as are whole within the width; the first is cut to it.
std::string Fitting(const std::vector<std::string>& cells, int width);

/// Words of printable `text` in lines of at most `width`; a longer word is broken. Text beyond `max_lines` ends in "..". Precondition: width >= 3,
/// max_lines >= 1.
std::vector<std::string> Wrapped(std::string_view text, int width, int max_lines);

/// Whole degrees of the circle, "000" to "359"; "-" for a value that is not finite.
std::string Degrees(double angle_rad);

}  // namespace lookout::top
