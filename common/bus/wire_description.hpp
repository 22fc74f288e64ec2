// Wire types as .lcm texts describe them, read at run time: messages of another version, or of nobody's headers, can be taken apart field by field.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::bus {

enum class WireKind { kInt8, kInt16, kInt32, kInt64, kByte, kBoolean, kFloat, kDouble, kString, kStruct };

/// Bytes on the wire of a value that is not a struct; of a string its least: length and closing zero.
std::size_t WireSizeBytes(WireKind kind);

struct WireDimension {
  std::optional<std::size_t> count_member;  // index of the member that holds the length; else it is fixed
  std::int64_t length = 0;                  // when it is fixed
};

struct WireMember {
  std::string name;
  WireKind kind = WireKind::kInt8;
  std::size_t type = 0;  // of kStruct: index into WireTypes::types()
  std::vector<WireDimension> dimensions;
  bool is_count = false;  // the length of an array of its struct
};

struct WireType {
  std::string name;  // "pose_t", without its package
  std::vector<WireMember> members;
  std::uint64_t fingerprint = 0;   // as it stands in front of a message
  std::size_t min_size_bytes = 0;  // without the fingerprint
};

/// The types of one version.
class WireTypes {
 public:
  WireTypes() = default;

  /// Reads .lcm texts, as one set: types may name each other across texts. Source of grammar and fingerprint: LCM's type specification
  /// (docs/content/lcm-type-ref.md) and lcmgen/lcmgen.c; a test holds it against the fingerprints of the generated headers.
  ///
  /// What cannot be read is left out, with all that needs it, and named in faults(): texts come out of logs. Left out as well are types that hold
  /// themselves, arrays of types without members, and enums (which LCM has given up).
  explicit WireTypes(const std::vector<std::string>& texts);

  const std::vector<WireType>& types() const { return types_; }
  const std::vector<std::string>& faults() const { return faults_; }

  /// @return nullptr when no type has it
  const WireType* Find(std::uint64_t fingerprint) const;

 private:
  std::vector<WireType> types_;
  std::vector<std::string> faults_;
};

}  // namespace lookout::bus
