// From sentences (VDM, VDO) to whole messages: a message of more than 56 characters comes in several sentences.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/ais/core/payload.hpp"

namespace lookout::ais {

/// A whole message of AIS, still in bits.
struct WholePayload {
  Payload payload;
  bool is_own = false;  // VDO: what the own transponder sends
};

/// Parts of a message share source, sentence (VDM or VDO), channel and sequence number, and come in their order. Of two receivers on one input both
/// may use one number: where another message begins under it within kMixed, the parts of neither are joined. Depends on the sentences and their times
/// alone.
class PartJoiner {
 public:
  /// Parts of a message follow each other within milliseconds; multiplexers delay them.
  static constexpr std::chrono::seconds kMostWait{3};
  /// A receiver has used nine other numbers before it uses one again: at 38400 baud no sooner than that.
  static constexpr std::chrono::milliseconds kMixed{300};
  /// Messages that wait for a part. Beyond, the oldest is dropped.
  static constexpr std::size_t kMostOpen = 64;
  /// Sentences of one message (IEC 61162-1 allows 9; the longest message of five slots takes 4).
  static constexpr int kMostParts = 9;

  /// @param line  from $ or ! to its end
  /// @return the message that it completes; nullopt for other sentences, refused ones, and where parts are still to come
  std::optional<WholePayload> Add(Utime time, std::string_view source, std::string_view line);
  void Clear() { open_.clear(); }

  std::size_t num_open() const { return open_.size(); }
  std::vector<Counter> counters() const {
    std::vector<Counter> counters;
    counts_.AppendTo(counters);
    return counters;
  }

 private:
  // source, whether VDO, channel, sequence number
  using Key = std::tuple<std::string, bool, std::string, int>;
  struct Open {
    Utime time;  // of the message's first part
    int num_parts = 0;
    int num_here = 0;
    Payload payload;
    std::string head;       // the armour of the message's first part
    bool is_mixed = false;  // with another message
  };
  struct Part;

  std::optional<WholePayload> AddPart(Utime time, const Key& key, const Part& part);
  void ForgetOld(Utime time);

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"ais_sentences", "ais_bad_checksum", "ais_bad_field", "ais_bad_armour", "ais_parts_out_of_order",
                                       "ais_parts_mixed", "ais_parts_timed_out", "ais_parts_dropped"});

  std::map<Key, Open> open_;
  Counts<kCountNames> counts_;
};

}  // namespace lookout::ais
