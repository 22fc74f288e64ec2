// The page as Chromium shows it, and what it holds.
#pragma once

#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "lab/eval/report/report_page.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {

inline int CountOf(std::string_view text, std::string_view word) {
  int count = 0;
  for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + word.size())) ++count;
  return count;
}

inline bool Holds(std::string_view text, std::string_view word) { return text.find(word) != std::string_view::npos; }

/// What Chromium makes of the page of these results, as HTML without the page's own data, style and script.
inline std::string PageOf(const Results& results) {
  const support::TempDir folder;
  std::ostringstream page;
  WriteHtml(results, page);
  support::WriteFile(folder / "page.html", page.str());
  // Root has no sandbox.
  const auto line = "chromium --headless --no-sandbox --disable-gpu --user-data-dir=" + (folder / "profile").string() +
                    " --host-resolver-rules='MAP * ~NOTFOUND' --dump-dom file://" + (folder / "page.html").string() + " 2>" +
                    (folder / "said").string();
  std::string dom;
  auto* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no pipe");
  std::vector<char> block(65536);
  for (std::size_t count = 0; (count = fread(block.data(), 1, block.size(), pipe)) > 0;) dom.append(block.data(), count);
  EXPECT_EQ(pclose(pipe), 0) << "Debian's package chromium: " << support::ReadFile(folder / "said");
  return dom.substr(std::min(dom.find("<body>"), dom.size()));
}

inline std::string SectionOf(const std::string& page, const std::string& id) {
  const auto at = page.find("<section id=\"" + id + "\">");
  return at == std::string::npos ? "" : page.substr(at, page.find("</section>", at) - at);
}

}  // namespace lookout::eval
