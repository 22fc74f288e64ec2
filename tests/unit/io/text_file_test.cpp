// Letters of text files, however they are stored.
#include "common/io/text_file.hpp"

#include <zlib.h>

#include <gtest/gtest.h>
#include <string>

#include "tests/support/files.hpp"

namespace lookout::io {
namespace {

class TextFileTest : public ::testing::Test {
 protected:
  void Write(const std::string& bytes) const { support::WriteFile(path_, bytes); }
  static std::string Rest(TextFile& file) {
    std::string text;
    for (char letter = 0; file.Get(letter);) text += letter;
    return text;
  }
  std::string Text() const {
    TextFile file(path_);
    return Rest(file);
  }

  support::TempDir folder_;
  const std::filesystem::path path_ = folder_ / "text";
};

TEST_F(TextFileTest, IsReadAsItIsWithoutItsMark) {
  Write("a\r\n\xE4\n");
  EXPECT_EQ(Text(), "a\r\n\xE4\n");
  Write(
      "\xEF\xBB\xBF"
      "a");
  EXPECT_EQ(Text(), "a");
  Write("");
  EXPECT_EQ(Text(), "");
  EXPECT_THROW(TextFile(folder_ / "none"), std::runtime_error);
  EXPECT_THROW(TextFile{folder_.path()}, std::runtime_error);
}

TEST_F(TextFileTest, InUtf16HasAByteForEachLetter) {
  Write(
      std::string("\xFF\xFE"
                  "a\0\xE4\0\xAC\x20"
                  "b\0c",
                  11));
  EXPECT_EQ(Text(),
            "a\xE4\xFF"
            "b")
      << "the last letter is cut";
  Write(std::string("\xFE\xFF\0a\x20\xAC\0b", 8));
  EXPECT_EQ(Text(),
            "a\xFF"
            "b");
}

// Beyond what is kept, and of each coding.
TEST_F(TextFileTest, GoesBackAndForward) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i) + "\n";
  std::string wide = "\xFF\xFE";
  for (const char letter : text) wide += std::string({letter, '\0'});
  for (const bool is_packed : {false, true}) {
    for (const auto& bytes : {text, "\xEF\xBB\xBF" + text, wide}) {
      if (is_packed) {
        const gzFile out = gzopen(path_.c_str(), "wb");
        gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
        gzclose(out);
      } else {
        Write(bytes);
      }
      TextFile file(path_);
      char letter = 0;
      for (int i = 0; i < 1000; ++i) file.Get(letter);
      const auto position = file.position();
      const auto rest = Rest(file);
      EXPECT_EQ(rest, text.substr(1000));
      const auto end = file.position();
      file.Seek(position);
      ASSERT_TRUE(file.Get(letter));
      EXPECT_EQ(letter, text[1000]);
      file.Back();
      EXPECT_EQ(file.position(), position);
      file.Seek(end);
      EXPECT_FALSE(file.Get(letter));
      file.Seek(end - 2 * (end - position) / static_cast<std::int64_t>(rest.size()));
      EXPECT_EQ(Rest(file), text.substr(text.size() - 2)) << "within what is kept";
      file.Seek(0);
      EXPECT_EQ(Rest(file), text);
    }
  }
}

}  // namespace
}  // namespace lookout::io
