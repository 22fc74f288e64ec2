// Names and fingerprints of all wire types, as of the program that wrote a log.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct evp_md_ctx_st;  // OpenSSL's EVP_MD_CTX

namespace lookout::bus {

struct TypeFingerprint {
  std::string type;
  std::uint64_t fingerprint;
  bool has_seq;  // begins with utime_us and seq
};

/// All types of package lookout, also those that are only parts of others, by name.
const std::vector<TypeFingerprint>& TypeFingerprints();

/// The description of a type, as it stood in lcmtypes/ when this was built.
struct TypeText {
  std::string file_name;  // "lcmtypes/pose_t.lcm"
  std::string text;
};

/// Texts of all types of package lookout, by name: so that a log can be read when the version that wrote it is long gone.
const std::vector<TypeText>& TypeTexts();

/// SHA-256, hexadecimal, over "type fingerprint" lines.
std::string SchemaDigest();

/// SHA-256 of bytes that come in pieces (OpenSSL's).
class Sha256 {
 public:
  Sha256();

  void Add(const void* data, std::size_t size);
  /// Hexadecimal. Ends the computation.
  std::string Finish();

 private:
  std::unique_ptr<evp_md_ctx_st, void (*)(evp_md_ctx_st*)> context_;
};

}  // namespace lookout::bus
