// The commands of lookout-log. Several logs are read in their order, as one (rotated files).
#pragma once

#include <cstdio>
#include <filesystem>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

namespace lookout::log {

/// A wrong command line: exit code 2. All else that is thrown is 1.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Prints the contents of the logs: files and their damage, the writing program, and a line per channel.
/// @param progress  for people (runtime::OnlyTerminal); nullptr: silent. As below
/// @throws std::runtime_error when a file cannot be opened, or none holds an event
void Info(const std::vector<std::filesystem::path>& files, std::ostream& out, std::FILE* progress = nullptr);

struct SliceRequest {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path output;
  bool force = false;                 // an existing output is replaced
  std::string from;                   // as FindTime; empty = the start
  std::string to;                     // the first time that is left out; empty = the end
  std::vector<std::string> channels;  // empty = all
};

/// Writes the events of a time and of some channels, RUN_INFO first: the last one before `from`, with the time of the first event of the slice, so
/// that a player does not wait from the one to the other.
/// @throws UsageError; std::runtime_error also when there is no such event
void Slice(const SliceRequest& request, std::ostream& out, std::ostream& errors, std::FILE* progress = nullptr);

/// Writes every complete event of `input`, and prints losses: how many bytes, in which stretches, where.
/// @param force  an existing output is replaced
/// @throws std::runtime_error when `input` cannot be opened or holds no event, `output` exists or cannot be written
void Repair(const std::filesystem::path& input, const std::filesystem::path& output, bool force, std::ostream& out, std::ostream& errors,
            std::FILE* progress = nullptr);

}  // namespace lookout::log
