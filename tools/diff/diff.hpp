// Two logs, message by message.
#pragma once

#include <cstdio>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "tools/diff/compare.hpp"

namespace lookout::diff {

inline constexpr int kExitEqual = 0;
inline constexpr int kExitDifferent = 1;
inline constexpr int kExitUnreadable = 2;  // or a wrong command line

struct Request {
  std::filesystem::path a;
  std::filesystem::path b;
  std::vector<std::string> channels;                     // empty = all but HEALTH, RUN_INFO and LCM_SELF_TEST
  Tolerances tolerances;                                 // on every channel
  std::map<std::string, Tolerances> channel_tolerances;  // instead of `tolerances`
  std::FILE* progress = nullptr;                         // for people (runtime::OnlyTerminal); nullptr: silent
};

/// Takes "FIELD=VALUE" or "CHANNEL:FIELD=VALUE" into `request`, after all of the former.
/// @throws std::runtime_error when it is neither, or VALUE is no number of 0 or more
void AddTolerance(const std::string& text, Request& request);

/// Compares the payloads of each channel in their order, the n-th of one log with the n-th of the other, and prints a line per channel. Times at
/// which events were logged are not compared: they are of the machine.
///
/// @param out     the table
/// @param errors  damage, and why the exit code is 2
/// @return an exit code
int Run(const Request& request, std::ostream& out, std::ostream& errors);

}  // namespace lookout::diff
