// Strict reading of Protobuf text files: a value that is unknown, mistyped, missing, not finite or out of range stops the start.
#pragma once

#include <filesystem>
#include <functional>
#include <google/protobuf/message.h>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace lookout::config {

/// All faults of one or more files, a line each: "path:line: field: reason".
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<std::string> faults);
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  std::vector<std::string> faults_;
};

/// Faults of several files and checks, to be told all at once, in the order in which they were found, each once.
class FaultList {
 public:
  /// Runs `check`, and keeps the faults of a ConfigError that it throws.
  void Try(const std::function<void()>& check);

  /// @return what `load` gives; nullopt when it throws a ConfigError, whose faults are kept
  template <typename LoadFunction>
  auto Take(const LoadFunction& load) {
    std::optional<decltype(load())> loaded;
    Try([&] { loaded = load(); });
    return loaded;
  }

  void Add(const std::string& fault);

  /// @throws ConfigError with all faults, if there are any
  void ThrowIfAny() const;

  const std::vector<std::string>& faults() const { return faults_; }

 private:
  std::vector<std::string> faults_;
};

/// The text of a config.
///
/// @throws ConfigError when it is no regular file (a FIFO or a device would hold the process), is greater than kMaxConfigBytes, or cannot be read
///
/// vlp16.txtpb stands in for lidar.txtpb where that is absent: the name that it had while the VLP-16 was the only lidar.
std::string ReadConfigFile(const std::filesystem::path& file);

/// @return the file under its old name, where that is there and the new one is not
std::optional<std::filesystem::path> OldConfigFile(const std::filesystem::path& file);
inline constexpr std::size_t kMaxConfigBytes = 4UL * 1024 * 1024;  // the largest of ours, the evidence, has 0.3 MB

/// Fills `message` from a text file and checks it against the options of its schema (config/schema/options.proto).
///
/// @throws ConfigError with every fault of the text, by line: unknown fields, wrong types, second values, missing facts, numbers out of range;
/// `message` is then not to be used. The caller checks relations between fields.
void LoadText(const std::filesystem::path& file, google::protobuf::Message& message);

/// LoadText from a text; `name` stands in for the path in faults.
void ParseText(const std::string& text, const std::string& name, google::protobuf::Message& message);

/// The values of a file of a boat's folder: of the file, else of its section in boat.txtpb, else the defaults of the schema. A file that boat.proto
/// has no section for must be there.
///
/// @throws ConfigError as LoadText; and where file and section are both there, or a file of the folder is of no schema while this one is absent: a
/// wrong name would go unnoticed
void LoadOfBoat(const std::filesystem::path& folder, const std::string& file_name, google::protobuf::Message& message);

/// LoadOfBoat, as a value.
template <typename Message>
Message Load(const std::filesystem::path& folder, const std::string& file_name) {
  Message message;
  LoadOfBoat(folder, file_name, message);
  return message;
}

/// @return values and defaults in force, a line each, in the order of the schema
std::string EffectiveText(const google::protobuf::Message& message, const std::string& indent = "");

/// @return EffectiveText of a file; x.txtpb has the schema config/schema/x.proto. @throws ConfigError
std::string EffectiveTextOfFile(const std::filesystem::path& file);

/// The schema of a file, by its name and folder; nullptr: there is none.
const google::protobuf::Descriptor* SchemaOfFile(const std::filesystem::path& file);

/// A fault of a relation between fields, found by a service, as a line of a ConfigError: "path:line: field: reason". Where the values of the file
/// stand in boat.txtpb, it is the line there.
///
/// @param index  of a repeated field: which of its values
std::string FaultLine(const std::filesystem::path& file, const std::string& field, const std::string& reason, std::size_t index = 0);

}  // namespace lookout::config
