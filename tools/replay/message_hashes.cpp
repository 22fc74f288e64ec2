#include "tools/replay/message_hashes.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <iterator>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"

namespace lookout::replay {

MessageHashes::MessageHashes(const std::filesystem::path& file, io::OutputOptions options) : file_(file, std::move(options)) {
  file_.Write("channel,number,utime_us,xxh3\n");
}

void MessageHashes::Add(std::string_view channel, Bytes bytes) {
  const auto* const known = bus::FindChannel(channel);
  if (known == nullptr || known->is_raw || !known->is_replayed) return;
  auto place = num_of_.find(channel);
  if (place == num_of_.end()) place = num_of_.emplace(channel, 0).first;
  const auto header = bus::ReadHeader(bytes);
  line_.clear();
  fmt::format_to(std::back_inserter(line_), "{},{},{},{:016x}\n", channel, place->second++, header ? header->utime_us : 0,
                 XXH3_64bits(bytes.data(), bytes.size()));
  file_.Write(line_);
}

void MessageHashes::Commit() { file_.Commit(); }

}  // namespace lookout::replay
