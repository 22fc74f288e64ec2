#include "common/config/boat_sections.hpp"

#include <algorithm>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>

#include "common/config/text_config.hpp"
#include "config/schema/boat.pb.h"
#include "config/schema/options.pb.h"

namespace lookout::config {

namespace fs = std::filesystem;

namespace {

constexpr const char* kBoatFile = "boat.txtpb";
constexpr const char* kSuffix = ".txtpb";
// `lidar` of boat.txtpb is the place of the lidar.
constexpr const char* kLidarStem = "lidar";
constexpr const char* kLidarSection = "lidar_input";

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;

// Messages of boat.proto itself are facts; those of other schemas are sections.
bool IsSection(const FieldDescriptor& field) {
  return field.message_type() != nullptr && !field.is_repeated() && field.message_type()->file() != Boat::descriptor()->file();
}

const FieldDescriptor* SectionField(const std::string& file_name) {
  const fs::path name(file_name);
  if (name.extension() != kSuffix) return nullptr;
  const auto stem = name.stem().string();
  const auto* field = Boat::descriptor()->FindFieldByName(stem == kLidarStem ? kLidarSection : stem);
  return field != nullptr && IsSection(*field) ? field : nullptr;
}

std::string FileOf(const FieldDescriptor& section) { return (section.name() == kLidarSection ? kLidarStem : section.name()) + kSuffix; }

// A link without a target, and a file in a folder that may not be looked into, are there: reading them says what is wrong.
bool IsThere(const fs::path& file) {
  std::error_code error;
  return fs::symlink_status(file, error).type() != fs::file_type::not_found || OldConfigFile(file);
}

class NoErrors final : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int /*line*/, int /*column*/, const std::string& /*message*/) override {}
};

// boat.txtpb as far as it can be parsed: its faults are told by those who load it.
struct ParsedBoat {
  std::string text;
  Boat message;
  TextFormat::ParseInfoTree positions;
};

std::unique_ptr<ParsedBoat> ParseBoat(const fs::path& folder) {
  auto boat = std::make_unique<ParsedBoat>();
  FaultList untold;
  untold.Try([&] { boat->text = ReadConfigFile(folder / kBoatFile); });
  NoErrors errors;
  TextFormat::Parser parser;
  parser.RecordErrorsTo(&errors);
  parser.AllowPartialMessage(true);
  parser.WriteLocationsTo(&boat->positions);
  if (!parser.ParseFromString(boat->text, &boat->message)) boat->message.Clear();
  return boat;
}

bool Has(const ParsedBoat& boat, const FieldDescriptor& section) { return boat.message.GetReflection()->HasField(boat.message, &section); }

// All but the section is blank.
ValuesText CutOut(const fs::path& file, const ParsedBoat& boat, const FieldDescriptor& section) {
  const auto range = boat.positions.GetLocationRange(&section, -1);
  ValuesText values{file, {}, section.name() + ".", range.start.line + 1};
  std::istringstream lines(boat.text);
  int number = 0;
  for (std::string line; std::getline(lines, line); ++number) {
    const bool has_tabs = line.find('\t') != std::string::npos;  // columns count a tab up to the next multiple of eight
    if (number < range.start.line || number > range.end.line) line.clear();
    if (number == range.end.line && !has_tabs) line.resize(std::min(line.size(), static_cast<std::size_t>(std::max(0, range.end.column))));
    if (number == range.start.line && !has_tabs) {
      const auto begin = static_cast<std::ptrdiff_t>(std::min(line.size(), static_cast<std::size_t>(std::max(0, range.start.column))));
      std::fill(line.begin(), line.begin() + begin, ' ');
    }
    values.text += line + "\n";
  }
  return values;
}

// Where a file is absent, a file of a wrong name may have been meant.
void RefuseStrangers(const fs::path& folder) {
  std::vector<std::string> faults;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == kSuffix && SchemaOfFile(entry->path()) == nullptr) faults.push_back(NoSchemaFault(entry->path()));
  }
  std::ranges::sort(faults);
  if (!faults.empty()) throw ConfigError(faults);
}

void SetDefaults(const fs::path& file, Message& message) {
  ParseText("", file.string(), message);
  const auto& descriptor = *message.GetDescriptor();
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const auto& field = *descriptor.field(i);
    if (field.options().HasExtension(without_file)) {
      message.GetReflection()->SetString(&message, &field, field.options().GetExtension(without_file));
    }
  }
}

void RefuseBoth(const fs::path& folder, const std::string& file_name, const FieldDescriptor& section) {
  const auto boat = ParseBoat(folder);
  if (!Has(*boat, section)) return;
  const auto line = boat->positions.GetLocation(&section, -1).line + 1;
  throw ConfigError({(folder / kBoatFile).string() + ":" + std::to_string(line) + ": " + section.name() + ": stands beside " + file_name +
                     ", which holds the same values: keep one of both"});
}

}  // namespace

std::string SectionOf(const std::string& file_name) {
  const auto* section = SectionField(file_name);
  return section == nullptr ? std::string() : section->name();
}

std::string PlaceInWords(const fs::path& folder, const std::string& file_name) {
  const auto* section = SectionField(file_name);
  const bool is_section = section != nullptr && !IsThere(folder / file_name) && Has(*ParseBoat(folder), *section);
  return is_section ? section->name() + " in " + kBoatFile : file_name;
}

bool IsAbsent(const fs::path& folder, const std::string& file_name) {
  const auto* section = SectionField(file_name);
  return section != nullptr && !IsThere(folder / file_name) && !Has(*ParseBoat(folder), *section);
}

std::vector<std::string> FilesInForce(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == kSuffix) names.push_back(entry.path().filename().string());
  }
  const auto& boat = *Boat::descriptor();
  for (int i = 0; i < boat.field_count() && IsThere(folder / kBoatFile); ++i) {
    if (IsSection(*boat.field(i)) && !IsThere(folder / FileOf(*boat.field(i)))) names.push_back(FileOf(*boat.field(i)));
  }
  std::ranges::sort(names);
  return names;
}

std::string EffectiveTextOf(const fs::path& folder, const std::string& file_name) {
  if (file_name == kBoatFile) {
    auto boat = Load<Boat>(folder, file_name);
    for (int i = 0; i < Boat::descriptor()->field_count(); ++i) {
      const auto* field = Boat::descriptor()->field(i);
      if (IsSection(*field)) boat.GetReflection()->ClearField(&boat, field);
    }
    return EffectiveText(boat);
  }
  const auto* section = SectionField(file_name);
  if (section == nullptr) return EffectiveTextOfFile(folder / file_name);
  const std::unique_ptr<Message> message(google::protobuf::MessageFactory::generated_factory()->GetPrototype(section->message_type())->New());
  LoadOfBoat(folder, file_name, *message);
  return EffectiveText(*message);
}

ValuesText FindValues(const fs::path& file) {
  const auto* section = SectionField(file.filename().string());
  if (section == nullptr || IsThere(file)) return {file, ReadConfigFile(file)};
  const auto boat = ParseBoat(file.parent_path());
  if (!Has(*boat, *section)) return {file, {}};
  return CutOut(file.parent_path() / kBoatFile, *boat, *section);
}

std::string NoSchemaFault(const fs::path& file) { return file.string() + ":1: file: there is no config/schema/" + file.stem().string() + ".proto"; }

void LoadOfBoat(const fs::path& folder, const std::string& file_name, Message& message) {
  const auto file = folder / file_name;
  const auto* section = SectionField(file_name);
  if (section == nullptr || section->message_type() != message.GetDescriptor()) return LoadText(file, message);
  if (IsThere(file)) {
    FaultList faults;
    faults.Try([&] { LoadText(file, message); });
    faults.Try([&] { RefuseBoth(folder, file_name, *section); });
    return faults.ThrowIfAny();
  }
  Boat boat;
  LoadText(folder / kBoatFile, boat);
  RefuseStrangers(folder);
  if (boat.GetReflection()->HasField(boat, section)) {
    message.CopyFrom(boat.GetReflection()->GetMessage(boat, section));
  } else {
    SetDefaults(file, message);
  }
}

}  // namespace lookout::config
