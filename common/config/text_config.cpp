#include "common/config/text_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/text_format.h>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/config/boat_sections.hpp"
#include "common/config/schemas.hpp"
#include "common/config/text_salvage.hpp"
#include "config/schema/options.pb.h"

namespace lookout::config {

namespace {

// The file of the lidar had the name of the only model that was read.
constexpr const char* kLidarFile = "lidar.txtpb";
constexpr const char* kOldLidarFile = "vlp16.txtpb";

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;

// Shortest decimal that reads back as the same number.
std::string NumberText(double value) {
  std::array<char, 32> text{};
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    if (std::strtod(text.data(), nullptr) == value) break;
  }
  return text.data();
}

// The message of a schema file.
const Descriptor* FindSchema(const std::string& schema_file) {
  const auto found = std::ranges::find(Schemas(), schema_file, [](const Descriptor* descriptor) { return descriptor->file()->name(); });
  return found == Schemas().end() ? nullptr : *found;
}

// More than these help nobody, and a text of nonsense has thousands.
constexpr std::size_t kMaxFaults = 100;

// Fields of before, which files of boats may still have.
struct GoneField {
  std::string_view message;
  std::string_view field;
  std::string_view reason;  // and the cure
};
constexpr std::array kGoneFields{
    GoneField{"lookout.config.Tracker", "map",
              "is gone: the tracker reads no map. Delete the line; lookout-export --table map makes the map out of the logs of many days"},
    GoneField{"lookout.config.Tracker", "warning_tcpa_s",
              "is gone: a warning means that no more time is left than this boat needs. Delete the line, and set reaction_s, deceleration_mps2 and "
              "turn_rate_degps"},
    GoneField{"lookout.config.Georeferencer", "guard_zone", "is gone from here: move it to tracker.txtpb"}};

// In place of Protobuf's "no field named".
void SayWhatIsGone(const Descriptor& schema, std::vector<TextFault>& faults) {
  for (auto& fault : faults) {
    const auto gone =
        std::ranges::find_if(kGoneFields, [&](const GoneField& one) { return one.message == schema.full_name() && one.field == fault.field; });
    if (gone != kGoneFields.end() && fault.reason.find("has no field named") != std::string::npos) fault.reason = gone->reason;
  }
}

class FaultCollector final : public google::protobuf::io::ErrorCollector {
 public:
  explicit FaultCollector(std::vector<TextFault>& faults) : faults_(faults) {}
  void AddError(int line, int column, const std::string& message) override {
    // Lines and columns count from 0; -1 stands for the whole text.
    faults_.push_back({line, "text", "column " + std::to_string(column + 1) + ": " + message});
  }

 private:
  std::vector<TextFault>& faults_;
};

std::optional<double> NumberOf(const Message& message, const FieldDescriptor& field, int index) {
  const auto& reflection = *message.GetReflection();
  const bool is_list = field.is_repeated();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return is_list ? reflection.GetRepeatedDouble(message, &field, index) : reflection.GetDouble(message, &field);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return is_list ? reflection.GetRepeatedFloat(message, &field, index) : reflection.GetFloat(message, &field);
    case FieldDescriptor::CPPTYPE_INT32:
      return is_list ? reflection.GetRepeatedInt32(message, &field, index) : reflection.GetInt32(message, &field);
    case FieldDescriptor::CPPTYPE_INT64: {
      const auto value = is_list ? reflection.GetRepeatedInt64(message, &field, index) : reflection.GetInt64(message, &field);
      return static_cast<double>(value);  // limits are round numbers: a value that rounds onto one is as good as it
    }
    default:
      return std::nullopt;
  }
}

std::string RangeFault(const google::protobuf::FieldOptions& options, double value) {
  if (!std::isfinite(value)) return "must be a finite number";
  if (options.HasExtension(min) && value < options.GetExtension(min)) return "must be at least " + NumberText(options.GetExtension(min));
  if (options.HasExtension(max) && value > options.GetExtension(max)) return "must be at most " + NumberText(options.GetExtension(max));
  return "";
}

// Walks a parsed message and its positions in the text, and collects violations of the schema's options.
class Checker {
 public:
  /// @param refused  fields whose values were wrong by themselves, by path and line of their message: they are set, but not here
  Checker(const std::set<std::pair<std::string, int>>& refused, std::vector<TextFault>& faults) : refused_(refused), faults_(faults) {}

  void Check(const Message& message, const TextFormat::ParseInfoTree* positions, const std::string& prefix, int line_of_message) {
    const auto& reflection = *message.GetReflection();
    const Descriptor& descriptor = *message.GetDescriptor();
    for (int i = 0; i < descriptor.field_count(); ++i) {
      const FieldDescriptor& field = *descriptor.field(i);
      const std::string path = prefix + field.name();
      const bool is_list = field.is_repeated();
      const int count = is_list ? reflection.FieldSize(message, &field) : (reflection.HasField(message, &field) ? 1 : 0);
      const bool may_miss = is_list || field.has_default_value() || field.options().GetExtension(may_be_absent);
      if (count == 0 && !may_miss && !refused_.contains({path, line_of_message})) {
        Add(line_of_message, path, "must be set");
      }
      for (int k = 0; k < count; ++k) {
        const int index = is_list ? k : -1;
        int line = positions == nullptr ? -1 : positions->GetLocation(&field, index).line;
        // The values of a list in brackets have no places of their own.
        if (line < 0) line = line_of_message;
        if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
          const auto& part = is_list ? reflection.GetRepeatedMessage(message, &field, k) : reflection.GetMessage(message, &field);
          Check(part, positions == nullptr ? nullptr : positions->GetTreeForNested(&field, index), path + ".", line);
        } else if (const auto number = NumberOf(message, field, k)) {
          const std::string reason = RangeFault(field.options(), *number);
          if (!reason.empty()) Add(line, path, reason + " (is " + NumberText(*number) + ")");
        }
      }
    }
  }

 private:
  void Add(int line, const std::string& field, const std::string& reason) { faults_.push_back({std::max(line, 0), field, reason}); }

  const std::set<std::pair<std::string, int>>& refused_;
  std::vector<TextFault>& faults_;
};

// The first bytes of files whose editor marks their coding; empty = none.
std::string ByteOrderMark(const std::string& text) {
  if (text.starts_with("\xEF\xBB\xBF"))
    return "begins with a byte order mark (EF BB BF): save it as UTF-8 without one (\"UTF-8\", not \"UTF-8 with BOM\")";
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return "is UTF-16 (it begins with its byte order mark): save it as UTF-8";
  return {};
}

}  // namespace

void FaultList::Try(const std::function<void()>& check) {
  try {
    check();
  } catch (const ConfigError& error) {
    for (const auto& fault : error.faults()) Add(fault);
  }
}

void FaultList::Add(const std::string& fault) {
  if (std::ranges::find(faults_, fault) == faults_.end()) faults_.push_back(fault);
}

void FaultList::ThrowIfAny() const {
  if (!faults_.empty()) throw ConfigError(faults_);
}

ConfigError::ConfigError(std::vector<std::string> faults)
    : std::runtime_error(fmt::format("{}", fmt::join(faults, "\n"))), faults_(std::move(faults)) {}

std::optional<std::filesystem::path> OldConfigFile(const std::filesystem::path& file) {
  if (file.filename() != kLidarFile || std::filesystem::exists(file)) return std::nullopt;
  auto old = file.parent_path() / kOldLidarFile;
  return std::filesystem::is_regular_file(old) ? std::optional(std::move(old)) : std::nullopt;
}

std::string ReadConfigFile(const std::filesystem::path& named) {
  const auto file = OldConfigFile(named).value_or(named);
  const auto refuse = [&file](const std::string& reason) { throw ConfigError({file.string() + ":1: file: " + reason}); };
  // Looked at before it is opened: to open a FIFO waits for a writer.
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (std::filesystem::is_directory(status)) refuse("is a folder");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) refuse("is no regular file (a FIFO, a socket or a device)");
  std::ifstream in;
  if (std::filesystem::is_regular_file(status)) in.open(file, std::ios::binary);
  if (!in.is_open()) refuse("cannot be read");
  std::string text(kMaxConfigBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxConfigBytes) refuse("is greater than " + std::to_string(kMaxConfigBytes) + " bytes: no config");
  return text;
}

void ParseText(const std::string& text, const std::string& name, Message& message) {
  if (const auto mark = ByteOrderMark(text); !mark.empty()) throw ConfigError({name + ":1: text: " + mark});
  std::vector<TextFault> faults;
  FaultCollector collector(faults);
  const auto parse = [&](const std::string& part, TextFormat::ParseInfoTree& positions) {
    TextFormat::Parser parser;
    parser.RecordErrorsTo(&collector);
    parser.WriteLocationsTo(&positions);
    google::protobuf::io::ArrayInputStream input(part.data(), static_cast<int>(part.size()));
    const bool is_parsed = parser.Parse(&input, &message);
    if (!is_parsed && faults.empty()) faults.push_back({0, "text", "cannot be parsed"});
    return is_parsed;
  };
  SalvagedText salvaged;
  auto positions = std::make_unique<TextFormat::ParseInfoTree>();
  bool is_parsed = parse(text, *positions);
  if (!is_parsed) {
    // The parser stops at the first fault. Further faults are found without the statements that are wrong by themselves.
    salvaged = SalvageText(text, *message.GetDescriptor());
    if (!salvaged.faults.empty()) {
      faults.clear();
      positions = std::make_unique<TextFormat::ParseInfoTree>();
      is_parsed = parse(salvaged.text, *positions);
      SayWhatIsGone(*message.GetDescriptor(), salvaged.faults);
      faults.insert(faults.end(), salvaged.faults.begin(), salvaged.faults.end());
    }
  }
  if (is_parsed) Checker(salvaged.blanked, faults).Check(message, positions.get(), "", -1);
  if (faults.empty()) return;
  std::ranges::stable_sort(faults, {}, &TextFault::line);
  const std::size_t num_more = faults.size() - std::min(faults.size(), kMaxFaults);
  if (num_more > 0) {
    faults.resize(kMaxFaults + 1);
    faults.back() = {faults.back().line, "text", "and " + std::to_string(num_more) + " faults more"};
  }
  std::vector<std::string> lines;
  lines.reserve(faults.size());
  for (const auto& fault : faults) lines.push_back(fmt::format("{}:{}: {}: {}", name, fault.line + 1, fault.field, fault.reason));
  throw ConfigError(lines);
}

void LoadText(const std::filesystem::path& file, Message& message) { ParseText(ReadConfigFile(file), file.string(), message); }

std::string EffectiveText(const Message& message, const std::string& indent) {
  std::string text;
  const auto& reflection = *message.GetReflection();
  const Descriptor& descriptor = *message.GetDescriptor();
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const FieldDescriptor& field = *descriptor.field(i);
    const bool is_list = field.is_repeated();
    const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    const bool has_value = is_list || reflection.HasField(message, &field) || field.has_default_value();
    if (!has_value) continue;
    const int count = is_list ? reflection.FieldSize(message, &field) : 1;
    for (int k = 0; k < count; ++k) {
      if (is_message) {
        text += indent + field.name() + " {\n";
        text += EffectiveText(is_list ? reflection.GetRepeatedMessage(message, &field, k) : reflection.GetMessage(message, &field), indent + "  ");
        text += indent + "}\n";
        continue;
      }
      std::string value;
      TextFormat::PrintFieldValueToString(message, &field, is_list ? k : -1, &value);
      text += indent;
      text += field.name() + ": " + value;
      text += !is_list && !reflection.HasField(message, &field) ? "  # default\n" : "\n";
    }
  }
  return text;
}

// lidar_2.txtpb is of the schema of lidar.txtpb.
constexpr std::string_view kOfSecond = "_2";

const Descriptor* SchemaOfFile(const std::filesystem::path& file) {
  // All scenes have one schema, whatever their names and folders; so has all evidence.
  const auto folder = file.parent_path().filename();
  const bool is_scene = folder == "scenes" || folder == "families" || folder == "encounters" || folder == "calibration";
  auto stem = file.filename() == kOldLidarFile ? std::filesystem::path(kLidarFile).stem().string() : file.stem().string();
  if (stem.ends_with(kOfSecond)) stem.resize(stem.size() - kOfSecond.size());
  return FindSchema("config/schema/" + (is_scene ? "scene" : folder == "evidence" ? "evidence" : stem) + ".proto");
}

std::string EffectiveTextOfFile(const std::filesystem::path& file) {
  const std::string text = ReadConfigFile(file);
  const auto* descriptor = SchemaOfFile(file);
  if (descriptor == nullptr) throw ConfigError({NoSchemaFault(file)});
  const std::unique_ptr<Message> message(google::protobuf::MessageFactory::generated_factory()->GetPrototype(descriptor)->New());
  ParseText(text, file.string(), *message);
  return EffectiveText(*message);
}

std::string FaultLine(const std::filesystem::path& file, const std::string& field, const std::string& reason, std::size_t index) {
  // The line of the place in which the value is set, or of the last one before it; 1 when there is none (a default is in force).
  const auto place = FindValues(file);
  int line_number = place.first_line;
  std::istringstream text(place.text);
  int number = 0;
  std::size_t num_places = 0;
  const std::string key = field.substr(field.rfind('.') + 1);
  for (std::string line; std::getline(text, line);) {
    ++number;
    const auto words = line.substr(0, line.find('#'));
    for (auto position = words.find(key); position != std::string::npos && num_places <= index; position = words.find(key, position + 1)) {
      line_number = number;
      ++num_places;
    }
  }
  return place.file.string() + ":" + std::to_string(line_number) + ": " + place.prefix + field + ": " + reason;
}

}  // namespace lookout::config
