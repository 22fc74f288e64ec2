// The labels of imported scans as the truth that lookout-eval judges a log by.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/io/output_file.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tools/import/label_map.hpp"

namespace lookout::importer {

/// objects.csv, outlines.csv, pose.csv and returns.csv, as lookout-sim --truth writes them. Outlines and poses are not known: the tables are empty.
class TruthFiles {
 public:
  /// @throws std::runtime_error when a file is there already and `force` is not set, or the folder cannot be made
  TruthFiles(const std::filesystem::path& folder, LabelMap map, bool force);

  /// @param parts   all of one scan
  /// @param labels  of its cells; without any its cloud had none, and it is not in the truth
  void Add(const std::vector<lidar_scan_t>& parts, const std::vector<std::uint32_t>& labels);

  /// Writes what is left, and brings all files to their names. @throws std::runtime_error when they cannot be written
  void Finish();

  std::int64_t num_scans() const { return num_scans_; }
  std::int64_t num_objects() const { return std::ssize(objects_); }
  std::int64_t num_unknown() const { return num_unknown_; }  // returns of classes that the map has not

 private:
  int ObjectOf(std::uint32_t label);

  LabelMap map_;
  io::OutputFile objects_file_;
  io::OutputFile outlines_file_;
  io::OutputFile poses_file_;
  io::OutputFile returns_file_;
  std::map<std::uint32_t, int> objects_;  // by label, numbered from 1 as they come
  std::int64_t num_scans_ = 0;
  std::int64_t num_unknown_ = 0;
};

}  // namespace lookout::importer
