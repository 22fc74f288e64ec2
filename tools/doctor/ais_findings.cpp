// Whether AIS is heard and understood: by the counters of HEALTH of lookout-ais.
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kAisSubject = "ais";

std::int64_t AisCount(const health_t& health, std::string_view name) {
  const auto found = std::ranges::find(health.counters, name, &health_counter_t::name);
  return found == health.counters.end() ? 0 : found->count;
}

// Why sentences and messages were refused, in words.
std::string RefusalsInWords(const health_t& health) {
  constexpr auto kRefusals =
      std::to_array<std::pair<std::string_view, std::string_view>>({{"ais_bad_checksum", "with a wrong checksum or none"},
                                                                    {"ais_bad_field", "with a wrong field"},
                                                                    {"ais_bad_armour", "with characters that AIS has not"},
                                                                    {"ais_parts_out_of_order", "of several parts out of order"},
                                                                    {"ais_parts_mixed", "of several parts, mixed by two receivers"},
                                                                    {"ais_parts_timed_out", "of which a part did not come"},
                                                                    {"messages_too_short", "too short"},
                                                                    {"messages_bad_mmsi", "without an MMSI"},
                                                                    {"messages_bad_place", "with a place that cannot be"}});
  std::vector<std::string> words;
  for (const auto& [name, text] : kRefusals) {
    if (const auto count = AisCount(health, name); count > 0) words.push_back(std::to_string(count) + " " + std::string(text));
  }
  return Joined(words);
}

}  // namespace

Findings CheckAis(const Observations& seen) {
  const auto* const health = seen.LastHealth("ais");
  if (health == nullptr) return {};
  const auto num_sentences = AisCount(*health, "ais_sentences");
  if (num_sentences == 0) {
    if (!seen.config.files.contains("ais.txtpb")) return {};
    return {
        Warning(kAisSubject, "ais.txtpb is there, but no sentence of AIS (!AIVDM, !AIVDO) has come",
                "the receiver's power, antenna and cable; an input of navigator.txtpb for it (38400 baud on a serial port), services/ais/README.md")};
  }
  const auto num_understood = AisCount(*health, "messages_understood");
  const auto refusals = RefusalsInWords(*health);
  if (num_understood + AisCount(*health, "messages_other") == 0) {
    return {Warning(kAisSubject,
                    Count(num_sentences, "sentence") + " of AIS came, and none was understood" + (refusals.empty() ? "" : ": " + refusals),
                    "the cable, its baud and the multiplexer's filter: sentences must come whole, with their checksums")};
  }
  return {Ok(kAisSubject, Count(num_sentences, "sentence") + " of AIS, " + Count(num_understood, "message") + " understood, " +
                              Count(AisCount(*health, "ships"), "ship"))};
}

}  // namespace lookout::doctor
