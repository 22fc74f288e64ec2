// A browser's WebSocket: live messages of the channels that it watches, and answers out of recordings.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/page/core/slots.hpp"
#include "services/page/io/hub.hpp"

namespace lookout::page {

class Client : public std::enable_shared_from_this<Client> {
 public:
  /// @param place  of the connection that it was
  Client(Hub& hub, boost::beast::tcp_stream stream, Place place);

  /// @param request  one to become a WebSocket
  void Start(const boost::beast::http::request<boost::beast::http::string_body>& request);

  void Offer(ChannelIndex channel, const std::string& slot, std::int64_t group, int part, const SharedBytes& frame);
  void TellSources();
  void TellIndexing(int source, double share);

  /// Once a second: asks whether it is there, and lets it go when it is not.
  void Tick(SteadyTime now);

  /// Says so to the browser.
  void Close(boost::beast::websocket::close_code code, const char* reason);
  /// Without a word.
  void Cut();

 private:
  using Question = std::variant<At, Range, StripRequest>;
  // The answer to a question.
  struct Found {
    std::deque<SharedBytes> frames;
    std::size_t num_bytes = 0;
    std::string text;
  };

  void Read();
  void OnText(std::string_view text);
  void Do(const Watch& watch);
  void Do(const Got& got);
  void Do(const At& at);
  void Do(const Range& range) { Ask(range); }
  void Do(const StripRequest& strip) { Ask(strip); }
  void Ask(Question question);
  void AskNext();
  void OnFound(Found found);
  static Found Find(Recordings& recordings, const Question& question);

  void Tell(std::string text);
  void Refuse(std::uint32_t id, std::string_view reason);

  bool HasRoom() const;
  void SendOn();
  SharedBytes NextFrame();
  void Write(SharedBytes frame, std::string text);
  void Gone();

  Hub& hub_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Place connection_place_;
  Place client_place_;
  boost::beast::flat_buffer buffer_;

  bool is_open_ = false;
  bool is_closing_ = false;
  bool is_gone_ = false;
  SteadyTime closing_since_{};
  SteadyTime heard_{};
  SteadyTime pinged_{};
  bool is_pinging_ = false;
  int num_faults_ = 0;
  bool is_reading_ = false;

  std::vector<ChannelIndex> watched_;
  Slots slots_;
  std::int64_t num_replaced_told_ = 0;
  std::deque<std::string> texts_;
  bool has_new_sources_ = false;
  std::map<int, double> indexing_;  // shares to be told, by source

  std::deque<Question> questions_;
  bool is_asking_ = false;  // a question is with the disk thread, or its answer is being sent
  Found found_;
  bool is_turn_of_live_ = false;

  bool is_writing_ = false;
  SharedBytes sending_frame_;
  std::string sending_text_;
  std::uint64_t num_sent_ = 0;           // binary frames
  std::uint64_t num_confirmed_ = 0;      // binary frames that the page has confirmed
  std::deque<std::size_t> unconfirmed_;  // sizes of frames that are not confirmed
  std::size_t num_unconfirmed_bytes_ = 0;
};

}  // namespace lookout::page
