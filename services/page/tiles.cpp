#include "services/page/tiles.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace lookout::page {

namespace {

constexpr int kMostZoom = 24;
constexpr int kMostTileBytes = 1'000'000;
// Steps of SQLite's machine for one answer: a file may hold a view that never ends.
constexpr int kMostSteps = 20'000'000;

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

// Characters that mean something in an SQLite URI are escaped.
std::string ToUri(const std::string& path) {
  std::string uri = "file:";
  for (const unsigned char letter : path) {
    const bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') ||
                          std::string_view("/._-~").find(static_cast<char>(letter)) != std::string_view::npos;
    uri += is_plain ? std::string(1, static_cast<char>(letter)) : fmt::format("%{:02X}", letter);
  }
  return uri + "?mode=ro&immutable=1";
}

std::string_view ContentType(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF"sv)) return "image/jpeg";
  if (bytes.starts_with("RIFF"sv) && bytes.substr(0, 12).ends_with("WEBP"sv)) return "image/webp";
  return {};
}

std::string_view Column(sqlite3_stmt* statement, int column) {
  // The bytes first: asking for their number may convert them.
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement, column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, column));
  return bytes == nullptr ? std::string_view() : std::string_view(bytes, size);
}

std::array<double, 4> BoundsOf(const std::string& text) {
  constexpr double kMostLongitudeDeg = 180.0;
  constexpr double kMostLatitudeDeg = 85.0511;  // of the Web Mercator projection
  const std::array<double, 4> world{-kMostLongitudeDeg, -kMostLatitudeDeg, kMostLongitudeDeg, kMostLatitudeDeg};
  std::array<double, 4> bounds{};
  const char* begin = text.data();
  const char* const end = begin + text.size();
  for (auto& bound : bounds) {
    while (begin != end && (*begin == ' ' || *begin == ',')) ++begin;
    const auto read = std::from_chars(begin, end, bound);
    if (read.ec != std::errc() || !std::isfinite(bound)) return world;
    begin = read.ptr;
  }
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    if (std::abs(bounds[i]) > (i % 2 == 0 ? kMostLongitudeDeg : 90.0)) return world;
  }
  return bounds[0] < bounds[2] && bounds[1] < bounds[3] ? bounds : world;
}

}  // namespace

struct Tiles::Implementation {
  std::string name;  // of the file, for errors
  Database database{nullptr, sqlite3_close_v2};
  Statement find{nullptr, sqlite3_finalize};
  std::string text;
  int num_steps = 0;

  [[noreturn]] void Refuse(const std::string& reason) const { throw std::runtime_error("map file '" + name + "' " + reason); }

  Statement Prepare(const char* sql) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database.get(), sql, -1, &statement, nullptr) != SQLITE_OK) {
      Refuse(std::string("is no MBTiles file, or damaged: ") + sqlite3_errmsg(database.get()));
    }
    return {statement, sqlite3_finalize};
  }

  // A statement that takes too long is ended, as with a damaged file.
  int Step(sqlite3_stmt* statement) {
    num_steps = 0;
    return sqlite3_step(statement);
  }

  void Open(const std::filesystem::path& file) {
    name = file.string();
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) Refuse("is no file");
    sqlite3* opened = nullptr;
    const int result =
        sqlite3_open_v2(ToUri(std::filesystem::absolute(file).string()).c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database.reset(opened);
    if (result != SQLITE_OK) Refuse(std::string("cannot be opened: ") + sqlite3_errstr(result));
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, 2 * kMostTileBytes);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    constexpr int kStepsACall = 10'000;
    sqlite3_progress_handler(
        opened, kStepsACall, [](void* self) { return (static_cast<Implementation*>(self)->num_steps += kStepsACall) > kMostSteps ? 1 : 0; }, this);
  }

  std::map<std::string, std::string, std::less<>> Metadata() {
    constexpr std::size_t kMostRows = 1000;
    std::map<std::string, std::string, std::less<>> metadata;
    const auto statement = Prepare("SELECT name, value FROM metadata");
    int result = SQLITE_DONE;
    for (std::size_t row = 0; row < kMostRows && (result = Step(statement.get())) == SQLITE_ROW; ++row) {
      metadata.emplace(Column(statement.get(), 0), Column(statement.get(), 1));
    }
    if (result != SQLITE_DONE && result != SQLITE_ROW) Refuse(std::string("is damaged: ") + sqlite3_errmsg(database.get()));
    return metadata;
  }

  int Number(const char* sql) {
    const auto statement = Prepare(sql);
    const int result = Step(statement.get());
    if (result != SQLITE_ROW) Refuse(std::string("is damaged: ") + sqlite3_errmsg(database.get()));
    if (sqlite3_column_type(statement.get(), 0) != SQLITE_INTEGER) Refuse("holds no tiles");
    const int number = sqlite3_column_int(statement.get(), 0);
    if (number < 0 || number > kMostZoom) Refuse(fmt::format("holds tiles of zoom {}: 0 to {} can be", number, kMostZoom));
    return number;
  }

  void CheckFirstTile(const std::string& format) {
    const auto statement = Prepare("SELECT tile_data FROM tiles LIMIT 1");
    if (Step(statement.get()) != SQLITE_ROW) Refuse("holds no tile that can be read");
    constexpr std::string_view kGzip = "\x1f\x8b";
    const auto bytes = Column(statement.get(), 0);
    if (format == "pbf" || bytes.starts_with(kGzip)) Refuse("holds vector tiles: the page draws raster tiles (png, jpg, webp)");
    if (ContentType(bytes).empty()) Refuse("holds tiles that are no PNG, JPEG or WebP pictures (format '" + format + "')");
  }
};

Tiles::Tiles(const std::filesystem::path& file) : implementation_(std::make_unique<Implementation>()) {
  auto& self = *implementation_;
  self.Open(file);
  const auto metadata = self.Metadata();
  const auto value = [&](std::string_view name) {
    const auto found = metadata.find(name);
    return found != metadata.end() ? found->second : std::string();
  };
  self.CheckFirstTile(value("format"));
  // By the tiles themselves, not by the metadata: with the index that the specification wants both are found at once.
  const nlohmann::json text{{"name", value("name")},
                            {"min_zoom", self.Number("SELECT min(zoom_level) FROM tiles")},
                            {"max_zoom", self.Number("SELECT max(zoom_level) FROM tiles")},
                            {"bounds", BoundsOf(value("bounds"))},
                            {"format", value("format")}};
  self.text = text.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  self.find = self.Prepare("SELECT tile_data FROM tiles WHERE zoom_level = ?1 AND tile_column = ?2 AND tile_row = ?3 LIMIT 1");
}

Tiles::~Tiles() = default;

const std::string& Tiles::text() const { return implementation_->text; }

std::optional<Tile> Tiles::Find(int z, int x, int y) {
  if (z < 0 || z > kMostZoom) return std::nullopt;
  const int num_tiles = 1 << z;
  if (x < 0 || x >= num_tiles || y < 0 || y >= num_tiles) return std::nullopt;
  auto* const find = implementation_->find.get();
  sqlite3_reset(find);
  sqlite3_bind_int(find, 1, z);
  sqlite3_bind_int(find, 2, x);
  sqlite3_bind_int(find, 3, num_tiles - 1 - y);  // the file counts from the south
  std::optional<Tile> tile;
  if (implementation_->Step(find) == SQLITE_ROW) {
    const auto bytes = Column(find, 0);
    const auto type = ContentType(bytes);
    if (!type.empty() && bytes.size() <= kMostTileBytes) tile = Tile{std::string(type), {bytes.begin(), bytes.end()}};
  }
  sqlite3_reset(find);
  return tile;
}

}  // namespace lookout::page
