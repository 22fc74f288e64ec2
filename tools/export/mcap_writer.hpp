// Writes MCAP files, version 0: chunks packed by Zstandard, indexes, checksums. Source: mcap.dev/spec.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"

struct ZSTD_CCtx_s;

namespace lookout::exporter {

/// Writes an MCAP file. Equal calls give equal bytes.
class McapWriter {
 public:
  using Take = std::function<void(Bytes)>;

  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
  static constexpr int kZstdLevel = 3;

  /// @param library  who writes, for the header
  /// @param take     takes the file piece by piece; what it throws comes through
  McapWriter(const std::string& library, Take take);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// @return its number, from 1
  std::uint16_t AddSchema(std::string_view name, std::string_view encoding, std::string_view data);

  /// @param schema  0: none
  /// @return its number, from 0
  std::uint16_t AddChannel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding);

  /// @param time_ns  since 1970, when it was logged
  void AddMessage(std::uint16_t channel, std::uint64_t time_ns, Bytes data);

  /// A text that belongs to the recording; stands between chunks.
  void AddAttachment(std::string_view name, std::string_view media_type, std::uint64_t time_ns, std::string_view data);

  /// Writes the last chunk, the summary and the end. Nothing may follow.
  void Finish();

 private:
  struct ChunkIndex {
    std::uint64_t first_ns = 0, last_ns = 0, offset = 0, length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;  // of the message index of each channel
    std::uint64_t index_length = 0, num_packed = 0, num_unpacked = 0;
  };
  struct AttachmentIndex {
    std::uint64_t offset = 0, length = 0, time_ns = 0, size = 0;
    std::string name, media_type;
  };

  void Put(const std::vector<std::uint8_t>& bytes);
  void CloseChunk();

  Take take_;
  std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> packer_;
  std::uint64_t position_ = 0;
  std::uint32_t data_crc_ = 0;
  std::vector<std::uint8_t> chunk_;
  std::uint64_t chunk_first_ns_ = 0;
  std::uint64_t chunk_last_ns_ = 0;
  bool has_message_ = false;                                        // in the chunk
  std::map<std::uint16_t, std::vector<std::uint8_t>> chunk_index_;  // by channel: time and offset of each message
  std::vector<std::uint8_t> schemas_;                               // records, for the summary
  std::vector<std::uint8_t> channels_;
  std::uint16_t num_schemas_ = 0;
  std::vector<std::uint64_t> counts_;     // messages, by channel
  std::vector<std::uint32_t> sequences_;  // the next, by channel
  std::vector<ChunkIndex> chunks_;
  std::vector<AttachmentIndex> attachments_;
  std::uint64_t first_ns_ = 0;
  std::uint64_t last_ns_ = 0;
  std::uint64_t num_messages_ = 0;
};

}  // namespace lookout::exporter
