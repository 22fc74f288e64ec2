#include <gtest/gtest.h>

#include "services/navigator/core/lines.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

std::vector<std::string> Lines(const std::string& text) { return SplitDatagram(ToBytes(text)).lines; }

TEST(SplitDatagram, FindsNothingInAnEmptyDatagram) {
  const auto result = SplitDatagram({});
  EXPECT_TRUE(result.lines.empty());
  EXPECT_EQ(result.num_no_start + result.num_too_long + result.num_not_printable, 0);
}

TEST(SplitDatagram, CutsAtCrAndLfInAnyOrder) {
  EXPECT_EQ(Lines("$A*41\r\n!B*42\n$C*43\r$D*44"), (std::vector<std::string>{"$A*41", "!B*42", "$C*43", "$D*44"}));
  EXPECT_EQ(Lines("\r\n\r\n"), std::vector<std::string>{});
}

TEST(SplitDatagram, KeepsLinesWhoseChecksumIsWrong) { EXPECT_EQ(Lines("$GPHDT,1.0,T*00\r\n").size(), 1U); }

TEST(SplitDatagram, DropsWhatStandsBeforeTheStart) {
  EXPECT_EQ(Lines("garbage\x01\xFF$A*41\r\n"), std::vector<std::string>{"$A*41"});
  EXPECT_EQ(Lines("\\g:1-2-73874,n:157036,s:r003669945,c:1241544035*4A\\!AIVDM,1*00\r\n"), std::vector<std::string>{"!AIVDM,1*00"});
  EXPECT_EQ(Lines("\\s:a$b*00\\$C*43\r\n"), std::vector<std::string>{"$C*43"}) << "a tag block may hold a $";
  EXPECT_EQ(Lines("\\no end of the block $C*43\r\n"), std::vector<std::string>{"$C*43"});
}

TEST(SplitDatagram, CountsLinesWithoutAStart) {
  EXPECT_EQ(SplitDatagram(ToBytes("hello\r\n\\s:a*00\\\r\n")).num_no_start, 2);
  EXPECT_EQ(SplitDatagram(ToBytes(std::string(3, '\0'))).num_no_start, 1);
}

TEST(SplitDatagram, CountsLinesThatAreTooLong) {
  const auto fits = SplitDatagram(ToBytes("$" + std::string(kMaxLineCharacters - 1, 'A')));
  EXPECT_EQ(fits.lines.size(), 1U);
  const auto too_long = SplitDatagram(ToBytes("$" + std::string(kMaxLineCharacters, 'A')));
  EXPECT_TRUE(too_long.lines.empty());
  EXPECT_EQ(too_long.num_too_long, 1);
}

TEST(SplitDatagram, CountsLinesThatAreNotPrintable) {
  for (const std::string& text : {std::string("$A\0B", 4), std::string("$A\x7F"), std::string("$A\x80"), std::string("$A\tB")}) {
    const auto result = SplitDatagram(ToBytes(text));
    EXPECT_TRUE(result.lines.empty());
    EXPECT_EQ(result.num_not_printable, 1);
  }
}

TEST(IsLine, WantsAStartAndPrintableCharacters) {
  EXPECT_TRUE(IsLine("$"));
  EXPECT_TRUE(IsLine("!AIVDM ~"));
  EXPECT_FALSE(IsLine(""));
  EXPECT_FALSE(IsLine("GPRMC"));
  EXPECT_FALSE(IsLine("$A\n"));
  EXPECT_FALSE(IsLine("$" + std::string(kMaxLineCharacters, 'A')));
}

TEST(Frame, HasAddressAndFields) {
  const auto result = Frame("$GPHDT,274.07,T*03");
  ASSERT_EQ(result.fault, SentenceFault::kNone);
  EXPECT_EQ(result.sentence.address, "GPHDT");
  EXPECT_EQ(result.sentence.fields, (std::vector<std::string_view>{"274.07", "T"}));
}

TEST(Frame, KeepsEmptyFields) {
  EXPECT_EQ(Frame(Line("A,,")).sentence.fields, (std::vector<std::string_view>{"", ""}));
  EXPECT_TRUE(Frame(Line("A")).sentence.fields.empty());
  EXPECT_EQ(Frame(Line("")).fault, SentenceFault::kNone);
}

TEST(Frame, UsesSmallHexadecimalDigits) {
  EXPECT_EQ(Frame("$GPRMC,193221.00,A,2037.7279,N,08704.0848,W,00.1,201.8,231207,01,W,A*2d").fault, SentenceFault::kNone);
}

TEST(Frame, RefusesASentenceWithoutChecksum) {
  for (const char* line : {"$GPHDT,274.07,T", "$", "*", "$GPHDT,274.07,T 03"}) EXPECT_EQ(Frame(line).fault, SentenceFault::kNoChecksum) << line;
}

TEST(Frame, RefusesAWrongChecksum) {
  for (const char* line : {"$GPHDT,274.07,T*04", "$GPHDT,274.07,T*3", "$GPHDT,274.07,T*", "$GPHDT,274.07,T*003", "$GPHDT,274.07,T*03 ",
                           "$GPHDT,274.07,T*G3", "$GPHDT,274.08,T*03"}) {
    EXPECT_EQ(Frame(line).fault, SentenceFault::kBadChecksum) << line;
  }
}

TEST(SplitDatagram, FindsASentenceBehindBinaryBytes) {
  const auto lines =
      SplitDatagram(ToBytes("$\xB5"
                            "b\x01$GPHDT,1.0,T*00\r\n"));
  EXPECT_EQ(lines.lines, std::vector<std::string>{"$GPHDT,1.0,T*00"});
  EXPECT_EQ(lines.num_not_printable, 0);
}

// The last bytes of a binary message may look like text, also like a start; and a line may have been broken off by the next.
TEST(SplitDatagram, FindsASentenceBehindWhatOnlyBeginsAsOne) {
  EXPECT_EQ(Lines("\x01!#$%&[$C*43\r\n"), std::vector<std::string>{"$C*43"});
  EXPECT_EQ(Lines("$GPGGA,12$C*43\r\n"), std::vector<std::string>{"$C*43"});
  EXPECT_EQ(Lines(std::string(10'000, '$') + "$C*43\r\n"), std::vector<std::string>{"$C*43"});
  EXPECT_EQ(Lines("$GPGGA,12$C*44\r\n"), std::vector<std::string>{"$GPGGA,12$C*44"}) << "its checksum is wrong too: it is counted as it stands";
}

TEST(LineAssembler, PutsPiecesTogether) {
  const std::string text = "1,2*00\r\n$GPHDT,1.0,T*00\r\n$GPHDT,2.0,T*00\r\n";
  for (std::size_t size = 1; size <= text.size(); ++size) {
    LineAssembler assembler;
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < text.size(); begin += size) {
      const auto piece = assembler.Add(ToBytes(text.substr(begin, size)));
      lines.insert(lines.end(), piece.lines.begin(), piece.lines.end());
    }
    EXPECT_EQ(lines, (std::vector<std::string>{"$GPHDT,1.0,T*00", "$GPHDT,2.0,T*00"})) << "pieces of " << size;
  }
}

TEST(LineAssembler, DoesNotHoldALineThatDoesNotEnd) {
  LineAssembler assembler;
  std::int64_t num_too_long = 0;
  for (int i = 0; i < 100; ++i) num_too_long += assembler.Add(ToBytes(std::string(100, 'x'))).num_too_long;
  EXPECT_GE(num_too_long, 9);
  assembler.Clear();
  EXPECT_EQ(assembler.Add(ToBytes("$GPHDT,1.0,T*00\n")).lines.size(), 1U);
}

TEST(LineAssembler, ForgetsWhatWasHalfSaidWhenTheConnectionBreaks) {
  LineAssembler assembler;
  assembler.Add(ToBytes("$GPHDT,1"));
  assembler.Clear();
  EXPECT_EQ(assembler.Add(ToBytes("2.0,T*00\r\n")).num_no_start, 1);
}

}  // namespace
}  // namespace lookout::navigator
