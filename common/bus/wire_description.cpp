#include "common/bus/wire_description.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <stdexcept>
#include <utility>

namespace lookout::bus {

namespace {

// Structs in structs; deeper ones are left out.
constexpr int kMaxNesting = 32;
constexpr std::size_t kMaxFaults = 20;
// Sizes are kept below, so that no product of two overflows. No message is as large.
constexpr std::size_t kMaxSizeBytes = 1U << 31;

constexpr std::array<std::pair<std::string_view, WireKind>, 9> kPrimitives{{{"int8_t", WireKind::kInt8},
                                                                            {"int16_t", WireKind::kInt16},
                                                                            {"int32_t", WireKind::kInt32},
                                                                            {"int64_t", WireKind::kInt64},
                                                                            {"byte", WireKind::kByte},
                                                                            {"boolean", WireKind::kBoolean},
                                                                            {"float", WireKind::kFloat},
                                                                            {"double", WireKind::kDouble},
                                                                            {"string", WireKind::kString}}};

bool IsWordLetter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') || letter == '_' || letter == '.';
}

// Words (names with their dots, numbers) and single marks, without comments.
std::vector<std::string_view> SplitLcmText(std::string_view text) {
  std::vector<std::string_view> tokens;
  std::size_t place = 0;
  while (place < text.size()) {
    if (text.substr(place, 2) == "//") {
      place = std::min(text.find('\n', place), text.size());
    } else if (text.substr(place, 2) == "/*") {
      const auto end = text.find("*/", place + 2);
      place = end == std::string_view::npos ? text.size() : end + 2;
    } else if (IsWordLetter(text[place])) {
      std::size_t end = place;
      while (end < text.size() && IsWordLetter(text[end])) ++end;
      tokens.push_back(text.substr(place, end - place));
      place = end;
    } else {
      if (std::string_view(" \t\r\n").find(text[place]) == std::string_view::npos) tokens.push_back(text.substr(place, 1));
      ++place;
    }
  }
  return tokens;
}

// A struct as it is written.
struct WrittenMember {
  std::string type;  // a primitive, or with package
  std::string name;
  std::vector<std::string> dimensions;
};
struct WrittenStruct {
  std::string package;
  std::string name;
  std::vector<WrittenMember> members;

  std::string FullName() const { return package.empty() ? name : package + "." + name; }
};

std::optional<WireKind> PrimitiveKind(std::string_view type) {
  const auto* const found = std::ranges::find(kPrimitives, type, &std::pair<std::string_view, WireKind>::first);
  if (found == kPrimitives.end()) return std::nullopt;
  return found->second;
}

class LcmTextParser {
 public:
  explicit LcmTextParser(std::string_view text) : tokens_(SplitLcmText(text)) {}

  // @throws std::runtime_error at what is not understood; what came before stays in `structs`
  void Parse(std::vector<WrittenStruct>& structs) {
    std::string package;
    while (place_ < tokens_.size()) {
      const auto word = Take();
      if (word == "package") {
        package = Word();
        Expect(";");
      } else if (word == "struct") {
        structs.push_back(Struct(package));
      } else {
        throw std::runtime_error("neither package nor struct: " + std::string(word));
      }
    }
  }

 private:
  std::string_view Take() {
    if (place_ == tokens_.size()) throw std::runtime_error("ends early");
    return tokens_[place_++];
  }
  std::string Word() {
    const auto token = Take();
    if (!IsWordLetter(token.front())) throw std::runtime_error("a name is missing before " + std::string(token));
    return std::string(token);
  }
  bool TakeIf(std::string_view token) {
    if (place_ == tokens_.size() || tokens_[place_] != token) return false;
    ++place_;
    return true;
  }
  void Expect(std::string_view token) {
    if (const auto found = Take(); found != token) throw std::runtime_error("instead of " + std::string(token) + ": " + std::string(found));
  }

  WrittenStruct Struct(const std::string& package) {
    WrittenStruct result{package, Word(), {}};
    Expect("{");
    while (!TakeIf("}")) {
      if (TakeIf("const")) {  // no part of a message
        while (Take() != ";") {
        }
        continue;
      }
      std::string type = Word();
      if (!PrimitiveKind(type) && type.find('.') == std::string::npos && !package.empty()) type.insert(0, package + ".");
      do {
        WrittenMember member{type, Word(), {}};
        while (TakeIf("[")) {
          member.dimensions.push_back(Word());
          Expect("]");
        }
        result.members.push_back(std::move(member));
      } while (TakeIf(","));
      Expect(";");
    }
    return result;
  }

  std::vector<std::string_view> tokens_;
  std::size_t place_ = 0;
};

// lcmgen.c, hash_update: shifts are those of a signed number.
void AddToHash(std::int64_t& hash, std::int64_t value) {
  const auto shifted = static_cast<std::uint64_t>(hash) << 8 ^ static_cast<std::uint64_t>(hash >> 55);
  hash = static_cast<std::int64_t>(shifted + static_cast<std::uint64_t>(value));
}
void AddToHash(std::int64_t& hash, std::string_view text) {
  AddToHash(hash, static_cast<std::int8_t>(text.size()));
  for (const char letter : text) AddToHash(hash, static_cast<std::int8_t>(letter));
}

// lcm_struct_hash: names of members, names of primitive types, dimensions. The struct's own name is not in it.
std::int64_t BaseHash(const WrittenStruct& written) {
  std::int64_t hash = 0x12345678;
  for (const auto& member : written.members) {
    AddToHash(hash, member.name);
    if (PrimitiveKind(member.type)) AddToHash(hash, member.type);
    AddToHash(hash, static_cast<std::int64_t>(member.dimensions.size()));
    for (const auto& dimension : member.dimensions) {
      const bool is_fixed = dimension.front() >= '0' && dimension.front() <= '9';
      AddToHash(hash, is_fixed ? 0 : 1);
      AddToHash(hash, dimension);
    }
  }
  return hash;
}

// Makes types out of what is written, each after those that it needs.
class TypeResolver {
 public:
  TypeResolver(const std::vector<WrittenStruct>& written, std::vector<WireType>& types) : types_(types) {
    for (const auto& one : written) written_.emplace(one.FullName(), &one);  // of two with one name the first counts
  }

  // @return the index of the type. @throws std::runtime_error when it cannot be made
  std::size_t Resolve(const std::string& full_name, int nesting = 0) {
    if (const auto done = done_.find(full_name); done != done_.end()) {
      if (!done->second) throw std::runtime_error(full_name + " cannot be made, or holds itself");
      return *done->second;
    }
    const auto found = written_.find(full_name);
    if (found == written_.end()) throw std::runtime_error("there is no " + full_name);
    if (nesting > kMaxNesting) throw std::runtime_error(full_name + " is nested too deep");
    done_.emplace(full_name, std::nullopt);
    WireType type = Make(*found->second, nesting);
    types_.push_back(std::move(type));
    done_[full_name] = types_.size() - 1;
    return types_.size() - 1;
  }

 private:
  WireType Make(const WrittenStruct& written, int nesting) {
    WireType type;
    type.name = written.name;
    auto hash = static_cast<std::uint64_t>(BaseHash(written));
    for (const auto& written_member : written.members) {
      WireMember member;
      member.name = written_member.name;
      std::size_t size_bytes = 0;
      if (const auto kind = PrimitiveKind(written_member.type)) {
        member.kind = *kind;
        size_bytes = WireSizeBytes(*kind);
      } else {
        member.kind = WireKind::kStruct;
        member.type = Resolve(written_member.type, nesting + 1);
        const auto& part = types_[member.type];
        size_bytes = part.min_size_bytes;
        hash += part.fingerprint;
      }
      for (const auto& dimension : written_member.dimensions) member.dimensions.push_back(Dimension(type, written, written_member, dimension));
      if (!member.dimensions.empty() && size_bytes == 0) throw std::runtime_error(written.name + "." + member.name + ": an array of nothing");
      for (const auto& dimension : member.dimensions) {
        const auto least = dimension.count_member ? 0 : static_cast<std::uint64_t>(dimension.length);
        size_bytes = least > kMaxSizeBytes ? kMaxSizeBytes : std::min<std::size_t>(size_bytes * least, kMaxSizeBytes);
      }
      type.min_size_bytes = std::min(type.min_size_bytes + size_bytes, kMaxSizeBytes);
      type.members.push_back(std::move(member));
    }
    type.fingerprint = hash << 1 | hash >> 63;
    return type;
  }

  static WireDimension Dimension(WireType& type, const WrittenStruct& written, const WrittenMember& member, const std::string& size) {
    WireDimension dimension;
    if (size.front() >= '0' && size.front() <= '9') {
      const auto result = std::from_chars(size.data(), size.data() + size.size(), dimension.length);
      if (result.ec == std::errc() && result.ptr == size.data() + size.size()) return dimension;
    } else {
      // The count stands in front of its array.
      const auto count = std::ranges::find(type.members, size, &WireMember::name);
      if (count != type.members.end() && count->dimensions.empty() && count->kind <= WireKind::kByte) {
        count->is_count = true;
        dimension.count_member = static_cast<std::size_t>(count - type.members.begin());
        return dimension;
      }
    }
    throw std::runtime_error(written.name + "." + member.name + ": no length: " + size);
  }

  std::vector<WireType>& types_;
  std::map<std::string, const WrittenStruct*> written_;
  std::map<std::string, std::optional<std::size_t>> done_;  // empty: in the making, or failed
};

}  // namespace

std::size_t WireSizeBytes(WireKind kind) {
  switch (kind) {
    case WireKind::kInt8:
    case WireKind::kByte:
    case WireKind::kBoolean:
      return 1;
    case WireKind::kInt16:
      return 2;
    case WireKind::kInt32:
    case WireKind::kFloat:
      return 4;
    case WireKind::kInt64:
    case WireKind::kDouble:
      return 8;
    case WireKind::kString:
      return 5;
    case WireKind::kStruct:
      break;
  }
  return 0;
}

WireTypes::WireTypes(const std::vector<std::string>& texts) {
  const auto add_fault = [this](const std::exception& error) {
    if (faults_.size() < kMaxFaults) faults_.emplace_back(error.what());
  };
  std::vector<WrittenStruct> written;
  for (const auto& text : texts) {
    try {
      LcmTextParser(text).Parse(written);
    } catch (const std::exception& error) {
      add_fault(error);
    }
  }
  TypeResolver resolver(written, types_);
  for (const auto& one : written) {
    try {
      resolver.Resolve(one.FullName());
    } catch (const std::exception& error) {
      add_fault(error);
    }
  }
}

const WireType* WireTypes::Find(std::uint64_t fingerprint) const {
  const auto found = std::ranges::find(types_, fingerprint, &WireType::fingerprint);
  return found == types_.end() ? nullptr : &*found;
}

}  // namespace lookout::bus
