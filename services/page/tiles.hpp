// Raster tiles out of an MBTiles file of this computer.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "services/page/io/server.hpp"

namespace lookout::page {

/// The file is read as it is, and must not change meanwhile. One thread at a time.
class Tiles {
 public:
  /// @throws std::runtime_error, with path and reason: no file, no MBTiles, damaged, or tiles that are no pictures (vector tiles)
  /// Source: MBTiles specification 1.3.
  explicit Tiles(const std::filesystem::path& file);
  ~Tiles();
  Tiles(const Tiles&) = delete;
  Tiles& operator=(const Tiles&) = delete;

  /// JSON text of /tiles.json (PROTOCOL.md).
  const std::string& text() const;

  /// @param y  counted from the north
  /// @return nullopt where there is none, or none that is a PNG, JPEG or WebP picture of at most 1 MB
  std::optional<Tile> Find(int z, int x, int y);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lookout::page
