#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "services/lidar/core/models/hesai.hpp"
#include "services/lidar/core/models/hesai_tables.hpp"

namespace lookout::lidar {

namespace {

constexpr std::size_t kMaxHesaiChannels = 128;

std::vector<HesaiAngle> EvenAngles(std::size_t num_channels, double top_deg, double step_deg) {
  std::vector<HesaiAngle> angles(num_channels);
  for (std::size_t channel = 0; channel < num_channels; ++channel) angles[channel].elevation_deg = top_deg - step_deg * static_cast<double>(channel);
  return angles;
}

std::vector<HesaiAngle> Qt128Angles() {
  std::vector<HesaiAngle> angles(hesai::kQt128LowerAngles.begin(), hesai::kQt128LowerAngles.end());
  angles.reserve(kMaxHesaiChannels);
  while (angles.size() < kMaxHesaiChannels) {
    const auto& mirrored = angles[kMaxHesaiChannels - 1 - angles.size()];
    angles.push_back({-mirrored.elevation_deg, -mirrored.azimuth_offset_deg});
  }
  return angles;
}

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\"";
  const auto begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view{} : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string_view> FieldsOf(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const auto end = line.find_first_of(",;\t");
    fields.push_back(Trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

std::optional<double> NumberOfField(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

/// Which field of a line is which.
struct AngleColumns {
  std::size_t channel = 0;
  std::size_t elevation = 1;
  std::size_t azimuth = 2;
};

bool IsOneOf(std::string_view title, std::initializer_list<std::string_view> words) {
  std::string lower(title);
  std::ranges::transform(lower, lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return std::ranges::any_of(words, [&](std::string_view word) { return lower.find(word) != std::string::npos; });
}

std::optional<AngleColumns> ColumnsOf(const std::vector<std::string_view>& titles) {
  const std::size_t none = titles.size();
  AngleColumns columns{none, none, none};
  for (std::size_t i = 0; i < titles.size(); ++i) {
    if (columns.elevation == none && IsOneOf(titles[i], {"elev", "vert", "pitch"})) {
      columns.elevation = i;
    } else if (columns.azimuth == none && IsOneOf(titles[i], {"azi", "hori", "yaw"})) {
      columns.azimuth = i;
    } else if (columns.channel == none && IsOneOf(titles[i], {"channel", "laser", "ring", "id"})) {
      columns.channel = i;
    }
  }
  if (columns.channel == none || columns.elevation == none || columns.azimuth == none) return std::nullopt;
  return columns;
}

[[noreturn]] void ThrowAtLine(std::size_t line, const std::string& reason) {
  throw std::runtime_error("line " + std::to_string(line) + ": " + reason);
}

}  // namespace

std::vector<HesaiAngle> NominalHesaiAngles(HesaiModel model) {
  switch (model) {
    case HesaiModel::kXt16:
      return EvenAngles(16, 15.0, 2.0);
    case HesaiModel::kXt32:
      return EvenAngles(32, 15.0, 1.0);
    case HesaiModel::kXt32m:
      return EvenAngles(32, 19.5, 1.3);
    case HesaiModel::kQt64:
      return {hesai::kQt64Angles.begin(), hesai::kQt64Angles.end()};
    case HesaiModel::kQt128:
      return Qt128Angles();
    case HesaiModel::kPandar40p:
      return {hesai::kPandar40pAngles.begin(), hesai::kPandar40pAngles.end()};
    case HesaiModel::kPandar64:
      return {hesai::kPandar64Angles.begin(), hesai::kPandar64Angles.end()};
  }
  return {};
}

std::vector<HesaiAngle> ParseHesaiAngles(std::string_view csv) {
  constexpr std::size_t kMaxBytes = 65'536;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (csv.size() > kMaxBytes) throw std::runtime_error("has more than " + std::to_string(kMaxBytes) + " bytes: no table of angles");
  if (csv.starts_with(kByteOrderMark)) csv.remove_prefix(kByteOrderMark.size());
  std::array<std::optional<HesaiAngle>, kMaxHesaiChannels> found;
  std::size_t num_channels = 0;
  AngleColumns columns;
  bool is_first = true;
  for (std::size_t line = 1; !csv.empty(); ++line) {
    const auto end = csv.find('\n');
    const auto text = Trimmed(csv.substr(0, end));
    csv.remove_prefix(end == std::string_view::npos ? csv.size() : end + 1);
    if (text.empty() || text.starts_with('#')) continue;
    const auto fields = FieldsOf(text);
    if (is_first && IsOneOf(fields[0], {"eeff"})) continue;  // a mark and version, in newer files of the maker
    const bool is_title = is_first && !NumberOfField(fields[0]);
    is_first = false;
    if (is_title) {
      const auto titled = ColumnsOf(fields);
      if (!titled) ThrowAtLine(line, "must have the titles Channel, Elevation and Azimuth");
      columns = *titled;
      continue;
    }
    if (fields.size() <= std::max({columns.channel, columns.elevation, columns.azimuth})) {
      ThrowAtLine(line, "must have a channel, an elevation and an azimuth");
    }
    const auto channel = NumberOfField(fields[columns.channel]);
    const auto elevation_deg = NumberOfField(fields[columns.elevation]);
    const auto azimuth_deg = NumberOfField(fields[columns.azimuth]);
    if (!channel || !elevation_deg || !azimuth_deg) ThrowAtLine(line, "channel, elevation and azimuth must be numbers");
    if (*channel < 1.0 || *channel > static_cast<double>(kMaxHesaiChannels) || *channel != std::floor(*channel)) {
      ThrowAtLine(line, "channel must be 1 to " + std::to_string(kMaxHesaiChannels));
    }
    if (std::abs(*elevation_deg) > 90.0) ThrowAtLine(line, "elevation must be within -90 and 90 deg");
    if (std::abs(*azimuth_deg) > 360.0) ThrowAtLine(line, "azimuth must be within -360 and 360 deg");
    const auto index = static_cast<std::size_t>(*channel) - 1;
    if (found[index]) ThrowAtLine(line, "channel " + std::to_string(index + 1) + " is there twice");
    found[index] = HesaiAngle{*elevation_deg, *azimuth_deg >= 180.0   ? *azimuth_deg - 360.0
                                              : *azimuth_deg < -180.0 ? *azimuth_deg + 360.0
                                                                      : *azimuth_deg};
    num_channels = std::max(num_channels, index + 1);
  }
  if (num_channels == 0) throw std::runtime_error("has no channels");
  std::vector<HesaiAngle> angles;
  angles.reserve(num_channels);
  for (std::size_t i = 0; i < num_channels; ++i) {
    if (!found[i]) throw std::runtime_error("channel " + std::to_string(i + 1) + " is missing");
    angles.push_back(*found[i]);
  }
  const auto is_level = [&](const HesaiAngle& angle) { return angle.elevation_deg == angles[0].elevation_deg; };
  if (num_channels > 1 && std::ranges::all_of(angles, is_level)) throw std::runtime_error("all channels have the same elevation");
  return angles;
}

}  // namespace lookout::lidar
