#include "tools/import/label_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <utility>

#include "common/config/text_config.hpp"

namespace lookout::importer {

namespace {

constexpr std::array<std::pair<std::string_view, LabelUse>, 4> kLabelUses{
    {{"none", LabelUse::kNone}, {"water", LabelUse::kWater}, {"land", LabelUse::kLand}, {"obstacle", LabelUse::kObstacle}}};

}  // namespace

const std::string_view kSemanticKittiLabels =
    "0 none unlabeled\n1 none outlier\n10 obstacle car\n11 obstacle bicycle\n13 obstacle bus\n15 obstacle motorcycle\n16 obstacle on-rails\n"
    "18 obstacle truck\n20 obstacle other-vehicle\n30 obstacle person\n31 obstacle bicyclist\n32 obstacle motorcyclist\n40 water road\n"
    "44 water parking\n48 water sidewalk\n49 water other-ground\n50 land building\n51 land fence\n52 land other-structure\n60 water lane-marking\n"
    "70 land vegetation\n71 land trunk\n72 land terrain\n80 obstacle pole\n81 obstacle traffic-sign\n99 obstacle other-object\n"
    "252 obstacle moving-car\n253 obstacle moving-bicyclist\n254 obstacle moving-person\n255 obstacle moving-motorcyclist\n"
    "256 obstacle moving-on-rails\n257 obstacle moving-bus\n258 obstacle moving-truck\n259 obstacle moving-other-vehicle\n";

const std::string_view kBoxLabels = "0 none\n1 obstacle ship\n2 obstacle buoy\n3 obstacle other\n";

LabelMap ParseLabelMap(const std::string& text, const std::string& name) {
  config::FaultList faults;
  LabelMap map;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string label;
    std::string use;
    LabelMeaning meaning;
    if (!(words >> label)) continue;
    words >> use >> meaning.name;
    const auto fault = [&](const std::string& reason) { faults.Add(fmt::format("{}:{}: {}", name, number, reason)); };
    std::uint16_t kind = 0;
    const auto [end, error] = std::from_chars(label.data(), label.data() + label.size(), kind);
    if (error != std::errc() || end != label.data() + label.size()) {
      fault("'" + label + "' is no class from 0 to 65535");
      continue;
    }
    const auto* const known = std::ranges::find(kLabelUses, std::string_view(use), &std::pair<std::string_view, LabelUse>::first);
    if (known == kLabelUses.end()) fault("'" + use + "' is none of water, land, obstacle, none");
    if (known != kLabelUses.end()) meaning.use = known->second;
    // It becomes a word of a table of comma separated values.
    std::ranges::replace(meaning.name, ',', '_');
    if (!map.try_emplace(kind, std::move(meaning)).second) fault("class " + label + " stands in a line before");
  }
  faults.ThrowIfAny();
  return map;
}

}  // namespace lookout::importer
