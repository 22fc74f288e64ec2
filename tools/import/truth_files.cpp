#include "tools/import/truth_files.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string_view>
#include <utility>

namespace lookout::importer {

namespace {

std::filesystem::path MadeFolder(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

std::uint16_t ClassOfLabel(std::uint32_t label) { return static_cast<std::uint16_t>(label & 0xFFFFU); }

std::string KindOf(const LabelMeaning& meaning, std::uint32_t label) {
  return meaning.name.empty() ? fmt::format("label {}", ClassOfLabel(label)) : meaning.name;
}

}  // namespace

TruthFiles::TruthFiles(const std::filesystem::path& folder, LabelMap map, bool force)
    : map_(std::move(map)),
      objects_file_(MadeFolder(folder) / "objects.csv", {.force = force}),
      outlines_file_(folder / "outlines.csv", {.force = force}),
      poses_file_(folder / "pose.csv", {.force = force}),
      returns_file_(folder / "returns.csv", {.force = force}) {
  returns_file_.Write(std::string_view("utime_us,ring,return_index,object_id,column\n"));
}

// 0: of no object.
int TruthFiles::ObjectOf(std::uint32_t label) {
  const auto meaning = map_.find(ClassOfLabel(label));
  num_unknown_ += meaning == map_.end() ? 1 : 0;
  if (meaning == map_.end() || meaning->second.use == LabelUse::kNone || meaning->second.use == LabelUse::kWater) return 0;
  return objects_.try_emplace(label, static_cast<int>(objects_.size()) + 1).first->second;
}

void TruthFiles::Add(const std::vector<lidar_scan_t>& parts, const std::vector<std::uint32_t>& labels) {
  if (labels.empty() || parts.empty()) return;
  ++num_scans_;
  std::string text;
  for (const auto& part : parts) {
    const auto num_rings = static_cast<std::size_t>(part.num_rings);
    const auto num_returns = static_cast<std::size_t>(part.num_returns);
    const auto first_cell = static_cast<std::size_t>(part.first_column) * num_rings * num_returns;
    for (std::size_t cell = 0; cell < part.range.size(); ++cell) {
      if (part.range[cell] == 0) continue;
      const auto column = cell / (num_rings * num_returns);
      const auto ring = cell / num_returns % num_rings;
      const auto utime_us = part.utime_us + (std::int64_t{part.time_ns[column]} + part.time_offset_ns[ring] + 500) / 1000;  // nearest, as the judge's
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", utime_us, ring, cell % num_returns, ObjectOf(labels[first_cell + cell]),
                     static_cast<std::size_t>(part.first_column) + column);
    }
  }
  returns_file_.Write(std::string_view(text));
}

void TruthFiles::Finish() {
  std::map<int, std::uint32_t> by_number;
  for (const auto& [label, number] : objects_) by_number.emplace(number, label);
  objects_file_.Write(std::string_view("object_id,name,kind,is_moving,is_in_water\n-1,own vessel,own vessel,0,0\n0,nothing,nothing,0,0\n"));
  for (const auto& [number, label] : by_number) {
    const auto& meaning = map_.at(ClassOfLabel(label));
    const auto kind = KindOf(meaning, label);
    const auto instance = label >> 16;
    const auto name = instance > 0 ? fmt::format("{} {}", kind, instance) : kind;
    objects_file_.Write(std::string_view(fmt::format("{},{},{},0,{}\n", number, name, kind, meaning.use == LabelUse::kObstacle ? 1 : 0)));
  }
  outlines_file_.Write(std::string_view("object_id,utime_us,vertex_index,latitude_deg,longitude_deg\n"));
  poses_file_.Write(std::string_view("utime_us,latitude_deg,longitude_deg,heading_deg,roll_deg,pitch_deg\n"));
  io::CommitAll({&objects_file_, &outlines_file_, &poses_file_, &returns_file_});
}

}  // namespace lookout::importer
