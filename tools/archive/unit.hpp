// A unit of work: a run, or a part of it, under a version of config and programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lookout::archive {

/// The inputs that determine every byte of a result, in words.
struct Recipe {
  std::string run_digest;
  std::string run_kind;
  std::optional<std::int64_t> from_us;  // part of a run
  std::optional<std::int64_t> to_us;
  std::string truth_digest;  // empty: none
  std::string config_digest;
  std::string programs_digest;
  std::string program_version;
  std::vector<std::string> tables;

  bool operator==(const Recipe&) const = default;
};

/// An input file, where a worker finds it.
struct InputFile {
  std::filesystem::path path;
  std::int64_t size_bytes = 0;
  std::int64_t modified_ns = 0;
};

struct Unit {
  std::string key;
  Recipe recipe;
  std::string run;  // the run's name
  std::vector<InputFile> inputs;
  std::filesystem::path truth;
  std::filesystem::path programs;
};

/// As JSON, in one line; the keys of objects are sorted.
std::string RecipeText(const Recipe& recipe);

/// SHA-256 of the recipe and the format, hexadecimal.
std::string KeyOf(const Recipe& recipe);

/// A line of a list of units, and back. @throws std::runtime_error for a line that is none, or whose key does not belong to its recipe
std::string UnitLine(const Unit& unit);
Unit UnitOfLine(const std::string& line);

}  // namespace lookout::archive
