// An output in a folder of its own, and what it says.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <thread>
#include <vector>

#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "tests/support/files.hpp"

namespace lookout::io {

namespace fs = std::filesystem;

class Output : public ::testing::Test {
 protected:
  support::TempDir folder_;
  fs::path file_ = folder_ / "out";
  fs::path partial_ = folder_ / "out.partial";
  fs::path whole_ = folder_ / "out.whole";
  std::vector<std::string> told_;

  OutputOptions Options(bool force = false, std::vector<fs::path> inputs = {}) {
    return {force, std::move(inputs), [this](const std::string& line) { told_.push_back(line); }};
  }
  static std::string Content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void SetContent(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }
  // What the constructor throws; empty: nothing
  std::string FaultOf(const fs::path& file, bool force = false, std::vector<fs::path> inputs = {}) {
    try {
      const OutputFile output(file, Options(force, std::move(inputs)));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  static void ExpectHas(const std::string& text, const std::string& part) { EXPECT_NE(text.find(part), std::string::npos) << text; }
};

}  // namespace lookout::io
