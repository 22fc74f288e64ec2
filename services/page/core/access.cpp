#include "services/page/core/access.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>

namespace lookout::page {

namespace {

constexpr int kMaxZoom = 24;

char Lower(char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; }

bool IsSame(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return Lower(x) == Lower(y); });
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// Calls with each element of a list that commas (or another sign) separate, blanks around it removed.
template <class Function>
void ForEach(std::string_view list, char separator, Function&& function) {
  while (!list.empty()) {
    const auto end = std::min(list.find(separator), list.size());
    function(Trimmed(list.substr(0, end)));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
}

// "0", "0.0" ...: not acceptable.
bool IsZeroQuality(std::string_view parameter) {
  return parameter.size() >= 3 && Lower(parameter[0]) == 'q' && parameter[1] == '=' &&
         parameter.substr(2).find_first_not_of("0.") == std::string_view::npos;
}

// A number as it is written by programs: digits without a zero before them.
std::optional<int> ParseNumber(std::string_view text) {
  if (text.empty() || (text.size() > 1 && text.front() == '0')) return std::nullopt;
  int number = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

}  // namespace

bool IsOwnHost(std::string_view host, const OwnHosts& own) {
  const std::string port = ":" + std::to_string(own.port);
  return std::ranges::any_of(own.names, [&](const std::string& name) {
    if (name.empty() || host.size() < name.size() || !IsSame(host.substr(0, name.size()), name)) return false;
    const auto rest = host.substr(name.size());
    return rest == port || (rest.empty() && own.port == 80);
  });
}

bool IsOwnOrigin(std::string_view origin, const OwnHosts& own) {
  constexpr std::string_view kScheme = "http://";
  return origin.size() > kScheme.size() && IsSame(origin.substr(0, kScheme.size()), kScheme) && IsOwnHost(origin.substr(kScheme.size()), own);
}

bool HasToken(std::string_view authorization, std::string_view token) {
  constexpr std::string_view kScheme = "Bearer ";
  if (token.empty() || authorization.size() < kScheme.size() || !IsSame(authorization.substr(0, kScheme.size()), kScheme)) return false;
  const auto given = authorization.substr(kScheme.size());
  auto difference = static_cast<unsigned>(given.size() != token.size());
  for (std::size_t i = 0; i < given.size(); ++i) {
    // The barrier keeps the compiler from leaving the loop at the first difference.
    difference |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(token[i % token.size()]);
    asm volatile("" : "+r"(difference));
  }
  return difference == 0;
}

std::vector<std::pair<std::string_view, std::string>> SecurityHeaders(std::string_view host) {
  return {{"Content-Security-Policy",
           "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self' ws://" + std::string(host) +
               "; manifest-src 'self'; worker-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"},
          {"X-Content-Type-Options", "nosniff"},
          {"X-Frame-Options", "DENY"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Opener-Policy", "same-origin"},
          {"Cross-Origin-Resource-Policy", "same-origin"}};
}

bool AcceptsGzip(std::string_view accept_encoding) {
  bool is_accepted = false;
  ForEach(accept_encoding, ',', [&](std::string_view element) {
    bool is_gzip = false;
    bool is_refused = false;
    bool is_first = true;
    ForEach(element, ';', [&](std::string_view word) {
      if (is_first) is_gzip = IsSame(word, "gzip") || IsSame(word, "x-gzip");
      if (!is_first && IsZeroQuality(word)) is_refused = true;
      is_first = false;
    });
    if (is_gzip) is_accepted = !is_refused;
  });
  return is_accepted;
}

bool HoldsWord(std::string_view list, std::string_view word) {
  bool is_held = false;
  ForEach(list, ',', [&](std::string_view element) { is_held = is_held || element == word; });
  return is_held;
}

bool ParseTilePath(std::string_view path, TileAddress& address) {
  constexpr std::string_view kFolder = "/tiles/";
  if (!path.starts_with(kFolder) || path.ends_with('/')) return false;
  std::vector<std::optional<int>> numbers;
  std::size_t begin = kFolder.size();
  while (begin <= path.size() && numbers.size() < 4) {
    const auto end = std::min(path.find('/', begin), path.size());
    numbers.push_back(ParseNumber(path.substr(begin, end - begin)));
    begin = end + 1;
  }
  if (numbers.size() != 3 || std::ranges::any_of(numbers, [](const auto& number) { return !number; })) return false;
  const TileAddress read{*numbers[0], *numbers[1], *numbers[2]};
  if (read.z > kMaxZoom || read.x >= (1 << read.z) || read.y >= (1 << read.z)) return false;
  address = read;
  return true;
}

}  // namespace lookout::page
