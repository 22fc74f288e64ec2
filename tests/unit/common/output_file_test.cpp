// Outputs of programs: whole under their names, or not there.
#include "tests/unit/common/output_fixture.hpp"

namespace lookout::io {
namespace {

TEST_F(Output, AppearsOnlyWhenItIsCommitted) {
  OutputFile output(file_, Options());
  output.Write("one ");
  output.stream() << 2 << ' ' << 3.5;
  EXPECT_FALSE(fs::exists(file_));
  EXPECT_TRUE(fs::exists(partial_));
  output.Commit();
  EXPECT_EQ(Content(file_), "one 2 3.5");
  EXPECT_FALSE(fs::exists(partial_));
  EXPECT_TRUE(told_.empty());
}

TEST_F(Output, OfManyPiecesOfAllSizesIsWhole) {
  std::string text;
  {
    OutputFile output(file_, Options());
    for (const std::size_t size : {0, 1, 65'535, 65'536, 65'537, 200'000, 3}) {
      const std::string piece(size, static_cast<char>('a' + size % 26));
      output.Write(piece);
      text += piece;
    }
    output.Commit();
  }
  EXPECT_EQ(Content(file_), text);
}

TEST_F(Output, ThatIsNotCommittedLeavesNothingAndSaysSo) {
  {
    OutputFile output(file_, Options());
    output.Write(std::string(1'000'000, 'x'));
  }
  EXPECT_TRUE(fs::is_empty(folder_));
  ASSERT_EQ(told_.size(), 1u);
  ExpectHas(told_[0], "out: not written, nothing of it is left");
}

TEST_F(Output, DoesNotReplaceAFileUnasked) {
  SetContent(file_, "a recording");
  ExpectHas(FaultOf(file_), "out: exists already; --force replaces it");
  EXPECT_EQ(Content(file_), "a recording");
  EXPECT_FALSE(fs::exists(partial_));
}

TEST_F(Output, ReplacesAFileWhenAskedAndOnlyAtTheEnd) {
  SetContent(file_, "a recording");
  OutputFile output(file_, Options(true));
  output.Write("new");
  EXPECT_EQ(Content(file_), "a recording");
  output.Commit();
  EXPECT_EQ(Content(file_), "new");
}

TEST_F(Output, KeepsTheOldFileWhenItFails) {
  SetContent(file_, "a recording");
  {
    OutputFile output(file_, Options(true));
    output.Write("new");
  }
  EXPECT_EQ(Content(file_), "a recording");
}

TEST_F(Output, DoesNotReplaceAFileThatAppearedMeanwhileAndKeepsTheResult) {
  OutputFile output(file_, Options());
  output.Write("computed");
  SetContent(file_, "somebody else's");
  try {
    output.Commit();
    FAIL() << "it was replaced";
  } catch (const std::runtime_error& error) {
    ExpectHas(error.what(), "has appeared while it was computed; the whole result is in " + whole_.string());
  }
  EXPECT_EQ(Content(file_), "somebody else's");
  EXPECT_EQ(Content(whole_), "computed");
  EXPECT_FALSE(fs::exists(partial_));
}

TEST_F(Output, ThatWasKeptWholeIsRemovedByNoLaterRun) {
  for (const std::string text : {"first", "second"}) {
    OutputFile output(file_, Options());
    output.Write(text);
    SetContent(file_, "somebody else's");
    EXPECT_THROW(output.Commit(), std::runtime_error);
    fs::remove(file_);
  }
  OutputFile output(file_, Options(true));
  output.Write("third");
  output.Commit();
  EXPECT_EQ(Content(whole_), "first");
  EXPECT_EQ(Content(folder_ / "out.whole.1"), "second");
  EXPECT_EQ(Content(file_), "third");
}

// One has taken the place of the second; the third gets its name all the same.
TEST_F(Output, OfASetIsOnTheDiskBeforeTheFirstGetsItsName) {
  OutputFile one(folder_ / "one", Options());
  OutputFile two(folder_ / "two", Options());
  OutputFile three(folder_ / "three", Options());
  for (auto* output : {&one, &two, &three}) output->Write("new");
  SetContent(folder_ / "two", "somebody else's");
  EXPECT_THROW(CommitAll({&one, &two, &three}), std::runtime_error);
  EXPECT_EQ(Content(folder_ / "one"), "new");
  EXPECT_EQ(Content(folder_ / "two"), "somebody else's");
  EXPECT_EQ(Content(folder_ / "two.whole"), "new");
  EXPECT_EQ(Content(folder_ / "three"), "new");
}

TEST_F(Output, OfASetOfWhichOneCannotBeWrittenLeavesNothing) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this computer";
  {
    OutputFile one(file_, Options());
    OutputFile two("/dev/full", Options());
    for (auto* output : {&one, &two}) output->Write("new");
    EXPECT_THROW(CommitAll({&one, &two}), std::runtime_error);
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Output, ThatReplacesAFileIsOpenToTheSamePeople) {
  SetContent(file_, "a secret");
  fs::permissions(file_, fs::perms(0600));
  OutputFile output(file_, Options(true));
  EXPECT_EQ(fs::status(partial_).permissions(), fs::perms(0600));
  output.Commit();
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms(0600));
}

TEST_F(Output, FollowsNoSymbolicLinkAtItsName) {
  SetContent(folder_ / "target", "a recording");
  fs::create_symlink("target", file_);
  ExpectHas(FaultOf(file_), "as a symbolic link; --force replaces the link");
  OutputFile output(file_, Options(true));
  output.Write("new");
  output.Commit();
  EXPECT_EQ(Content(folder_ / "target"), "a recording");
  EXPECT_FALSE(fs::is_symlink(file_));
  EXPECT_EQ(Content(file_), "new");
}

TEST_F(Output, FollowsNoSymbolicLinkAtItsNameThatPointsNowhere) {
  fs::create_symlink("nowhere", file_);
  ExpectHas(FaultOf(file_), "as a symbolic link");
  EXPECT_FALSE(fs::exists(folder_ / "nowhere"));
}

TEST_F(Output, FollowsNoSymbolicLinkAtThePartial) {
  SetContent(folder_ / "target", "a recording");
  fs::create_symlink("target", partial_);
  for (const bool force : {false, true}) ExpectHas(FaultOf(file_, force), "out.partial: is a symbolic link");
  EXPECT_EQ(Content(folder_ / "target"), "a recording");
  EXPECT_TRUE(fs::is_symlink(partial_));
}

TEST_F(Output, DoesNotTouchAHardLinkAtThePartial) {
  SetContent(folder_ / "target", "a recording");
  fs::create_hard_link(folder_ / "target", partial_);
  OutputFile output(file_, Options(true));
  output.Write("new");
  output.Commit();
  EXPECT_EQ(Content(folder_ / "target"), "a recording");
  EXPECT_EQ(Content(file_), "new");
}

TEST_F(Output, RefusesAFolderAndAMissingFolderAndAnEmptyName) {
  ExpectHas(FaultOf(folder_, true), "is a folder");
  ExpectHas(FaultOf(folder_ / "missing/out", true), "its folder does not exist");
  ExpectHas(FaultOf(folder_ / "missing/", true), "is the name of a folder");
  ExpectHas(FaultOf("", true), "is empty");
  fs::create_directory(partial_);
  ExpectHas(FaultOf(file_, true), "out.partial: ");
  SetContent(folder_ / "file", "");
  ExpectHas(FaultOf(folder_ / "file/out", true), "Not a directory");
}

TEST_F(Output, RefusesAFolderThatCannotBeWrittenTo) {
  constexpr uid_t kNobody = 65534;
  const bool is_root = geteuid() == 0;  // to whom nothing is forbidden: it asks as somebody else
  fs::permissions(folder_, fs::perms(0555));
  if (is_root) {
    ASSERT_EQ(seteuid(kNobody), 0);
  }
  const auto fault = FaultOf(file_, true);
  if (is_root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  fs::permissions(folder_, fs::perms::owner_all);
  ExpectHas(fault, "out: cannot be made: Permission denied");
}

TEST_F(Output, IsNeverAnInputByWhateverName) {
  SetContent(file_, "a recording");
  fs::create_hard_link(file_, folder_ / "same");
  fs::create_symlink("out", folder_ / "link");
  for (const bool force : {false, true}) {
    ExpectHas(FaultOf(file_, force, {folder_ / "same"}), "is an input");
    ExpectHas(FaultOf(file_, force, {folder_ / "link"}), "is an input");
    ExpectHas(FaultOf(folder_ / "link", force, {file_}), "is an input");
  }
  EXPECT_EQ(Content(file_), "a recording");
}

TEST_F(Output, DoesNotRemoveAPartialThatIsAnInput) {
  SetContent(partial_, "of a run that was killed");
  ExpectHas(FaultOf(file_, true, {partial_}), "out.partial: is an input");
  EXPECT_EQ(Content(partial_), "of a run that was killed");
}

TEST_F(Output, DoesNotRemoveAPartialUnasked) {
  SetContent(partial_, "half, or somebody's");
  ExpectHas(FaultOf(file_), "out.partial: is there: left by a run that did not come to its end, or somebody's file");
  EXPECT_EQ(Content(partial_), "half, or somebody's");
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(Output, RemovesThePartialOfARunThatWasKilledWhenAskedAndSaysSo) {
  SetContent(partial_, "half");
  OutputFile output(file_, Options(true));
  output.Write("whole");
  output.Commit();
  EXPECT_EQ(Content(file_), "whole");
  ASSERT_EQ(told_.size(), 1u);
  ExpectHas(told_[0], "out.partial: was there, and nobody was writing it; removed");
}

TEST_F(Output, IsWrittenByOneProgramAtATime) {
  OutputFile output(file_, Options());
  output.Write("first");
  for (const bool force : {false, true}) ExpectHas(FaultOf(file_, force), "is being written by another program");
  output.Commit();
  EXPECT_EQ(Content(file_), "first");
}

// A log that is being recorded.
TEST_F(Output, DoesNotReplaceAFileThatAnotherProgramHasLockedAlsoByForce) {
  SetContent(file_, "a recording");
  const int recorder = open(file_.c_str(), O_WRONLY | O_APPEND);
  ASSERT_EQ(flock(recorder, LOCK_EX), 0);
  ExpectHas(FaultOf(file_, true), "is being written by another program");
  close(recorder);
  EXPECT_EQ(FaultOf(file_, true), "");
  OutputFile output(file_, Options(true));
  output.Write("new");
  const int late = open(file_.c_str(), O_WRONLY | O_APPEND);
  ASSERT_EQ(flock(late, LOCK_EX), 0);
  EXPECT_THROW(output.Commit(), std::runtime_error);
  close(late);
  EXPECT_EQ(Content(file_), "a recording");
  EXPECT_EQ(Content(whole_), "new");
}

// Many at once: one wins, the others say why not, and nobody's bytes are mixed.
TEST_F(Output, OfManyAtOnceIsWhole) {
  constexpr int kNumThreads = 8;
  for (int round = 0; round < 20; ++round) {
    fs::remove(file_);
    std::vector<std::thread> threads;
    std::atomic<int> num_written = 0;
    for (int i = 0; i < kNumThreads; ++i) {
      threads.emplace_back([&, i] {
        try {
          OutputFile output(file_, {false, {}, [](const std::string&) {}});
          output.Write(std::string(100'000, static_cast<char>('a' + i)));
          output.Commit();
          ++num_written;
        } catch (const std::runtime_error&) {
          // Another one was quicker.
        }
      });
    }
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(num_written, 1);
    const auto content = Content(file_);
    ASSERT_EQ(content.size(), 100'000u);
    EXPECT_EQ(std::ranges::count(content, content[0]), 100'000);
    EXPECT_FALSE(fs::exists(partial_));
  }
}

TEST_F(Output, SaysWhenSomebodyTookThePartialAway) {
  OutputFile output(file_, Options());
  output.Write("text");
  fs::remove(partial_);
  EXPECT_THROW(output.Commit(), std::runtime_error);
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(Output, ADeviceIsWrittenDirectly) {
  OutputFile output("/dev/null", Options());
  output.Write("text");
  output.Commit();
  EXPECT_FALSE(fs::exists("/dev/null.partial"));
}

TEST_F(Output, ALinkToADeviceIsWrittenDirectly) {
  fs::create_symlink("/dev/null", file_);
  OutputFile output(file_, Options());
  output.Write("text");
  output.Commit();
  EXPECT_TRUE(fs::is_symlink(file_));
}

TEST_F(Output, ThatTheDeviceDoesNotTakeIsAnErrorWithPathAndReason) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this computer";
  OutputFile output("/dev/full", Options());
  output.Write("text");
  try {
    output.Commit();
    FAIL() << "it was taken";
  } catch (const std::runtime_error& error) {
    ExpectHas(error.what(), "/dev/full: write failed: No space left on device");
  }
}

TEST_F(Output, AnOpenFileIsWrittenWhereItStands) {
  const int descriptor = open(file_.c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_EQ(write(descriptor, "before ", 7), 7);
  {
    OutputFile output("/dev/fd/" + std::to_string(descriptor), Options());
    output.Write("after");
    output.Commit();
  }
  close(descriptor);
  EXPECT_EQ(Content(file_), "before after");
}

TEST_F(Output, AnOpenFileThatIsAnInputIsRefused) {
  const int descriptor = open(file_.c_str(), O_WRONLY | O_CREAT, 0600);
  ExpectHas(FaultOf("/dev/fd/" + std::to_string(descriptor), true, {file_}), "is an input");
  close(descriptor);
}

TEST(OutputHead, IsWrittenLastAndOnlyIntoAFileOfItsOwn) {
  const support::TempDir folder;
  OutputFile output(folder / "out");
  output.Write("????, points");
  output.OverwriteStart("head");
  output.Write(" more");
  output.Commit();
  EXPECT_EQ(support::ReadFile(folder / "out"), "head, points more");
  OutputFile direct("/dev/null");
  direct.Write("????");
  EXPECT_THROW(direct.OverwriteStart("head"), std::runtime_error);
}

}  // namespace
}  // namespace lookout::io
