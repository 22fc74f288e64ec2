#include "services/page/tiles.hpp"

#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "tests/support/files.hpp"

namespace lookout::page {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTables =
    "CREATE TABLE metadata (name text, value text); CREATE TABLE tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob);";
// PNG's magic and a letter.
constexpr const char* kPngA = "x'89504e470d0a1a0a61'";

class TilesTest : public ::testing::Test {
 protected:
  fs::path Make(const std::string& sql, const std::string& name = "a map?#%.mbtiles") {
    const auto file = folder_ / name;
    fs::remove(file);
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    char* fault = nullptr;
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &fault), SQLITE_OK) << (fault != nullptr ? fault : "");
    sqlite3_close(database);
    return file;
  }
  static std::string FaultOf(const fs::path& file) {
    try {
      const Tiles tiles(file);
      return {};
    } catch (const std::exception& error) {
      return error.what();
    }
  }
  static void ExpectFault(const fs::path& file, const std::string& words) {
    EXPECT_NE(FaultOf(file).find(words), std::string::npos) << FaultOf(file);
  }

  support::TempDir folder_;
};

TEST_F(TilesTest, AreCountedFromTheNorth) {
  Tiles tiles(Make(std::string(kTables) + "INSERT INTO tiles VALUES (2, 1, 3, " + kPngA + "), (2, 1, 0, x'ffd8ff62');"));
  const auto north = tiles.Find(2, 1, 0);
  ASSERT_TRUE(north);
  EXPECT_EQ(north->content_type, "image/png");
  EXPECT_EQ(north->bytes.back(), 'a');
  const auto south = tiles.Find(2, 1, 3);
  ASSERT_TRUE(south);
  EXPECT_EQ(south->content_type, "image/jpeg");
  EXPECT_FALSE(tiles.Find(2, 1, 1));
  EXPECT_FALSE(tiles.Find(2, 1, 4));
  EXPECT_FALSE(tiles.Find(2, -1, 0));
  EXPECT_FALSE(tiles.Find(31, 0, 0));
}

TEST_F(TilesTest, AreDescribed) {
  const Tiles tiles(Make(std::string(kTables) + "INSERT INTO tiles VALUES (3, 1, 3, " + kPngA + "), (5, 1, 3, " + kPngA +
                         "); INSERT INTO metadata VALUES ('name', 'Lake'), ('format', 'png'), ('bounds', '-72.2,43.5,-72.1,43.7');"));
  const auto text = nlohmann::json::parse(tiles.text());
  EXPECT_EQ(text["name"], "Lake");
  EXPECT_EQ(text["min_zoom"], 3);
  EXPECT_EQ(text["max_zoom"], 5);
  EXPECT_EQ(text["bounds"], nlohmann::json::parse("[-72.2, 43.5, -72.1, 43.7]"));
  EXPECT_EQ(text["format"], "png");
}

TEST_F(TilesTest, CoverTheWorldWhereTheirBoundsAreNone) {
  const auto bounds_of = [&](const std::string& text) {
    const Tiles tiles(
        Make(std::string(kTables) + "INSERT INTO tiles VALUES (0, 0, 0, " + kPngA + "); INSERT INTO metadata VALUES ('bounds', '" + text + "');"));
    return nlohmann::json::parse(tiles.text())["bounds"];
  };
  for (const auto* text : {"", "1,2,3", "nan,0,1,1", "5,0,1,1", "0,0,1,91"}) EXPECT_EQ(bounds_of(text)[0], -180.0) << text;
}

TEST_F(TilesTest, ThatAreNoPicturesAreRefused) {
  ExpectFault(folder_ / "missing", "is no file");
  ExpectFault(Make(std::string(kTables) + "INSERT INTO tiles VALUES (0, 0, 0, x'1f8b0800');"), "holds vector tiles");
  ExpectFault(Make(std::string(kTables) + "INSERT INTO metadata VALUES ('format', 'pbf'); INSERT INTO tiles VALUES (0, 0, 0, x'00');"),
              "vector tiles");
  ExpectFault(Make(std::string(kTables) + "INSERT INTO tiles VALUES (0, 0, 0, x'3c68746d6c3e');"), "no PNG, JPEG or WebP");
  ExpectFault(Make(kTables), "holds no tile");
  ExpectFault(Make("CREATE TABLE other (name text);"), "no MBTiles file");
  std::ofstream(folder_ / "text") << std::string(5000, 'x');
  ExpectFault(folder_ / "text", "no MBTiles file, or damaged");
}

// A file whose pages are cut off.
TEST_F(TilesTest, OfADamagedFileAreNotThere) {
  const auto file = Make(std::string(kTables) + "INSERT INTO tiles VALUES (0, 0, 0, " + kPngA + ");");
  fs::resize_file(file, 4096);
  EXPECT_NE(FaultOf(file), "");
}

// Rows of one name are counted, too: a view of them need not end.
TEST_F(TilesTest, HaveNoMoreThanAThousandRowsOfMetadata) {
  const auto file = Make(
      "CREATE TABLE tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob);"
      "CREATE VIEW metadata AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 2000) "
      "SELECT CASE i WHEN 1500 THEN 'name' ELSE 'other' END AS name, 'late' AS value FROM n;"
      "INSERT INTO tiles VALUES (0, 0, 0, " +
      std::string(kPngA) + ");");
  EXPECT_EQ(nlohmann::json::parse(Tiles(file).text())["name"], "");
}

// A view without end used the disk's thread for ever.
TEST_F(TilesTest, OfAViewWithoutEndAreGivenUp) {
  ExpectFault(Make("CREATE TABLE metadata (name text, value text);"
                   "CREATE VIEW tiles AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
                   "SELECT i AS zoom_level, 0 AS tile_column, 0 AS tile_row, x'00' AS tile_data FROM n WHERE i < 0;"),
              "holds no tile");
}

}  // namespace
}  // namespace lookout::page
