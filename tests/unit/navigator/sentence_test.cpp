#include "common/core/sentence.hpp"

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

// Of chart plotters, too: acknowledgements were refused.
TEST(Frame, TakesBlanksBehindTheChecksum) {
  for (const char* line : {"$GPHDT,274.07,T*03 ", "$GPHDT,274.07,T*03\t", "$GPHDT,274.07,T*03 \t "}) {
    EXPECT_EQ(Frame(line).fault, SentenceFault::kNone) << line;
  }
}

TEST(Frame, RefusesAWrongChecksum) {
  for (const char* line : {"$GPHDT,274.07,T*04", "$GPHDT,274.07,T*3", "$GPHDT,274.07,T*", "$GPHDT,274.07,T*003", "$GPHDT,274.07,T*03 x",
                           "$GPHDT,274.07,T*0 3", "$GPHDT,274.07,T* ", "$GPHDT,274.07,T*G3", "$GPHDT,274.08,T*03"}) {
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

// Spaces, tabs or the zero of a C string behind the checksum made it wrong.
TEST(SplitDatagram, DropsBlanksBehindASentence) {
  for (const std::string& blanks : {std::string(" "), std::string("\t"), std::string(" \t  "), std::string(1, '\0'), std::string(" \0", 2)}) {
    EXPECT_EQ(Lines("$C*43" + blanks + "\r\n$GPHDT,1.0,T" + blanks + "\n$D*44" + blanks),
              (std::vector<std::string>{"$C*43", "$GPHDT,1.0,T", "$D*44"}));
  }
}

TEST(SplitDatagram, DropsJunkBehindAChecksum) {
  EXPECT_EQ(Lines("$C*43\"\r\n$C*43,2026-08-29\r\n$C*43 by A\r\n"), std::vector<std::string>(3, "$C*43"));
  EXPECT_EQ(Lines("$C*43\xB5\x62\x01\r\n"), std::vector<std::string>{"$C*43"});
  EXPECT_EQ(Lines("$C*430\r\n"), std::vector<std::string>{"$C*430"}) << "three digits are no checksum";
}

// A gateway sent a second's sentences in one datagram without ends of lines: the last was read, those before it were lost without a counter.
TEST(SplitDatagram, FindsAllSentencesThatFollowEachOtherWithoutAnEndOfLine) {
  const auto result = SplitDatagram(ToBytes("$A*41!B*42$C*43\r\n$D*44$A*41"));
  EXPECT_EQ(result.lines, (std::vector<std::string>{"$A*41", "!B*42", "$C*43", "$D*44", "$A*41"}));
  EXPECT_EQ(result.num_cut_off, 0);
  EXPECT_EQ(Lines("\\s:x*00\\$A*41\\s:$y*00\\!B*42 \t$C*43"), (std::vector<std::string>{"$A*41", "!B*42", "$C*43"})) << "tag blocks and blanks";
}

// The checksum of the second is right for both together where that of the first is 7F: one GGA with an HDT in its last field.
TEST(SplitDatagram, TakesTwoSentencesForTwoWhoseChecksumIsAlsoThatOfBoth) {
  const std::string first = "$GNGGA,100000.00,5430.00000,N,01012.00000,E,1,12,0.8,3.0,M,40.0,M,,*7F";
  const std::string second = "$HEHDT,90.0,T*16";
  ASSERT_EQ(Frame(first + second).fault, SentenceFault::kNone);
  EXPECT_EQ(Lines(first + second), (std::vector<std::string>{first, second}));
  EXPECT_EQ(Lines(first + "\\s:x*00\\" + second), (std::vector<std::string>{first, second}));
}

TEST(SplitDatagram, CountsSentencesThatAnotherCutsOff) {
  auto result = SplitDatagram(ToBytes("$GPGGA,12$C*43$GPHDT,1.0,T*00!B*42$GPRMC,1"));
  EXPECT_EQ(result.lines, (std::vector<std::string>{"$C*43", "!B*42", "$GPRMC,1"})) << "the last stands as it is";
  EXPECT_EQ(result.num_cut_off, 2);
  EXPECT_EQ(SplitDatagram(ToBytes("costs $5, $C*43")).num_cut_off, 0) << "junk";
}

TEST(SplitDatagram, IsQuickWhateverADatagramHolds) {
  std::string text;
  for (int i = 0; i < 13'000; ++i) text += "$A*41";
  EXPECT_EQ(Lines(text).size(), 13'000U);
  text.clear();
  for (int i = 0; i < 20'000; ++i) text += "$*0";
  EXPECT_TRUE(SplitDatagram(ToBytes(text)).num_too_long == 1);
}

// Datagrams of one or two senders, a tenth of a second apart unless a test says otherwise.
class Joining : public ::testing::Test {
 protected:
  std::vector<std::string> Add(const std::string& text, const std::string& sender = "a", bool requires_checksum = true) {
    now_s_ += 0.1;
    return joiner_.Add(NoonPlus(now_s_), ToBytes(text), sender, requires_checksum).lines;
  }

  DatagramJoiner joiner_;
  double now_s_ = 0.0;
};

using Strings = std::vector<std::string>;

// A gateway from a serial line cuts at each 64 bytes: no sentence was whole, and there was no fix.
TEST_F(Joining, PutsSentencesTogetherWhereverTheyAreCut) {
  const std::string text = "$GPHDT,1.0,T*00\r\n$C*43\r\n\\s:x*00\\!B*42\r\n$D*44\r\n";
  for (std::size_t size = 1; size <= text.size(); ++size) {
    joiner_ = {};
    Strings lines;
    for (std::size_t begin = 0; begin < text.size(); begin += size) {
      for (const auto& line : Add(text.substr(begin, size))) lines.push_back(line);
    }
    EXPECT_EQ(lines, (Strings{"$GPHDT,1.0,T*00", "$C*43", "!B*42", "$D*44"})) << "cut at each " << size;
    EXPECT_TRUE(joiner_.is_empty());
  }
}

TEST_F(Joining, DoesNotWaitForAnEndOfLineBehindAChecksum) {
  EXPECT_EQ(Add("$C*43"), Strings{"$C*43"});
  EXPECT_EQ(Add("\r\n$D*4"), Strings{});
  EXPECT_EQ(Add("4"), Strings{"$D*44"});
}

TEST_F(Joining, NeverMixesTwoSenders) {
  EXPECT_EQ(Add("$GPHDT,1", "a"), Strings{});
  EXPECT_EQ(Add("$GPHDT,2", "b"), Strings{});
  EXPECT_EQ(Add(".0,T*00\r\n", "b"), Strings{"$GPHDT,2.0,T*00"});
  EXPECT_EQ(Add(".5,T*00\r\n", "a"), Strings{"$GPHDT,1.5,T*00"});
}

TEST_F(Joining, GivesWhatDidNotGoOnAsItStands) {
  EXPECT_EQ(Add("$GPHDT,1"), Strings{});
  EXPECT_EQ(Add("$C*43\r\n"), (Strings{"$GPHDT,1", "$C*43"})) << "the rest was lost";
  EXPECT_EQ(Add("$GPHDT,2"), Strings{});
  now_s_ += 2.0;
  EXPECT_EQ(Add(".0,T*00\r\n"), Strings{"$GPHDT,2"}) << "too late: what comes has no start";
  EXPECT_EQ(Add("$GPHDT,3"), Strings{});
  EXPECT_EQ(joiner_.AdvanceTo(NoonPlus(now_s_ + 1.9)).lines, Strings{});
  EXPECT_EQ(joiner_.AdvanceTo(NoonPlus(now_s_ + 2.1)).lines, Strings{"$GPHDT,3"});
  EXPECT_TRUE(joiner_.is_empty());
  EXPECT_EQ(Add("$GPHDT,4"), Strings{});
  EXPECT_EQ(joiner_.Finish().lines, Strings{"$GPHDT,4"});
  EXPECT_EQ(Add("$GPHDT,5"), Strings{});
  now_s_ -= 10.0;
  EXPECT_EQ(Add("$C*43"), (Strings{"$GPHDT,5", "$C*43"})) << "the clock was set back";
}

TEST_F(Joining, HoldsNothingBackThatIsNoBeginOfASentence) {
  for (const char* text : {"Hello!\n{\"a\":1", "costs $5.00", "$\x80\x81", "$GPHDT,1.0,T*00", "\xB5\x62 $GP\x01"}) {
    Add(text);
    EXPECT_TRUE(joiner_.is_empty()) << text;
  }
}

// Sentences without a checksum, each in a datagram without an end of line, must not come one datagram late.
TEST_F(Joining, WhereNoChecksumIsRequiredGivesAtOnceWhatMayBeASentence) {
  EXPECT_EQ(Add("$GPHDT,1.0,T", "a", false), Strings{"$GPHDT,1.0,T"});
  EXPECT_EQ(Add("$GPHDT,2.0,T", "a", false), Strings{"$GPHDT,2.0,T"});
  EXPECT_EQ(Add("\r\n$GPHDT,3.0,T", "a", false), Strings{"$GPHDT,3.0,T"});
  EXPECT_EQ(Add("*4", "a", false), Strings{}) << "it goes on with a line, so that its own end may go on, too";
  EXPECT_EQ(Add("4\r\n", "a", false), Strings{"$GPHDT,3.0,T*44"});
}

TEST_F(Joining, HoldsABoundedNumberOfBoundedLines) {
  std::size_t num_given = 0;
  for (int i = 0; i < 1000; ++i) num_given += Add("$GPHDT,1", std::to_string(i)).size();
  EXPECT_EQ(num_given, 1000 - DatagramJoiner::kMaxSenders);
  EXPECT_EQ(Add("$C*43$GPHDT", "one more"), (Strings{"$C*43", "$GPHDT,1"}));
  EXPECT_EQ(joiner_.AdvanceTo(NoonPlus(1e6)).lines.size(), DatagramJoiner::kMaxSenders);
  Add("$GPHDT,");
  std::int64_t num_too_long = 0;
  for (int i = 0; i < 40; ++i) {
    now_s_ += 0.1;
    num_too_long += joiner_.Add(NoonPlus(now_s_), ToBytes("0123456789"), "a", true).num_too_long;
  }
  EXPECT_EQ(num_too_long, 1);
}

// The last sentence of a burst of a server that sets no ends of lines came with the next one, or never.
TEST(LineAssembler, CutsAlsoBehindAChecksumThatAnotherSentenceFollows) {
  LineAssembler assembler;
  EXPECT_EQ(assembler.Add(ToBytes("$A*41!B*42$C")).lines, (Strings{"$A*41", "!B*42"}));
  EXPECT_EQ(assembler.Add(ToBytes("*43$D*44")).lines, (Strings{"$C*43", "$D*44"}));
  EXPECT_EQ(assembler.Add(ToBytes("$A*41")).lines, Strings{}) << "an end of line may follow";
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
