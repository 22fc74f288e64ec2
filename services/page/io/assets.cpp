#include "services/page/io/assets.hpp"

#include <zlib.h>

#include <array>
#include <cstdio>
#include <stdexcept>

namespace lookout::page {

namespace {

// A tag of checksum and size. A browser asks by the tag whether its copy is current, so the tag must differ in each version of the program.
std::string TagOf(Bytes bytes) {
  const auto sum = crc32_z(0, bytes.data(), bytes.size());
  std::array<char, 40> text{};
  const int size = std::snprintf(text.data(), text.size(), "%08lx-%zx", sum, bytes.size());
  return {text.data(), static_cast<std::size_t>(size)};
}

}  // namespace

std::vector<std::uint8_t> Inflated(Bytes gzip_bytes) {
  constexpr int kGzip = 16 + MAX_WBITS;
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) throw std::runtime_error("zlib does not start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);
  stream.next_in = const_cast<Bytef*>(gzip_bytes.data());  // zlib only reads these bytes
  stream.avail_in = static_cast<uInt>(gzip_bytes.size());
  std::vector<std::uint8_t> plain;
  std::array<std::uint8_t, 65536> block{};
  int result = Z_OK;
  while (result == Z_OK) {
    stream.next_out = block.data();
    stream.avail_out = static_cast<uInt>(block.size());
    result = inflate(&stream, Z_NO_FLUSH);
    plain.insert(plain.end(), block.data(), stream.next_out);
  }
  if (result != Z_STREAM_END) throw std::runtime_error("an asset is no gzip");
  return plain;
}

Assets::Assets(const std::vector<Asset>& assets) {
  for (const auto& asset : assets) entries_.emplace(asset.path, Entry{asset, TagOf(asset.gzip_bytes)});
}

bool Assets::Find(std::string_view path, bool accepts_gzip, Content& content) {
  auto found = entries_.find(path);
  if (found == entries_.end() && path == "/") found = entries_.find("/index.html");
  if (found == entries_.end()) return false;
  auto& entry = found->second;
  if (accepts_gzip) {
    content = {entry.asset.content_type, entry.asset.gzip_bytes, nullptr, "\"" + entry.tag + "\"", true};
    return true;
  }
  if (!entry.plain) entry.plain = std::make_shared<const std::vector<std::uint8_t>>(Inflated(entry.asset.gzip_bytes));
  content = {entry.asset.content_type, *entry.plain, entry.plain, "\"" + entry.tag + "-plain\"", false};
  return true;
}

}  // namespace lookout::page
