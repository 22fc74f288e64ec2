// A page held against the rules of XML, as far as tests need them.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::eval {

/// @return the first fault of the markup: a tag that is not closed, closed twice or crossed, a quote that is not closed, a bare < or &; "" when there
/// is none. Not looked at: what stands within <style>, and the doctype.
inline std::string FaultOf(std::string_view markup) {
  constexpr std::string_view kDoctype = "<!doctype html>";
  if (markup.starts_with(kDoctype)) markup.remove_prefix(kDoctype.size());
  const auto around = [&](std::size_t at) { return "\"" + std::string(markup.substr(at, 60)) + "\""; };
  std::vector<std::string> open;
  std::size_t at = 0;
  while (at < markup.size()) {
    if (markup[at] == '>') return "bare > at " + around(at);
    if (markup[at] == '&') {
      const auto end = markup.find(';', at);
      if (end == std::string_view::npos || end - at > 8) return "bare & at " + around(at);
      at = end + 1;
      continue;
    }
    if (markup[at] != '<') {
      ++at;
      continue;
    }
    std::size_t end = at + 1;
    bool is_quoted = false;
    while (end < markup.size() && (is_quoted || markup[end] != '>')) {
      if (markup[end] == '<') return "bare < at " + around(at);
      if (markup[end] == '"') is_quoted = !is_quoted;
      ++end;
    }
    if (end == markup.size()) return "tag without end at " + around(at);
    const auto tag = markup.substr(at + 1, end - at - 1);
    const bool is_closing = tag.starts_with('/');
    const auto name = std::string(tag.substr(is_closing ? 1 : 0, tag.find_first_of(" /\n", 1) - (is_closing ? 1 : 0)));
    at = end + 1;
    if (is_closing) {
      if (open.empty() || open.back() != name) return "</" + name + "> does not close <" + (open.empty() ? "" : open.back()) + ">";
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(name);
      if (name == "style") at = std::min(markup.find("</style>", at), markup.size());
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

inline int CountOf(std::string_view text, std::string_view word) {
  int count = 0;
  for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + word.size())) ++count;
  return count;
}

inline bool Holds(std::string_view text, std::string_view word) { return text.find(word) != std::string_view::npos; }

}  // namespace lookout::eval
