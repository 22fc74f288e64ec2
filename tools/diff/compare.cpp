#include "tools/diff/compare.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>

#include "common/bus/header.hpp"

namespace lookout::diff {

namespace {

using bus::WireKind;
using bus::WireMember;
using bus::WireType;
using bus::WireTypes;

// The bytes are not a message of their type.
struct NotDecodable {};

// Longer strings are cut in what is shown.
constexpr std::size_t kMaxShownLetters = 60;
// Lookout's own types have some 600 fields.
constexpr int kMaxPaths = 1'000'000;

class FieldReader {
 public:
  explicit FieldReader(Bytes bytes) : bytes_(bytes) {}

  std::size_t num_left() const { return bytes_.size(); }

  Bytes Take(std::size_t size) {
    if (size > bytes_.size()) throw NotDecodable();
    const Bytes taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  std::uint64_t Number(std::size_t size) {
    std::uint64_t value = 0;
    for (const auto byte : Take(size)) value = value << 8 | byte;
    return value;
  }

  // Without its closing zero.
  Bytes String() {
    const auto size = Number(4);
    if (size < 1 || size > bytes_.size() || bytes_[size - 1] != 0) throw NotDecodable();
    return Take(size).first(size - 1);
  }

 private:
  Bytes bytes_;
};

template <typename T>
std::string NumberText(T value) {
  std::array<char, 40> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

std::string StringText(Bytes letters) {
  std::string text = "\"";
  for (const auto letter : letters.first(std::min(letters.size(), kMaxShownLetters))) {
    text += letter >= ' ' && letter <= '~' ? static_cast<char>(letter) : '?';
  }
  return text + (letters.size() > kMaxShownLetters ? "...\"" : "\"");
}

// The same text would tell nothing: different bits can print alike (NaN).
Difference NumbersDiffer(std::string a, std::string b, std::uint64_t bits_a, std::uint64_t bits_b) {
  if (a == b) {
    const auto hexadecimal = [](std::uint64_t bits) {
      std::array<char, 24> text{};
      std::snprintf(text.data(), text.size(), " (0x%llx)", static_cast<unsigned long long>(bits));
      return std::string(text.data());
    };
    a += hexadecimal(bits_a);
    b += hexadecimal(bits_b);
  }
  return {"", std::move(a), std::move(b)};
}

class MessageComparison {
 public:
  MessageComparison(const WireTypes& types, const Tolerances& tolerances, Bytes a, Bytes b) : types_(types), tolerances_(tolerances), a_(a), b_(b) {}

  // @return where they differ. @throws NotDecodable
  std::optional<Difference> Compare(const WireType& type) {
    a_.Take(8);  // the fingerprint
    b_.Take(8);
    auto difference = CompareStruct(type, "");
    if (!difference && (a_.num_left() > 0 || b_.num_left() > 0)) throw NotDecodable();
    return difference;
  }

 private:
  std::optional<Difference> CompareStruct(const WireType& type, const std::string& path) {
    std::vector<std::int64_t> counts(type.members.size());
    for (std::size_t i = 0; i < type.members.size(); ++i) {
      const auto& member = type.members[i];
      const std::string member_path = tolerances_.empty() ? "" : (path.empty() ? "" : path + ".") + member.name;
      const double tolerance = tolerances_.empty() || member.is_count ? 0.0 : tolerances_.Of(member_path);
      const auto lengths = Lengths(member, counts);
      std::uint64_t num_elements = 1;
      for (const auto length : lengths) num_elements *= static_cast<std::uint64_t>(length);  // bounded by Lengths
      for (std::uint64_t element = 0; element < num_elements; ++element) {
        auto difference = member.kind == WireKind::kStruct ? CompareStruct(types_.types()[member.type], member_path)
                                                           : CompareValue(member, tolerance, member.is_count ? &counts[i] : nullptr);
        if (!difference) continue;
        difference->field = member.name + Indices(lengths, element) + (difference->field.empty() ? "" : "." + difference->field);
        return difference;
      }
    }
    return std::nullopt;
  }

  // Lengths of the dimensions; no more elements than there are bytes.
  std::vector<std::int64_t> Lengths(const WireMember& member, const std::vector<std::int64_t>& counts) const {
    std::vector<std::int64_t> lengths;
    const auto element_size = member.kind == WireKind::kStruct ? types_.types()[member.type].min_size_bytes : bus::WireSizeBytes(member.kind);
    double size = static_cast<double>(element_size);  // does not overflow
    for (const auto& dimension : member.dimensions) {
      const auto length = dimension.count_member ? counts[*dimension.count_member] : dimension.length;
      if (length < 0) throw NotDecodable();
      size *= static_cast<double>(length);
      lengths.push_back(length);
    }
    if (size > static_cast<double>(std::min(a_.num_left(), b_.num_left()))) throw NotDecodable();
    return lengths;
  }

  static std::string Indices(const std::vector<std::int64_t>& lengths, std::uint64_t element) {
    std::string text;
    for (auto length = lengths.rbegin(); length != lengths.rend(); ++length) {
      text.insert(0, "[" + std::to_string(element % static_cast<std::uint64_t>(*length)) + "]");
      element /= static_cast<std::uint64_t>(*length);
    }
    return text;
  }

  std::optional<Difference> CompareValue(const WireMember& member, double tolerance, std::int64_t* count) {
    if (member.kind == WireKind::kString) {
      const auto a = a_.String();
      const auto b = b_.String();
      if (std::ranges::equal(a, b)) return std::nullopt;
      return Difference{"", StringText(a), StringText(b)};
    }
    const auto size = bus::WireSizeBytes(member.kind);
    const auto a = a_.Number(size);
    const auto b = b_.Number(size);
    if (count != nullptr) *count = Integer(member.kind, a);
    if (a == b) return std::nullopt;
    if (member.kind == WireKind::kDouble) return CompareReal(std::bit_cast<double>(a), std::bit_cast<double>(b), tolerance, a, b);
    if (member.kind == WireKind::kFloat) {
      return CompareReal(std::bit_cast<float>(static_cast<std::uint32_t>(a)), std::bit_cast<float>(static_cast<std::uint32_t>(b)), tolerance, a, b);
    }
    const auto value_a = Integer(member.kind, a);
    const auto value_b = Integer(member.kind, b);
    const auto distance = value_a > value_b ? static_cast<std::uint64_t>(value_a) - static_cast<std::uint64_t>(value_b)
                                            : static_cast<std::uint64_t>(value_b) - static_cast<std::uint64_t>(value_a);
    if (member.kind != WireKind::kBoolean && static_cast<double>(distance) <= tolerance) return std::nullopt;
    return Difference{"", NumberText(value_a), NumberText(value_b)};
  }

  template <typename Real>
  static std::optional<Difference> CompareReal(Real a, Real b, double tolerance, std::uint64_t bits_a, std::uint64_t bits_b) {
    if (tolerance > 0.0) {
      if (std::isnan(a) && std::isnan(b)) return std::nullopt;
      if (a == b || std::abs(static_cast<double>(a) - static_cast<double>(b)) <= tolerance) return std::nullopt;
    }
    return NumbersDiffer(NumberText(a), NumberText(b), bits_a, bits_b);
  }

  static std::int64_t Integer(WireKind kind, std::uint64_t bits) {
    switch (kind) {
      case WireKind::kInt8:
        return static_cast<std::int8_t>(bits);
      case WireKind::kInt16:
        return static_cast<std::int16_t>(bits);
      case WireKind::kInt32:
        return static_cast<std::int32_t>(bits);
      default:
        return static_cast<std::int64_t>(bits);
    }
  }

  const WireTypes& types_;
  const Tolerances& tolerances_;
  FieldReader a_;
  FieldReader b_;
};

std::string ByteText(std::uint8_t byte) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "0x%02x", byte);
  return text.data();
}

Difference CompareBytes(Bytes a, Bytes b) {
  const auto [place_a, place_b] = std::ranges::mismatch(a, b);
  if (place_a == a.end() || place_b == b.end()) return {"size", std::to_string(a.size()) + " bytes", std::to_string(b.size()) + " bytes"};
  return {"byte " + std::to_string(place_a - a.begin()), ByteText(*place_a), ByteText(*place_b)};
}

// "pose_t (0x...)": types of two versions may share their name.
std::string TypeText(const std::vector<const WireTypes*>& versions, Bytes message) {
  const auto fingerprint = bus::ReadU64BigEndian(message, 0);
  std::string name = "unknown";
  for (const auto* version : versions) {
    const auto* type = version->Find(fingerprint);
    if (type == nullptr) continue;
    name = type->name;
    break;
  }
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), " (0x%016llx)", static_cast<unsigned long long>(fingerprint));
  return name + text.data();
}

bool NameFits(std::string_view name, std::string_view path) {
  return path.ends_with(name) && (path.size() == name.size() || path[path.size() - name.size() - 1] == '.');
}

// Calls `visit` with the path of each number of a type and of its parts, `budget` times at most: types of a log may be nested without measure.
void VisitNumbers(const WireTypes& types, const WireType& type, const std::string& path, int& budget,
                  const std::function<void(const std::string&)>& visit) {
  for (const auto& member : type.members) {
    if (--budget < 0) return;
    const auto member_path = path.empty() ? member.name : path + "." + member.name;
    if (member.kind == WireKind::kStruct) {
      VisitNumbers(types, types.types()[member.type], member_path, budget, visit);
    } else if (member.kind != WireKind::kString && member.kind != WireKind::kBoolean && !member.is_count) {
      visit(member_path);
    }
  }
}

}  // namespace

double Tolerances::Of(std::string_view path) const {
  double tolerance = 0.0;
  std::size_t length = 0;
  for (const auto& [name, value] : tolerances_) {
    if (!NameFits(name, path) || name.size() < length) continue;
    tolerance = value;
    length = name.size();
  }
  return tolerance;
}

std::vector<std::string> Tolerances::Unknown(const std::vector<const bus::WireTypes*>& versions) const {
  std::vector<std::string> unknown;
  for (const auto& entry : tolerances_) unknown.push_back(entry.first);
  int budget = kMaxPaths;
  for (const auto* version : versions) {
    for (const auto& type : version->types()) {
      VisitNumbers(*version, type, "", budget,
                   [&](const std::string& path) { std::erase_if(unknown, [&](const auto& name) { return NameFits(name, path); }); });
    }
  }
  return unknown;
}

std::optional<Difference> CompareMessages(const std::vector<const bus::WireTypes*>& versions, const Tolerances& tolerances, Bytes a, Bytes b) {
  if (std::ranges::equal(a, b)) return std::nullopt;
  if (a.size() < 8 || b.size() < 8) return CompareBytes(a, b);
  if (bus::ReadU64BigEndian(a, 0) != bus::ReadU64BigEndian(b, 0)) return Difference{"type", TypeText(versions, a), TypeText(versions, b)};
  for (const auto* version : versions) {
    const auto* type = version->Find(bus::ReadU64BigEndian(a, 0));
    if (type == nullptr) continue;
    try {
      return MessageComparison(*version, tolerances, a, b).Compare(*type);
    } catch (const NotDecodable&) {
      break;
    }
  }
  return CompareBytes(a, b);
}

}  // namespace lookout::diff
