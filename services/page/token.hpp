// The token by which a browser may acknowledge alerts, and the folder in which the page keeps what outlasts it.
#pragma once

#include <filesystem>
#include <string>

namespace lookout::page {

/// $STATE_DIRECTORY (of systemd), else $XDG_STATE_HOME/lookout, else ~/.local/state/lookout. Absolute; need not be there.
/// @throws std::runtime_error when none of them is set
std::filesystem::path StateFolder();

/// Its name in the state folder.
inline constexpr const char* kTokenFile = "page-token";

/// The first line of a file that is private to its owner and group.
/// @throws std::runtime_error, with path and reason: no regular file, can be read by all or written by others, no token of 16 to 128 of A-Z a-z 0-9 -
/// _
std::string ReadToken(const std::filesystem::path& file);

/// As ReadToken. Where the file is missing it is made, with its folder: 128 random bits, for its owner alone.
/// @throws std::runtime_error as ReadToken, and when it cannot be made
std::string ReadOrMakeToken(const std::filesystem::path& file);

}  // namespace lookout::page
