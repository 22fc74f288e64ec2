// The files of the page, as they are sent.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "services/page/core/frame.hpp"
#include "services/page/io/server.hpp"

namespace lookout::page {

/// One content for one request.
struct Content {
  std::string_view type;
  Bytes bytes;
  SharedBytes owner;  // of the bytes; null: they are there for ever
  std::string tag;    // ETag: changes with the content
  bool is_gzip = false;
};

/// @throws std::runtime_error when they are no gzip
std::vector<std::uint8_t> Inflated(Bytes gzip_bytes);

class Assets {
 public:
  explicit Assets(const std::vector<Asset>& assets);

  /// @param path  of the request; "/" is "/index.html" where that is an asset
  /// @return false when there is none
  /// @throws std::runtime_error when it is to be inflated and is no gzip
  bool Find(std::string_view path, bool accepts_gzip, Content& content);

 private:
  struct Entry {
    Asset asset;
    std::string tag;
    SharedBytes plain = nullptr;  // inflated at the first request for it
  };
  std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace lookout::page
