#include "tools/export/mcap.hpp"

#include <algorithm>
#include <map>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/schema.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/version.hpp"
#include "common/viewer/foxglove_messages.hpp"
#include "lookout/run_info_t.hpp"
#include "tools/export/mcap_writer.hpp"

namespace lookout::exporter {

namespace {

constexpr std::string_view kMcapProgram = "lookout-export: ";
constexpr std::size_t kMaxMcapChannels = 60'000;

// The text of a type, then the texts of the types in it, one after the other as lcm-gen expects them.
std::string LcmText(const std::string& type) {
  std::vector<std::string> wanted{type};
  std::string text;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (const auto& [file_name, type_text] : bus::TypeTexts()) {
      if (file_name != "lcmtypes/" + wanted[i] + ".lcm") continue;
      text += (text.empty() ? "" : "\n") + type_text;
      for (const auto& other : bus::TypeFingerprints()) {
        const bool is_part = type_text.find("  " + other.type + " ") != std::string::npos;
        if (is_part && std::ranges::find(wanted, other.type) == wanted.end()) wanted.push_back(other.type);
      }
    }
  }
  return text;
}

// The channels of a file, each made when its first message comes.
class LogToMcap {
 public:
  explicit LogToMcap(McapWriter::Take take)
      : writer_("lookout " + runtime::Version(), std::move(take)),
        messages_([this](viewer::FoxgloveTopic topic, const std::string& bytes) { Draw(topic, bytes); }) {}

  void Take(Utime time, std::string_view channel, Bytes bytes) {
    const auto utime_us = ToUtimeUs(time);
    if (utime_us < 0) {
      ++num_before_1970_;
      return;
    }
    time_ns_ = static_cast<std::uint64_t>(utime_us) * 1000;
    if (channel == bus::kRunInfo.name && !has_run_info_) Attach(bytes);
    writer_.AddMessage(RawChannel(channel), time_ns_, bytes);
    messages_.Take(channel, bytes);
  }

  void Finish() {
    messages_.Finish();
    writer_.Finish();
  }

  std::int64_t num_before_1970() const { return num_before_1970_; }
  std::int64_t num_not_drawn() const { return messages_.num_unused(); }

 private:
  void Attach(Bytes bytes) {
    const auto info = bus::Decode<run_info_t>(bytes);
    if (!info) return;
    has_run_info_ = true;
    for (std::size_t i = 0; i < info->file_name.size() && i < info->file_text.size(); ++i) {
      // The types stand in the schemas.
      if (!info->file_name[i].starts_with("lcmtypes/")) writer_.AddAttachment(info->file_name[i], "text/plain", time_ns_, info->file_text[i]);
    }
  }

  std::uint16_t RawChannel(std::string_view name) {
    const auto found = raw_.find(name);
    if (found != raw_.end()) return found->second;
    if (raw_.size() >= kMaxMcapChannels) throw std::runtime_error("the log has more than " + std::to_string(kMaxMcapChannels) + " channels");
    const auto* known = bus::FindChannel(name);
    std::uint16_t schema = 0;  // of channels of others nothing is known
    if (known != nullptr) {
      const std::string type(known->type);
      schema = SchemaOf("lookout." + type, "x-lcm", [&type] { return LcmText(type); });
    }
    return raw_.emplace(name, writer_.AddChannel(schema, name, "x-lcm")).first->second;
  }

  template <typename Data>
  std::uint16_t SchemaOf(const std::string& name, std::string_view encoding, const Data& data) {
    const auto found = schemas_.find(name);
    if (found != schemas_.end()) return found->second;
    return schemas_.emplace(name, writer_.AddSchema(name, encoding, data())).first->second;
  }

  void Draw(viewer::FoxgloveTopic topic, const std::string& bytes) {
    const auto& row = *std::ranges::find(viewer::kFoxgloveChannels, topic, &viewer::FoxgloveChannel::topic);
    auto found = drawn_.find(topic);
    if (found == drawn_.end()) {
      const auto schema = SchemaOf(std::string(row.schema), "protobuf", [&row] { return viewer::FoxgloveDescriptors(row.schema); });
      found = drawn_.emplace(topic, writer_.AddChannel(schema, row.name, "protobuf")).first;
    }
    writer_.AddMessage(found->second, time_ns_, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }

  McapWriter writer_;
  viewer::FoxgloveMessages messages_;
  std::map<std::string, std::uint16_t, std::less<>> raw_;
  std::map<std::string, std::uint16_t, std::less<>> schemas_;
  std::map<viewer::FoxgloveTopic, std::uint16_t> drawn_;
  std::uint64_t time_ns_ = 0;
  bool has_run_info_ = false;
  std::int64_t num_before_1970_ = 0;
};

void ExportMcap(const Request& request, std::ostream& errors) {
  io::OutputFile output(*request.output, {.force = request.force, .inputs = request.inputs, .tell = [&errors](const std::string& line) {
                                            errors << kMcapProgram << line << '\n';
                                          }});
  LogToMcap mcap([&output](Bytes bytes) { output.Write(bytes); });
  runtime::Progress progress("lookout-export", request.progress);
  bool holds_events = false;
  std::int64_t num_too_large = 0;
  for (std::size_t i = 0; i < request.inputs.size(); ++i) {
    bus::LogReader reader(request.inputs[i], io::ThrowIfStopAsked);
    while (const auto event = reader.NextView([](std::string_view) { return true; })) {
      io::ThrowIfStopAsked();
      progress.Update((static_cast<double>(i) +
                       static_cast<double>(reader.position_bytes()) / static_cast<double>(std::max<std::int64_t>(1, reader.size_bytes()))) /
                      static_cast<double>(request.inputs.size()));
      holds_events = true;
      if (event->bytes.size() < event->num_data_bytes) {
        ++num_too_large;
        continue;
      }
      mcap.Take(event->time, event->channel, event->bytes);
    }
    progress.Clear();
    if (reader.num_damaged() > 0)
      errors << kMcapProgram << request.inputs[i].string() << ": " << reader.num_damaged() << " damaged stretches skipped\n";
  }
  if (!holds_events) throw std::runtime_error(io::NoEventText(request.inputs.front()));
  mcap.Finish();
  if (num_too_large > 0) errors << kMcapProgram << num_too_large << " messages of more than 16 MiB are left out\n";
  if (mcap.num_before_1970() > 0)
    errors << kMcapProgram << mcap.num_before_1970() << " messages of before 1970 are left out: MCAP has no such times\n";
  if (mcap.num_not_drawn() > 0) errors << kMcapProgram << mcap.num_not_drawn() << " messages could not be decoded, and are not drawn\n";
  output.Commit();
}

}  // namespace

int RunMcap(const Request& request, std::ostream& errors) {
  if (!request.output) {
    errors << kMcapProgram << "--format mcap needs --out\n";
    return kExitUsage;
  }
  try {
    ExportMcap(request, errors);
    return kExitFine;
  } catch (const io::BrokenPipe&) {
    return kExitFine;
  } catch (const std::exception& error) {
    errors << kMcapProgram << PrintableLines(error.what()) << '\n';
    return kExitFailed;
  }
}

}  // namespace lookout::exporter
