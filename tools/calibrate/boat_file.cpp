#include "tools/calibrate/boat_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/io/output_file.hpp"
#include "config/schema/boat.pb.h"

namespace lookout::calibrate {

namespace {

// The text with comments and strings as spaces, so that places stay the same.
std::string WithoutComments(const std::string& text) {
  std::string plain = text;
  char quote = 0;
  bool is_comment = false;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const char c = plain[i];
    if (c == '\n') {
      is_comment = false;
      quote = 0;
      continue;
    }
    if (is_comment || quote != 0) {
      plain[i] = ' ';
      if (quote != 0 && c == '\\' && i + 1 < plain.size() && plain[i + 1] != '\n') plain[++i] = ' ';
      if (c == quote) quote = 0;
    } else if (c == '#') {
      is_comment = true;
      plain[i] = ' ';
    } else if (c == '"' || c == '\'') {
      quote = c;
      plain[i] = ' ';
    }
  }
  return plain;
}

bool IsOfName(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool IsSpace(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

// Places of a name that stands alone, between two places.
std::optional<std::size_t> OnlyPlaceOf(std::string_view name, const std::string& plain, std::size_t from, std::size_t to) {
  std::optional<std::size_t> found;
  for (std::size_t at = plain.find(name, from); at != std::string::npos && at < to; at = plain.find(name, at + 1)) {
    const bool is_alone = (at == 0 || !IsOfName(plain[at - 1])) && (at + name.size() >= plain.size() || !IsOfName(plain[at + name.size()]));
    if (!is_alone) continue;
    if (found) return std::nullopt;
    found = at;
  }
  return found;
}

struct Range {
  std::size_t from = 0;
  std::size_t to = 0;
};

// The range of text between the braces of `lidar { }`.
std::optional<Range> LidarBlock(const std::string& plain) {
  const auto name = OnlyPlaceOf("lidar", plain, 0, plain.size());
  if (!name) return std::nullopt;
  std::size_t at = *name + std::string_view("lidar").size();
  while (at < plain.size() && (IsSpace(plain[at]) || plain[at] == ':')) ++at;
  if (at >= plain.size() || plain[at] != '{') return std::nullopt;
  const std::size_t end = plain.find('}', at);
  if (end == std::string::npos) return std::nullopt;
  return Range{at + 1, end};
}

std::optional<Range> NumberOf(std::string_view field, const std::string& plain, const Range& block) {
  const auto name = OnlyPlaceOf(field, plain, block.from, block.to);
  if (!name) return std::nullopt;
  std::size_t at = *name + field.size();
  while (at < block.to && (IsSpace(plain[at]) || plain[at] == ':')) ++at;
  std::size_t end = at;
  while (end < block.to && !IsSpace(plain[end]) && plain[end] != ',' && plain[end] != ';') ++end;
  if (end == at) return std::nullopt;
  return Range{at, end};
}

std::string DegreesText(double angle_rad) {
  // Without "-0.00".
  const auto text = fmt::format("{:.2f}", RadToDeg(angle_rad));
  return text == "-0.00" ? "0.00" : text;
}

std::string ReadText(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return text.str();
}

}  // namespace

std::string AngleLines(const Angles& angles) {
  return fmt::format("roll_deg: {} pitch_deg: {} yaw_deg: {}", DegreesText(angles.roll_rad), DegreesText(angles.pitch_rad),
                     DegreesText(angles.yaw_rad));
}

std::optional<std::string> WithAngles(const std::string& text, const Angles& angles) {
  std::string changed = text;
  const std::array<std::pair<std::string_view, double>, 3> fields{
      {{"roll_deg", angles.roll_rad}, {"pitch_deg", angles.pitch_rad}, {"yaw_deg", angles.yaw_rad}}};
  for (const auto& [field, angle_rad] : fields) {
    const auto plain = WithoutComments(changed);
    const auto block = LidarBlock(plain);
    if (!block) return std::nullopt;
    const auto number = NumberOf(field, plain, *block);
    if (!number) return std::nullopt;
    changed.replace(number->from, number->to - number->from, DegreesText(angle_rad));
  }
  return changed;
}

void WriteAngles(const std::filesystem::path& config_folder, const Angles& angles) {
  const auto file = config_folder / "boat.txtpb";
  const auto text = ReadText(file);
  const auto changed = WithAngles(text, angles);
  if (!changed)
    throw std::runtime_error(file.string() + ": the angles in lidar { } were not found; nothing is written, put the lines above there by hand");
  // All values but the angles are as they were.
  config::Boat before;
  config::Boat after;
  config::ParseText(text, file.string(), before);
  config::ParseText(*changed, file.string(), after);
  for (auto* boat : {&before, &after}) {
    boat->mutable_lidar()->clear_roll_deg();
    boat->mutable_lidar()->clear_pitch_deg();
    boat->mutable_lidar()->clear_yaw_deg();
  }
  if (before.SerializeAsString() != after.SerializeAsString()) {
    throw std::runtime_error(file.string() +
                             ": the angles in lidar { } could not be replaced; nothing is written, put the lines above there by hand");
  }
  io::OutputFile old(config_folder / "boat.txtpb.old");
  // Where boat.txtpb is a link, the file that it names is written.
  io::OutputFile output(std::filesystem::canonical(file), {.force = true});
  old.Write(text);
  output.Write(*changed);
  io::CommitAll({&old, &output});
}

}  // namespace lookout::calibrate
