#include "services/page/announcement.hpp"

#include <fmt/format.h>
#include <qrencode.h>

#include <memory>

namespace lookout::page {

std::string QrCode(const std::string& text) {
  struct Free {
    void operator()(QRcode* code) const { QRcode_free(code); }
  };
  const std::unique_ptr<QRcode, Free> code(QRcode_encodeString8bit(text.c_str(), 0, QR_ECLEVEL_M));
  if (!code) return {};
  constexpr int kQuietZone = 4;  // ISO/IEC 18004
  const auto is_dark = [&](int row, int column) {
    const bool is_inside = row >= 0 && row < code->width && column >= 0 && column < code->width;
    return is_inside && (code->data[row * code->width + column] & 1) != 0;
  };
  // A light module is drawn in the colour of letters. Two rows stand in one line.
  std::string lines;
  for (int row = -kQuietZone; row < code->width + kQuietZone; row += 2) {
    for (int column = -kQuietZone; column < code->width + kQuietZone; ++column) {
      const bool is_upper_light = !is_dark(row, column);
      const bool is_lower_light = !is_dark(row + 1, column);
      lines += is_upper_light ? (is_lower_light ? "\u2588" : "\u2580") : (is_lower_light ? "\u2584" : " ");
    }
    lines += "\n";
  }
  return lines;
}

std::string LinkText(const std::string& own_address, const std::vector<std::string>& addresses, const std::string& token) {
  const auto link = [&token](const std::string& address) { return token.empty() ? address : address + "#token=" + token; };
  std::string text = fmt::format("the look-out in a browser of this computer:\n  {}\n", link(own_address));
  if (!addresses.empty()) {
    text += "of a tablet:\n";
    for (const auto& address : addresses) text += fmt::format("  {}\n", link(address));
    text += QrCode(link(addresses.front()));
  }
  if (!token.empty()) text += "Whoever has a link with its token acknowledges alerts.\n";
  return text;
}

}  // namespace lookout::page
