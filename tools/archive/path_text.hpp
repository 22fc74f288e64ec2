// Names of files as printable text: for tables, JSON and SQL. Linux allows any byte but 0 and '/' in a name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lookout::archive {

/// @return printable UTF-8: control characters, '%' and bytes that are no UTF-8 as %XX
std::string PathText(const std::filesystem::path& path);

/// The inverse. @return nullopt where the text holds a '%' without two hexadecimal digits, or a zero byte
std::optional<std::filesystem::path> PathOfText(std::string_view text);

}  // namespace lookout::archive
