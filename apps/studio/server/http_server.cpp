#include "apps/studio/server/http_server.h"

// First: Boost 1.74 does not include it where it needs it.
#include <utility>

#include <time.h>

#include <boost/asio.hpp>
#include <boost/beast.hpp>
#include <chrono>
#include <deque>
#include <list>
#include <optional>

#include "apps/studio/server/allowance.h"
#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir::studio {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr auto kHeaderTime = std::chrono::seconds(10);
constexpr auto kBodyTime = std::chrono::seconds(120);
constexpr unsigned kServerError = 500, kUnavailable = 503;
/// Until connections are accepted again that could not be, as the process has no descriptor left.
constexpr auto kAcceptAgain = std::chrono::milliseconds(100);
/// Of the server's thread, for a message beside what is made of it: reading it, and writing the answer.
constexpr Allowance::Seconds kMessageTime{20e-6};
/// Of memory, for each message that waits to be written, beside its bytes.
constexpr std::int64_t kMessageBytes = 128;
/// Answers and events wait for a client up to this part of what may wait altogether.
constexpr std::int64_t kTextsShare = 4;
constexpr std::size_t kKeptBuffer = 64 << 10;
constexpr std::uint32_t kLargestHeader = 16 << 10;
constexpr std::uint64_t kLargestBody = 16 << 10;  // of what is not an upload, and is not read

constexpr const char* kPagePolicy =
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; worker-src 'self' "
    "blob:; "
    "object-src 'none'; base-uri 'none'; frame-ancestors 'none'";
constexpr const char* kForeignPolicy =
    "sandbox; default-src 'none'; img-src 'self'; media-src 'self'; style-src 'unsafe-inline'; "
    "frame-ancestors 'none'";

using RequestParser = http::request_parser<http::string_body>;
using UploadParser = http::request_parser<http::file_body>;
using Reply = http::response<http::string_body>;

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// Of one hexadecimal digit, or -1.
int digitValue(char c) {
  constexpr int kTen = 10;
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + kTen;
  if (c >= 'A' && c <= 'F') return c - 'A' + kTen;
  return -1;
}

/// Text of an address with its %41 replaced; broken ones stay as they are.
std::string decoded(std::string_view text) {
  constexpr int kBase = 16;
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool code =
        text[i] == '%' && i + 2 < text.size() && digitValue(text[i + 1]) >= 0 && digitValue(text[i + 2]) >= 0;
    if (code) {
      result += static_cast<char>(digitValue(text[i + 1]) * kBase + digitValue(text[i + 2]));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

HttpRequest plainRequest(const http::request_header<>& request) {
  HttpRequest plain;
  plain.method = request.method_string().to_string();
  const std::string_view target = view(request.target());
  const std::size_t mark = target.find('?');
  plain.path = decoded(target.substr(0, mark));
  std::string_view rest = mark == std::string_view::npos ? "" : target.substr(mark + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view pair = rest.substr(0, end);
    const std::size_t equals = std::min(pair.find('='), pair.size());
    plain.query[decoded(pair.substr(0, equals))] =
        equals < pair.size() ? decoded(pair.substr(equals + 1)) : std::string();
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return plain;
}

HttpReply refusal(Access access) {
  constexpr unsigned kUnauthorized = 401, kForbidden = 403;
  switch (access) {
    case Access::kForeignHost:
      return {.status = kForbidden, .body = "this server is not known by that name"};
    case Access::kForeignOrigin:
      return {.status = kForbidden, .body = "pages of other sites may not use this server"};
    default:
      return {.status = kUnauthorized,
              .body = "the token is missing or wrong: open the address that 'weir studio' printed"};
  }
}

/// That the calling thread has used.
Allowance::Seconds threadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

unsigned statusOf(const Error& error) {
  constexpr unsigned kBadRequest = 400;
  return error.kind() == ErrorKind::kUsage || error.kind() == ErrorKind::kScene ? kBadRequest : kServerError;
}

}  // namespace

class HttpServer::State {
 public:
  State(const ServerOptions& options, ServerEvents& events)
      : options_(options), events_(events), acceptor_(context_), acceptAgain_(context_) {
    try {
      const Tcp::endpoint endpoint(asio::ip::make_address(options.host),
                                   static_cast<unsigned short>(options.port));
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& e) {
      throw ioError("the studio cannot listen at " + printable(options.host) + ":" +
                        std::to_string(options.port) + ": " + e.code().message(),
                    "an address of this machine and a free port", "without --port a free one is taken");
    }
    access_.emplace(options.host, port(), options.token);
  }

  int port() const { return acceptor_.local_endpoint().port(); }
  const AccessRules& access() const { return *access_; }

  void run() {
    accept();
    context_.run();
  }
  void stop() { context_.stop(); }
  void post(std::function<void()> f) { asio::post(context_, std::move(f)); }
  void send(ClientId client, std::shared_ptr<const std::string> bytes, bool binary);

 private:
  class Connection;
  class Socket;

  void accept();

  ServerOptions options_;
  ServerEvents& events_;
  // Before the context, which ends the last ones.
  int connections_ = 0;               // whose clients are known
  std::list<Connection*> strangers_;  // the others, the oldest first
  asio::io_context context_{1};
  Tcp::acceptor acceptor_;
  asio::steady_timer acceptAgain_;
  std::optional<AccessRules> access_;
  std::map<ClientId, std::shared_ptr<Socket>> sockets_;
  ClientId lastClient_ = 0;
};

/// An open WebSocket.
class HttpServer::State::Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(State& server, beast::tcp_stream&& stream)
      : server_(server),
        stream_(std::move(stream)),
        resume_(stream_.get_executor()),
        allowance_(Allowance::Clock::now()) {
    ++server_.connections_;
  }
  ~Socket() { --server_.connections_; }

  void accept(const http::request<http::string_body>& request) {
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.auto_fragment(false);  // else a frame leaves in pieces of 4 kB, each a write of its own
    stream_.read_message_max(static_cast<std::size_t>(server_.options_.largestMessage));
    stream_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->id_ = ++self->server_.lastClient_;
      self->server_.sockets_[self->id_] = self;
      self->server_.events_.opened(self->id_);
      self->read();
    });
  }

  void send(std::shared_ptr<const std::string> bytes, bool binary) {
    queue_.emplace_back(std::move(bytes), binary);
    count(1);
    // It has stopped reading. A single text may be as long as it is.
    const std::int64_t max = server_.options_.maxWaitingBytes;
    if (waiting_ > max || (waitingTexts_ > max / kTextsShare && !binary && queue_.size() > kFew))
      return drop();
    if (queue_.size() == 1) write();
  }

 private:
  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->drop();
      self->receive();
    });
  }

  void receive() {
    const Allowance::Seconds start = threadTime();
    try {
      const auto text = buffer_.data();
      if (stream_.got_text())
        server_.events_.message(id_, {static_cast<const char*>(text.data()), text.size()});
    } catch (const std::exception&) {
      return drop();
    }
    buffer_.consume(buffer_.size());
    if (buffer_.capacity() > kKeptBuffer) buffer_.shrink_to_fit();
    if (gone_) return;
    const auto wait = allowance_.spend(threadTime() - start + kMessageTime, server_.events_.shareOf(id_),
                                       Allowance::Clock::now());
    if (wait == wait.zero()) return read();
    // What it sends meanwhile waits on its side.
    resume_.expires_after(std::chrono::duration_cast<Allowance::Clock::duration>(wait));
    resume_.async_wait([self = shared_from_this()](error_code error) {
      if (!error && !self->gone_) self->read();
    });
  }

  /// Adds the last message that waits to what is counted (1), or takes away the first (-1).
  void count(int sign) {
    const auto& [bytes, binary] = sign > 0 ? queue_.back() : queue_.front();
    const std::int64_t size = sign * (static_cast<std::int64_t>(bytes->size()) + kMessageBytes);
    waiting_ += size;
    if (!binary) waitingTexts_ += size;
  }

  void write() {
    stream_.binary(queue_.front().second);
    stream_.async_write(asio::buffer(*queue_.front().first),
                        [self = shared_from_this()](error_code error, std::size_t) {
                          if (error) return self->drop();
                          self->count(-1);
                          self->queue_.pop_front();
                          if (!self->queue_.empty() && !self->gone_) self->write();
                        });
  }

  void drop() {
    if (gone_) return;
    gone_ = true;
    resume_.cancel();
    error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
    server_.sockets_.erase(id_);
    server_.events_.closed(id_);
  }

  static constexpr std::size_t kFew = 16;

  State& server_;
  websocket::stream<beast::tcp_stream> stream_;
  asio::steady_timer resume_;
  Allowance allowance_;
  beast::flat_buffer buffer_;
  std::deque<std::pair<std::shared_ptr<const std::string>, bool>> queue_;  // the first is being written
  std::int64_t waiting_ = 0, waitingTexts_ = 0;
  ClientId id_ = 0;
  bool gone_ = false;
};

/// A connection until it ends or becomes a WebSocket.
class HttpServer::State::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(State& server, Tcp::socket&& socket) : server_(server), stream_(std::move(socket)) {}
  ~Connection() {
    setStranger(false);
    setKnown(false);
  }

  /// Ends it; its last handler lets it go.
  void close() {
    setStranger(false);
    stream_.close();
  }

  void readHeader() {
    setKnown(false);
    setStranger(true);
    parser_.emplace();
    parser_->header_limit(kLargestHeader);
    // What a PUT may hold is told when its header has been read.
    parser_->body_limit(static_cast<std::uint64_t>(server_.options_.largestUpload));
    stream_.expires_after(kHeaderTime);
    http::async_read_header(
        stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
          if (error == http::error::body_limit)
            return self->refuseBody(static_cast<std::uint64_t>(self->server_.options_.largestUpload));
          if (!error) self->header();
        });
  }

 private:
  void header() {
    const http::request_header<>& request = parser_->get();
    request_ = plainRequest(request);
    const auto token = request_.query.find("token");
    error_code ignored;
    const std::string local = stream_.socket().local_endpoint(ignored).address().to_string();
    const Access access =
        server_.access_->check({.host = view(request[http::field::host]),
                                .origin = view(request[http::field::origin]),
                                .cookie = view(request[http::field::cookie]),
                                .authorization = view(request[http::field::authorization]),
                                .token = token != request_.query.end() ? std::string_view(token->second) : "",
                                .local = local});
    keep_ = false;  // what is refused has a body that nobody reads
    if (access != Access::kGranted) return reply(refusal(access));
    if (server_.connections_ >= server_.options_.maxConnections)
      return reply({.status = kUnavailable, .body = "too many windows are open: close some of them"});
    setStranger(false);
    setKnown(true);
    if (websocket::is_upgrade(parser_->get())) return upgrade();
    stream_.expires_after(kBodyTime);
    if (request_.method == "PUT") return upload();
    if (parser_->content_length().value_or(0) > kLargestBody) return refuseBody(kLargestBody);
    parser_->body_limit(kLargestBody);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == http::error::body_limit) return self->refuseBody(kLargestBody);
      if (!error) self->answer(self->parser_->get().keep_alive());
    });
  }

  void upload() {
    try {
      part_.file = server_.events_.uploadPlace(request_);
    } catch (const Error& e) {
      return reply({.status = statusOf(e), .body = e.what()});
    }
    upload_.emplace(std::move(*parser_));
    error_code closed;
    upload_->get().body().open(part_.file.c_str(), beast::file_mode::write, closed);
    if (closed)
      return reply({.status = kServerError, .body = "the file cannot be written: " + closed.message()});
    http::async_read(stream_, buffer_, *upload_, [self = shared_from_this()](error_code error, std::size_t) {
      self->upload_->get().body().close();
      if (error == http::error::body_limit)
        return self->refuseBody(static_cast<std::uint64_t>(self->server_.options_.largestUpload));
      if (error && error.category() == boost::system::system_category())
        return self->reply(
            {.status = kServerError, .body = "the file cannot be written: " + error.message()});
      if (error) return;
      self->request_.upload = self->part_.file;
      self->answer(self->upload_->get().keep_alive());
      self->part_.remove();
    });
  }

  void refuseBody(std::uint64_t max) {
    constexpr unsigned kTooLarge = 413;
    keep_ = false;
    reply({.status = kTooLarge, .body = "a request may hold at most " + std::to_string(max) + " bytes"});
  }

  void answer(bool keep) {
    constexpr unsigned kSeeOther = 303;
    keep_ = keep;
    // The browser keeps the token as a cookie, so that it does not stay in the address.
    if (request_.path == "/" && request_.query.contains("token"))
      return reply({.status = kSeeOther, .body = ""});
    try {
      reply(server_.events_.request(request_));
    } catch (const Error& e) {
      reply({.status = statusOf(e), .body = e.what()});
    }
  }

  void upgrade() {
    stream_.expires_never();
    setKnown(false);  // the socket is
    std::make_shared<Socket>(server_, std::move(stream_))->accept(parser_->get());
  }

  void reply(HttpReply plain) {
    constexpr unsigned kVersion = 11, kSeeOther = 303;
    reply_.emplace(static_cast<http::status>(plain.status), kVersion);
    reply_->set(http::field::content_type, plain.type);
    reply_->set(http::field::cache_control, "no-store");
    reply_->set("X-Content-Type-Options", "nosniff");
    reply_->set("Referrer-Policy", "no-referrer");
    reply_->set("Cross-Origin-Resource-Policy", "same-origin");
    reply_->set("Content-Security-Policy", plain.isForeign ? kForeignPolicy : kPagePolicy);
    if (plain.isForeign && !plain.type.starts_with("image/") && !plain.type.starts_with("video/"))
      reply_->set(http::field::content_disposition, "attachment");
    if (plain.status == kSeeOther) {
      reply_->set(http::field::location, "/");
      reply_->set(http::field::set_cookie, server_.access_->cookie());
    }
    reply_->keep_alive(keep_);
    reply_->body() = std::move(plain.body);
    reply_->prepare_payload();
    stream_.expires_after(kBodyTime);
    http::async_write(stream_, *reply_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return;
      if (self->keep_) return self->readHeader();
      error_code ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    });
  }

  /// Nobody knows yet who is at the other end.
  void setStranger(bool on) {
    if (on == (place_ != server_.strangers_.end())) return;
    if (on) {
      place_ = server_.strangers_.insert(server_.strangers_.end(), this);
    } else {
      server_.strangers_.erase(place_);
      place_ = server_.strangers_.end();
    }
  }
  void setKnown(bool on) {
    if (on != known_) server_.connections_ += on ? 1 : -1;
    known_ = on;
  }

  State& server_;
  std::list<Connection*>::iterator place_ = server_.strangers_.end();
  bool known_ = false;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  /// A file that is removed if nobody has moved it away.
  struct Part {
    std::filesystem::path file;
    ~Part() { remove(); }
    void remove() {
      std::error_code ignored;
      if (!file.empty()) std::filesystem::remove(file, ignored);
      file.clear();
    }
  };

  std::optional<RequestParser> parser_;
  std::optional<UploadParser> upload_;
  HttpRequest request_;
  Part part_;
  std::optional<Reply> reply_;
  bool keep_ = false;
};

void HttpServer::State::accept() {
  acceptor_.async_accept([this](error_code error, Tcp::socket socket) {
    if (error) {
      acceptAgain_.expires_after(kAcceptAgain);
      acceptAgain_.async_wait([this](error_code) { accept(); });
      return;
    }
    if (strangers_.size() >= static_cast<std::size_t>(options_.maxStrangers)) strangers_.front()->close();
    error_code ignored;
    socket.set_option(Tcp::no_delay(true), ignored);
    std::make_shared<Connection>(*this, std::move(socket))->readHeader();
    accept();
  });
}

void HttpServer::State::send(ClientId client, std::shared_ptr<const std::string> bytes, bool binary) {
  asio::post(context_, [this, client, bytes = std::move(bytes), binary]() mutable {
    const auto socket = sockets_.find(client);
    // By value: the socket may take itself out of the map.
    if (socket != sockets_.end()) std::shared_ptr(socket->second)->send(std::move(bytes), binary);
  });
}

HttpServer::HttpServer(const ServerOptions& options, ServerEvents& events)
    : state_(std::make_unique<State>(options, events)) {}
HttpServer::~HttpServer() {
  stop();
}
int HttpServer::port() const {
  return state_->port();
}
const AccessRules& HttpServer::access() const {
  return state_->access();
}
void HttpServer::run() {
  state_->run();
}
void HttpServer::stop() {
  state_->stop();
}
void HttpServer::post(std::function<void()> f) {
  state_->post(std::move(f));
}
void HttpServer::sendText(ClientId client, std::string text) {
  state_->send(client, std::make_shared<const std::string>(std::move(text)), false);
}
void HttpServer::sendBinary(ClientId client, std::shared_ptr<const std::string> bytes) {
  state_->send(client, std::move(bytes), true);
}

}  // namespace weir::studio
