#include "tools/diff/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <type_traits>

#include "common/bus/decode.hpp"
#include "common/bus/schema.hpp"
#include "common/core/printable.hpp"
#include "tools/diff/fields.hpp"

namespace lookout::diff {

namespace {

// Longer strings are cut in the output.
constexpr std::size_t kMaxShownLetters = 60;

template <typename T>
concept WireStruct = requires {
  T::getTypeName();
};

// The type of the elements of an array of any dimensions.
template <typename T>
struct ElementOf {
  using Type = T;
};
template <typename T>
struct ElementOf<std::vector<T>> : ElementOf<T> {};
template <typename T, std::size_t N>
struct ElementOf<T[N]> : ElementOf<T> {};  // NOLINT(modernize-avoid-c-arrays): as lcm-gen makes them

template <typename T>
std::string NumberText(T value) {
  std::array<char, 40> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

std::string StringText(const std::string& letters) {
  return "\"" + Printable(letters.substr(0, kMaxShownLetters)) + (letters.size() > kMaxShownLetters ? "...\"" : "\"");
}

// Different bits can print alike (NaN): then the bits are added, as equal texts would tell nothing.
Difference NumbersDiffer(std::string a, std::string b, std::uint64_t bits_a, std::uint64_t bits_b) {
  if (a == b) {
    a += fmt::format(" (0x{:x})", bits_a);
    b += fmt::format(" (0x{:x})", bits_b);
  }
  return {"", std::move(a), std::move(b)};
}

std::string PathOf(const std::string& path, std::string_view name) { return path + (path.empty() ? "" : ".") + std::string(name); }

template <std::floating_point Real>
std::optional<Difference> CompareNumbers(Real a, Real b, double tolerance) {
  using Bits = std::conditional_t<sizeof(Real) == 8, std::uint64_t, std::uint32_t>;
  const auto bits_a = std::bit_cast<Bits>(a);
  const auto bits_b = std::bit_cast<Bits>(b);
  if (bits_a == bits_b) return std::nullopt;
  if (tolerance > 0.0 && ((std::isnan(a) && std::isnan(b)) || std::abs(static_cast<double>(a) - static_cast<double>(b)) <= tolerance || a == b)) {
    return std::nullopt;
  }
  return NumbersDiffer(NumberText(a), NumberText(b), bits_a, bits_b);
}

template <std::integral Integer>
std::optional<Difference> CompareNumbers(Integer a, Integer b, double tolerance) {
  const auto distance = static_cast<std::uint64_t>(std::max(a, b)) - static_cast<std::uint64_t>(std::min(a, b));  // does not overflow
  if (static_cast<double>(distance) <= tolerance) return std::nullopt;
  return Difference{"", NumberText(a), NumberText(b)};
}

template <WireStruct T>
std::optional<Difference> CompareFields(const T& a, const T& b, const Tolerances& tolerances, const std::string& path);

// @param path  of the field, without indices
// @return the difference; its `field` holds the part behind the name of the field: "[3].centroid_m[0]"
template <typename T>
std::optional<Difference> CompareValues(const T& a, const T& b, double tolerance, const Tolerances& tolerances, const std::string& path) {
  if constexpr (WireStruct<T>) {
    auto difference = CompareFields(a, b, tolerances, path);
    if (difference) difference->field.insert(0, ".");
    return difference;
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (a == b) return std::nullopt;
    return Difference{"", StringText(a), StringText(b)};
  } else if constexpr (std::is_arithmetic_v<T>) {
    return CompareNumbers(a, b, tolerance);
  } else {
    for (std::size_t i = 0; i < std::size(a); ++i) {  // both have equally many elements: their counts are compared before
      auto difference = CompareValues(a[i], b[i], tolerance, tolerances, path);
      if (!difference) continue;
      difference->field.insert(0, "[" + std::to_string(i) + "]");
      return difference;
    }
    return std::nullopt;
  }
}

template <WireStruct T>
std::optional<Difference> CompareFields(const T& a, const T& b, const Tolerances& tolerances, const std::string& path) {
  std::optional<Difference> first;
  VisitFields(a, b, [&](std::string_view name, const auto& in_a, const auto& in_b, bool is_exact) {
    if (first) return;
    const auto field = tolerances.empty() ? std::string() : PathOf(path, name);
    first = CompareValues(in_a, in_b, tolerances.empty() || is_exact ? 0.0 : tolerances.Of(field), tolerances, field);
    if (first) first->field.insert(0, name);
  });
  return first;
}

Difference CompareBytes(Bytes a, Bytes b) {
  const auto [place_a, place_b] = std::ranges::mismatch(a, b);
  if (place_a == a.end() || place_b == b.end()) return {"size", std::to_string(a.size()) + " bytes", std::to_string(b.size()) + " bytes"};
  return {"byte " + std::to_string(place_a - a.begin()), fmt::format("0x{:02x}", *place_a), fmt::format("0x{:02x}", *place_b)};
}

// @return nullopt also where the fields do not say all: nobody reads the closing zero of a string, and LCM ends a string that it encodes at its first
//         zero
template <WireStruct T>
std::optional<T> DecodeWhole(Bytes bytes) {
  auto message = bus::Decode<T>(bytes);
  try {
    if (message && !std::ranges::equal(bus::Encode(*message), bytes)) message.reset();
  } catch (const std::logic_error&) {
    message.reset();
  }
  return message;
}

// "pose_t (0x...)"
std::string TypeText(std::uint64_t fingerprint) {
  const auto known = std::ranges::find(bus::TypeFingerprints(), fingerprint, &bus::TypeFingerprint::fingerprint);
  return fmt::format("{} (0x{:016x})", known == bus::TypeFingerprints().end() ? "unknown" : known->type, fingerprint);
}

bool NameFits(std::string_view name, std::string_view path) {
  return path.ends_with(name) && (path.size() == name.size() || path[path.size() - name.size() - 1] == '.');
}

// Calls `visit` with the path of each number of a type and of its parts.
template <WireStruct T>
void VisitNumbers(const std::string& path, const std::function<void(const std::string&)>& visit) {
  const T none{};
  VisitFields(none, none, [&](std::string_view name, const auto& value, const auto& /*same*/, bool is_exact) {
    using Element = typename ElementOf<std::remove_cvref_t<decltype(value)>>::Type;
    if constexpr (WireStruct<Element>) {
      VisitNumbers<Element>(PathOf(path, name), visit);
    } else if constexpr (std::is_arithmetic_v<Element>) {
      if (!is_exact) visit(PathOf(path, name));
    }
  });
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

std::vector<std::string> Tolerances::Unknown() const {
  std::vector<std::string> unknown;
  for (const auto& entry : tolerances_) unknown.push_back(entry.first);
  ForEachType([&]<typename T>(const T& /*message*/) {
    VisitNumbers<T>("", [&](const std::string& path) { std::erase_if(unknown, [&](const auto& name) { return NameFits(name, path); }); });
  });
  return unknown;
}

std::optional<Difference> CompareMessages(const Tolerances& tolerances, Bytes a, Bytes b) {
  if (std::ranges::equal(a, b)) return std::nullopt;
  if (a.size() < 8 || b.size() < 8) return CompareBytes(a, b);
  const auto fingerprint = bus::ReadU64BigEndian(a, 0);
  if (const auto other = bus::ReadU64BigEndian(b, 0); other != fingerprint) return Difference{"type", TypeText(fingerprint), TypeText(other)};
  bool is_decoded = false;
  std::optional<Difference> difference;
  ForEachType([&]<typename T>(const T& /*message*/) {
    if (static_cast<std::uint64_t>(T::getHash()) != fingerprint) return;
    const auto message_a = DecodeWhole<T>(a);
    const auto message_b = DecodeWhole<T>(b);
    is_decoded = message_a && message_b;
    if (is_decoded) difference = CompareFields(*message_a, *message_b, tolerances, "");
  });
  return is_decoded ? difference : CompareBytes(a, b);
}

}  // namespace lookout::diff
