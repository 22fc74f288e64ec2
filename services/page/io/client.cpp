#include "services/page/io/client.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <utility>

#include "services/page/core/replies.hpp"

namespace lookout::page {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

namespace {

constexpr std::chrono::seconds kMaxHandshake{5};
constexpr std::chrono::seconds kPingPeriod{5};
constexpr std::chrono::seconds kMaxSilence{20};
constexpr std::chrono::seconds kMaxClosing{2};
constexpr int kMaxFaults = 10;
constexpr std::size_t kMaxUnconfirmedFrames = 24;
constexpr std::size_t kMaxUnconfirmedBytes = 2'000'000;
constexpr std::size_t kMaxQuestions = 16;
constexpr std::size_t kMaxTexts = 32;
constexpr std::size_t kMaxFoundBytes = std::size_t{32} * 1024 * 1024;     // of one answer
constexpr std::size_t kMaxAllFoundBytes = std::size_t{64} * 1024 * 1024;  // before another is looked for

std::uint32_t IdOf(const auto& question) {
  return std::visit([](const auto& one) { return one.id; }, question);
}

}  // namespace

Client::Client(Hub& hub, beast::tcp_stream stream, Place place)
    : hub_(hub),
      socket_(std::move(stream)),
      connection_place_(std::move(place)),
      client_place_(hub.counts, "clients"),
      heard_(std::chrono::steady_clock::now()),
      pinged_(heard_) {}

void Client::Start(const beast::http::request<beast::http::string_body>& request) {
  hub_.clients.insert(shared_from_this());
  socket_.set_option(websocket::stream_base::timeout{kMaxHandshake, websocket::stream_base::none(), false});
  socket_.set_option(websocket::stream_base::decorator(
      [](websocket::response_type& response) { response.set(beast::http::field::sec_websocket_protocol, "lookout.page.v1"); }));
  socket_.auto_fragment(false);
  socket_.read_message_max(kMaxRequestBytes);
  socket_.control_callback([this](websocket::frame_type, boost::string_view) { heard_ = std::chrono::steady_clock::now(); });
  socket_.async_accept(request, [self = shared_from_this()](error_code error) {
    if (error) return self->Gone();
    self->hub_.counts->Add("openings");
    self->is_open_ = true;
    const auto now = std::chrono::time_point_cast<std::chrono::microseconds>(std::chrono::system_clock::now());
    const auto& options = self->hub_.options;
    self->Tell(HelloText({options.is_log, options.version, options.host, now, self->hub_.may_acknowledge()}, self->hub_.sources));
    self->Read();
  });
}

void Client::Read() {
  if (is_reading_ || is_closing_ || is_gone_) return;
  is_reading_ = true;
  socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
    self->is_reading_ = false;
    if (error) {
      if (error != websocket::error::closed && error.category() == websocket::make_error_code(websocket::error::closed).category())
        self->hub_.counts->Add("client_faults");
      return self->Gone();
    }
    self->heard_ = std::chrono::steady_clock::now();
    if (!self->socket_.got_text()) {
      self->hub_.counts->Add("client_faults");
      return self->Close(websocket::close_code::unknown_data, "texts only");
    }
    const auto bytes = self->buffer_.cdata();
    self->OnText({static_cast<const char*>(bytes.data()), bytes.size()});
    self->buffer_.clear();
    // A client that does not read its answers is not listened to.
    if (self->texts_.size() < kMaxTexts) self->Read();
  });
}

void Client::OnText(std::string_view text) {
  if (is_closing_) return;
  RequestFault fault;
  const auto request = ParseRequest(text, fault);
  if (request) return std::visit([this](const auto& one) { Do(one); }, *request);
  hub_.counts->Add("client_faults");
  if (++num_faults_ > kMaxFaults) return Close(websocket::close_code::policy_error, "too much that is no request");
  Refuse(fault.id, fault.reason);
}

void Client::Do(const Watch& watch) {
  for (const auto channel : watched_) --hub_.num_watching[channel];
  watched_ = watch.channels;
  for (const auto channel : watched_) ++hub_.num_watching[channel];
  slots_.KeepOnly(watched_);
}

void Client::Do(const Got& got) {
  if (got.num_frames > num_sent_ || got.num_frames < num_confirmed_) {
    hub_.counts->Add("client_faults");
    return Close(websocket::close_code::protocol_error, "it confirms what was not sent");
  }
  for (; num_confirmed_ < got.num_frames; ++num_confirmed_) {
    num_unconfirmed_bytes_ -= unconfirmed_.front();
    unconfirmed_.pop_front();
  }
  SendOn();
}

void Client::Do(const At& at) {
  // Where a hand draws along the time line only the last place counts.
  const auto is_old = [](const Question& question) { return std::holds_alternative<At>(question); };
  for (const auto& question : questions_) {
    if (is_old(question)) Refuse(IdOf(question), "replaced");
  }
  std::erase_if(questions_, is_old);
  Ask(at);
}

void Client::Ask(Question question) {
  if (!hub_.parts.recordings) return Refuse(IdOf(question), "there is no recording");
  if (questions_.size() >= kMaxQuestions) return Refuse(IdOf(question), "too many");
  questions_.push_back(std::move(question));
  AskNext();
}

void Client::AskNext() {
  while (!is_asking_ && !is_gone_ && !questions_.empty()) {
    auto question = std::move(questions_.front());
    questions_.pop_front();
    if (hub_.num_answer_bytes > kMaxAllFoundBytes) {
      Refuse(IdOf(question), "busy");
      continue;
    }
    is_asking_ = true;
    asio::post(hub_.disk, [&hub = hub_, self = weak_from_this(), question = std::move(question)] {
      if (self.expired()) return;
      auto found = Find(*hub.parts.recordings, question);
      asio::post(hub.context, [self, found = std::move(found)]() mutable {
        if (const auto client = self.lock()) client->OnFound(std::move(found));
      });
    });
  }
}

// On the thread that reads disks.
Client::Found Client::Find(Recordings& recordings, const Question& question) try {
  Found found;
  if (const auto* strip = std::get_if<StripRequest>(&question)) {
    found.text = recordings.Strip(*strip);
    if (found.text.empty()) found.text = RefusedText(strip->id, "there is nothing");
    return found;
  }
  const auto* at = std::get_if<At>(&question);
  auto answer = at != nullptr ? recordings.Find(*at) : recordings.Find(std::get<Range>(question));
  const int source = at != nullptr ? at->source : std::get<Range>(question).source;
  const auto id = IdOf(question);
  for (const auto& message : answer.messages) found.num_bytes += kFrameHeadBytes + message.bytes.size();
  if (!answer.refusal.empty() || found.num_bytes > kMaxFoundBytes) {
    found.num_bytes = 0;
    found.text = RefusedText(id, answer.refusal.empty() ? "too much: ask for a shorter time or fewer messages" : answer.refusal);
    return found;
  }
  for (auto& message : answer.messages) {
    const FrameHead head{static_cast<std::uint8_t>(source), message.channel, id, message.time};
    found.frames.push_back(std::make_shared<const std::vector<std::uint8_t>>(ToFrame(head, message.bytes)));
    message.bytes = {};  // frees each message as soon as its frame is made, so that an answer is not held twice
  }
  found.text = AnswerText(id, source, answer, found.frames.size());
  return found;
} catch (const std::exception&) {
  Found refused;
  refused.text = RefusedText(IdOf(question), "the recording cannot be read");
  return refused;
}

void Client::OnFound(Found found) {
  if (is_gone_) return;
  found_ = std::move(found);
  hub_.num_answer_bytes += found_.num_bytes;
  hub_.counts->Add("answers");
  SendOn();
}

void Client::Offer(ChannelIndex channel, const std::string& slot, std::int64_t group, int part, const SharedBytes& frame) {
  if (!is_open_ || is_closing_ || is_gone_ || !std::ranges::binary_search(watched_, channel)) return;
  slots_.Put(channel, slot, group, part, frame);
  const auto num_lost = slots_.num_replaced() + slots_.num_dropped();
  if (num_lost != num_replaced_told_) hub_.counts->Add("frames_replaced", num_lost - num_replaced_told_);
  num_replaced_told_ = num_lost;
  SendOn();
}

void Client::TellSources() {
  has_new_sources_ = true;
  SendOn();
}

void Client::TellIndexing(int source, double share) {
  if (source >= 0 && source < kMaxSources) indexing_[source] = share;
  SendOn();
}

void Client::Tell(std::string text) {
  texts_.push_back(std::move(text));
  SendOn();
}

void Client::Refuse(std::uint32_t id, std::string_view reason) { Tell(RefusedText(id, reason)); }

bool Client::HasRoom() const { return unconfirmed_.size() < kMaxUnconfirmedFrames && num_unconfirmed_bytes_ < kMaxUnconfirmedBytes; }

// Live frames and answers take turns, so that neither waits for all of the others.
SharedBytes Client::NextFrame() {
  const bool is_live = !slots_.is_empty() && (found_.frames.empty() || is_turn_of_live_);
  is_turn_of_live_ = !is_live;
  if (is_live) return slots_.Take();
  if (found_.frames.empty()) return nullptr;
  auto frame = std::move(found_.frames.front());
  found_.frames.pop_front();
  return frame;
}

void Client::SendOn() {
  if (!is_open_ || is_closing_ || is_gone_ || is_writing_) return;
  if (found_.frames.empty() && !found_.text.empty()) {
    texts_.push_back(std::move(found_.text));
    hub_.num_answer_bytes -= found_.num_bytes;
    found_ = {};
    is_asking_ = false;
  }
  if (!texts_.empty()) {
    auto text = std::move(texts_.front());
    texts_.pop_front();
    return Write(nullptr, std::move(text));
  }
  if (has_new_sources_) {
    has_new_sources_ = false;
    return Write(nullptr, SourcesMessage(hub_.sources));
  }
  if (!indexing_.empty()) {
    const auto [source, share] = *indexing_.begin();
    indexing_.erase(indexing_.begin());
    return Write(nullptr, IndexingText(source, share));
  }
  if (!HasRoom()) return;
  if (auto frame = NextFrame()) Write(std::move(frame), {});
}

void Client::Write(SharedBytes frame, std::string text) {
  is_writing_ = true;
  sending_frame_ = std::move(frame);
  sending_text_ = std::move(text);
  socket_.binary(sending_frame_ != nullptr);
  if (sending_frame_) {
    ++num_sent_;
    unconfirmed_.push_back(sending_frame_->size());
    num_unconfirmed_bytes_ += sending_frame_->size();
    hub_.counts->Add("frames_sent");
  }
  const auto buffer = sending_frame_ ? asio::buffer(*sending_frame_) : asio::buffer(std::as_const(sending_text_));
  socket_.async_write(buffer, [self = shared_from_this()](error_code error, std::size_t) {
    self->is_writing_ = false;
    self->sending_frame_ = nullptr;
    if (error) return self->Gone();
    self->AskNext();
    self->SendOn();
    if (self->texts_.size() < kMaxTexts) self->Read();
  });
}

void Client::Tick(SteadyTime now) {
  if (is_gone_) return;
  if (is_closing_ && now - closing_since_ > kMaxClosing) return Cut();
  if (now - heard_ > kMaxSilence) {
    hub_.counts->Add("clients_silent");
    return Cut();
  }
  if (!is_open_ || is_closing_ || is_pinging_ || now - pinged_ < kPingPeriod) return;
  is_pinging_ = true;
  pinged_ = now;
  socket_.async_ping({}, [self = shared_from_this()](error_code) { self->is_pinging_ = false; });
}

void Client::Close(websocket::close_code code, const char* reason) {
  if (is_closing_ || is_gone_) return;
  if (!is_open_) return Cut();
  is_closing_ = true;
  closing_since_ = std::chrono::steady_clock::now();
  socket_.async_close({code, reason}, [self = shared_from_this()](error_code) { self->Gone(); });
}

void Client::Cut() {
  beast::get_lowest_layer(socket_).close();
  Gone();
}

void Client::Gone() {
  if (is_gone_) return;
  is_gone_ = true;
  Do(Watch{});
  hub_.num_answer_bytes -= found_.num_bytes;
  found_ = {};
  texts_.clear();
  questions_.clear();
  beast::get_lowest_layer(socket_).close();
  hub_.clients.erase(shared_from_this());
}

}  // namespace lookout::page
