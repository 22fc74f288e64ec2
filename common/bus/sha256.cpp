#include <array>
#include <cinttypes>
#include <cstdio>
#include <openssl/evp.h>
#include <stdexcept>

#include "common/bus/schema.hpp"

namespace lookout::bus {

Sha256::Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
  if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) throw std::runtime_error("OpenSSL gives no SHA-256");
}

void Sha256::Add(const void* data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }

std::string Sha256::Finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    std::array<char, 3> pair{};
    std::snprintf(pair.data(), pair.size(), "%02x", digest[i]);
    text += pair.data();
  }
  return text;
}

std::string SchemaDigest() {
  Sha256 sha256;
  for (const auto& [type, fingerprint, has_seq] : TypeFingerprints()) {
    std::array<char, 32> number{};
    std::snprintf(number.data(), number.size(), " %016" PRIx64 "\n", fingerprint);
    const std::string line = type + number.data();
    sha256.Add(line.data(), line.size());
  }
  return sha256.Finish();
}

}  // namespace lookout::bus
