// What a file is, said the same by all programs.
#include "common/io/file_kind.hpp"

#include <sys/stat.h>
#include <zlib.h>

#include <filesystem>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/io/unpacked_file.hpp"
#include "tests/support/files.hpp"

namespace lookout::io {
namespace {

namespace fs = std::filesystem;
using std::string_literals::operator""s;

class FileKinds : public ::testing::Test {
 protected:
  FileKind KindOf(const std::string& bytes) const {
    support::WriteFile(file_, bytes);
    return FileKindOf(file_);
  }
  void Pack(const std::string& bytes) const {
    const gzFile out = gzopen(file_.c_str(), "wb");
    ASSERT_EQ(gzwrite(out, bytes.data(), static_cast<unsigned int>(bytes.size())), static_cast<int>(bytes.size()));
    gzclose(out);
  }

  support::TempDir folder_;
  const fs::path file_ = folder_ / "file";
};

TEST_F(FileKinds, AreToldByTheFirstBytes) {
  EXPECT_EQ(KindOf(""), FileKind::kEmpty);
  EXPECT_EQ(KindOf("\xD4\xC3\xB2\xA1\2\0\4\0"s), FileKind::kPcap);
  EXPECT_EQ(KindOf("\xA1\xB2\x3C\x4D"s), FileKind::kPcap);
  EXPECT_EQ(KindOf("\x0A\x0D\x0D\x0A"s), FileKind::kPcapng);
  EXPECT_EQ(KindOf("\xED\xA1\xDA\x01"s), FileKind::kLcmLog);
  EXPECT_EQ(KindOf("\x1F\x8B\x08\x08"s), FileKind::kGzip);
  EXPECT_EQ(KindOf("\xFD"s + "7zXZ\0"s), FileKind::kXz);
  EXPECT_EQ(KindOf("\x28\xB5\x2F\xFD"s), FileKind::kZstd);
  EXPECT_EQ(KindOf("BZh91AY"), FileKind::kBzip2);
  EXPECT_EQ(KindOf("PK\x03\x04"s), FileKind::kZip);
  EXPECT_EQ(KindOf("#ROSBAG V2.0\n"), FileKind::kRosBag);
  EXPECT_EQ(KindOf("\x89MCAP0\r\n"), FileKind::kMcap);
  EXPECT_EQ(KindOf("SQLite format 3\0more"s), FileKind::kSqlite);
  EXPECT_EQ(KindOf("\xFF\xFE$\0G\0"s), FileKind::kUtf16);
  EXPECT_EQ(KindOf("\xFE\xFF\0$\0G"s), FileKind::kUtf16);
  EXPECT_EQ(KindOf("$\0G\0P\0R\0M\0C\0"s), FileKind::kUtf16) << "without a mark";
  EXPECT_EQ(KindOf("\0$\0G\0P\0R\0M\0C"s), FileKind::kUtf16);
  EXPECT_EQ(KindOf("note\r\n$GPRMC,1,2*00\r\n"), FileKind::kNmea);
  EXPECT_EQ(KindOf("!AIVDM,1\n"), FileKind::kNmea);
  EXPECT_EQ(KindOf("price: $12, not a sentence\n"), FileKind::kText);
  EXPECT_EQ(KindOf("Stra\xC3\x9F"s + "e\n"), FileKind::kText);
  EXPECT_EQ(KindOf("this is\0no text"s), FileKind::kUnknown);
  EXPECT_EQ(KindOf("junk\xED\xA1\xDA\x01\0\0"s), FileKind::kUnknown) << "a log whose beginning is damaged";
}

// A pipe that nobody writes to would hold its reader for good.
TEST_F(FileKinds, OfWhatIsNoFileAreToldWithoutOpeningIt) {
  EXPECT_EQ(FileKindOf(folder_ / "none"), FileKind::kMissing);
  EXPECT_EQ(FileKindOf(folder_.path()), FileKind::kFolder);
  EXPECT_EQ(FileKindOf("/dev/null"), FileKind::kDevice);
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_EQ(FileKindOf(file_), FileKind::kPipe);
  for (const auto wanted : {Wanted::kLog, Wanted::kCapture, Wanted::kTextLog, Wanted::kRecording, Wanted::kImport}) {
    EXPECT_NE(WhyNot(file_, wanted).find("is a pipe, no "), std::string::npos);
  }
  EXPECT_THROW(UnpackedFile{file_}, std::runtime_error);
}

TEST_F(FileKinds, LeadToTheCommandThatHelps) {
  const auto why_no_log = [this](const std::string& bytes) {
    support::WriteFile(file_, bytes);
    return WhyNot(file_, Wanted::kLog);
  };
  const auto name = file_.string();
  EXPECT_EQ(why_no_log("\xD4\xC3\xB2\xA1"s),
            name + ": is a capture (pcap), no lcm-log; a log is made of it by: lookout-replay --config DIR --in " + name + " --out NEW.lcmlog");
  EXPECT_EQ(why_no_log("\xFD"s + "7zXZ\0"s), name + ": is compressed by xz, no lcm-log; unpack it first: xz -dk " + name);
  EXPECT_EQ(why_no_log("\xED\xA1\xDA\x01"s), "");
  EXPECT_EQ(why_no_log("\x01\x02"s), "") << "a damaged log is looked through";
  EXPECT_EQ(why_no_log("letters"), "") << "as above";
  EXPECT_NE(NoEventText(file_).find("is text, no lcm-log; if it holds sentences"), std::string::npos);
  EXPECT_EQ(why_no_log(""), "") << "a log that was just begun";
  EXPECT_EQ(NoEventText(file_), name + ": is empty");
  EXPECT_EQ(WhyNot(file_, Wanted::kRecording), name + ": is empty");
  Pack("\xD4\xC3\xB2\xA1"s);
  EXPECT_NE(WhyNot(file_, Wanted::kLog).find("it holds a capture (pcap), and a log is made of it by: lookout-replay"), std::string::npos);
  EXPECT_EQ(WhyNot(file_, Wanted::kCapture), "");
  Pack("$GPRMC,");
  EXPECT_NE(WhyNot(file_, Wanted::kCapture).find("unpack it first: gunzip -k"), std::string::npos);
  const auto quoted = folder_ / "it's here";
  support::WriteFile(quoted, "\x1F\x8B\x08"s);
  EXPECT_NE(WhyNot(quoted, Wanted::kLog).find("/it'\\''s here'"), std::string::npos) << WhyNot(quoted, Wanted::kLog);
}

TEST_F(FileKinds, UnpackedBytesAreThoseThatWerePacked) {
  std::string bytes;
  for (int i = 0; i < 300'000; ++i) bytes += static_cast<char>((i % 251) * (i % 241) % 251);
  const auto read = [this](std::string& fault) {
    UnpackedFile file(file_);
    std::string all;
    std::vector<std::uint8_t> piece(7000);
    for (std::size_t size = piece.size(); size == piece.size();) {
      size = file.Read(piece);
      all.append(piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(size));
    }
    fault = file.fault();
    return all;
  };
  std::string fault;
  support::WriteFile(file_, bytes);
  EXPECT_TRUE(read(fault) == bytes);
  EXPECT_EQ(fault, "");
  Pack(bytes);
  EXPECT_TRUE(read(fault) == bytes);
  EXPECT_EQ(fault, "");
  const auto packed = support::ReadFile(file_);
  support::WriteFile(file_, packed + packed);  // two files in one, as gzip allows
  EXPECT_TRUE(read(fault) == bytes + bytes);
  support::WriteFile(file_, packed.substr(0, packed.size() / 2));
  EXPECT_TRUE(bytes.starts_with(read(fault)));
  EXPECT_EQ(fault, "what gzip packed is cut short");
  auto flipped = packed;
  flipped[packed.size() / 2] ^= 0x10;
  support::WriteFile(file_, flipped);
  read(fault);
  EXPECT_NE(fault.find("what gzip packed is damaged"), std::string::npos) << fault;
}

}  // namespace
}  // namespace lookout::io
