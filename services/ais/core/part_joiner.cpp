#include "services/ais/core/part_joiner.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "common/core/sentence.hpp"

namespace lookout::ais {

struct PartJoiner::Part {
  int num_parts = 0;
  int number = 0;
  std::size_t num_fill_bits = 0;
  std::string_view armour;
};

namespace {

// Any talker of two characters, of AIS or not: multiplexers rename them.
bool IsAddress(std::string_view address) { return address.size() == 5 && (address.ends_with("VDM") || address.ends_with("VDO")); }

// Before the checksum is looked at, so that other sentences are not counted.
bool MayBeAis(std::string_view line) { return line.size() > 6 && line.front() == '!' && line[6] == ',' && IsAddress(line.substr(1, 5)); }

}  // namespace

std::optional<WholePayload> PartJoiner::Add(Utime time, std::string_view source, std::string_view line) {
  if (!MayBeAis(line)) return std::nullopt;
  ++counts_["ais_sentences"];
  const auto framed = Frame(line);
  if (framed.fault != SentenceFault::kNone) {
    ++counts_["ais_bad_checksum"];
    return std::nullopt;
  }
  // Number of sentences, number of this one, sequence number, channel, armour, fill bits.
  FieldReader fields(framed.sentence.fields);
  Part part;
  part.num_parts = fields.Count(0, kMostParts);
  part.number = fields.Count(1, kMostParts);
  const int sequence = fields.Count(2, 9);
  const auto channel = fields.Text(3);
  part.armour = fields.Text(4);
  const int num_fill_bits = fields.Count(5, 5);
  // Where there are several, their sequence number says which message they are of.
  const bool has_number = part.num_parts > 0 && part.number > 0 && part.number <= part.num_parts && (part.num_parts == 1 || sequence >= 0);
  if (fields.fault() != SentenceFault::kNone || !has_number || channel.size() > 1 || part.armour.empty()) {
    ++counts_["ais_bad_field"];
    return std::nullopt;
  }
  // Old transponders leave the fill bits out.
  part.num_fill_bits = static_cast<std::size_t>(std::max(num_fill_bits, 0));
  const bool is_own = framed.sentence.address.ends_with('O');
  return AddPart(time, {std::string(source), is_own, std::string(channel), sequence}, part);
}

std::optional<WholePayload> PartJoiner::AddPart(Utime time, const Key& key, const Part& part) {
  ForgetOld(time);
  const bool is_own = std::get<1>(key);
  if (part.num_parts == 1) {
    auto payload = ToPayload(part.armour, part.num_fill_bits);
    if (!payload) {
      ++counts_["ais_bad_armour"];
      return std::nullopt;
    }
    return WholePayload{std::move(*payload), is_own};
  }
  auto found = open_.find(key);
  if (part.number == 1) {
    Open begun{time, part.num_parts, 0, {}, std::string(part.armour), false};
    if (found != open_.end()) {
      // The one before never came to its end. One transmission that two receivers heard begins alike.
      const auto& before = found->second;
      begun.is_mixed = time - before.time <= kMixed && (before.is_mixed || before.head != part.armour);
      ++(begun.is_mixed ? counts_["ais_parts_mixed"] : counts_["ais_parts_out_of_order"]);
    }
    found = open_.insert_or_assign(key, std::move(begun)).first;
  } else if (found != open_.end() && found->second.is_mixed) {
    ++counts_["ais_parts_mixed"];
    return std::nullopt;
  } else if (found == open_.end() || found->second.num_parts != part.num_parts || found->second.num_here + 1 != part.number) {
    ++counts_["ais_parts_out_of_order"];
    if (found != open_.end()) open_.erase(found);
    return std::nullopt;
  }
  auto& open = found->second;
  if (!open.payload.Append(part.armour, part.num_fill_bits)) {
    ++counts_["ais_bad_armour"];
    open_.erase(found);
    return std::nullopt;
  }
  if (++open.num_here < open.num_parts) {
    while (open_.size() > kMostOpen) {
      ++counts_["ais_parts_dropped"];
      open_.erase(std::ranges::min_element(open_, {}, [](const auto& entry) { return entry.second.time; }));
    }
    return std::nullopt;
  }
  WholePayload whole{std::move(open.payload), is_own};
  open_.erase(found);
  return whole;
}

void PartJoiner::ForgetOld(Utime time) {
  const auto num_old = std::erase_if(open_, [time](const auto& entry) { return time - entry.second.time > kMostWait || entry.second.time > time; });
  counts_["ais_parts_timed_out"] += static_cast<std::int64_t>(num_old);
}

}  // namespace lookout::ais
