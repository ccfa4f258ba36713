// Who may talk to the studio: those who know its token, from a page that it served.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace weir::studio {

/// The parts of a request that say where it comes from; empty where a header is missing.
struct RequestOrigin {
  std::string_view host;           ///< header Host
  std::string_view origin;         ///< header Origin
  std::string_view cookie;         ///< header Cookie
  std::string_view authorization;  ///< header Authorization
  std::string_view token;          ///< of the address, "?token=…"
  std::string_view local;          ///< the address of this machine that the client has reached
};

enum class Access {
  kGranted,
  kForeignHost,    ///< the name in the address is not ours: another site's name may point to this machine
  kForeignOrigin,  ///< a page of another site asks
  kNoToken,        ///< no token, or a wrong one
};

class AccessRules {
 public:
  static constexpr std::string_view kCookie = "weir_studio_token";

  /// `host` is the address that the server listens at, `port` its port, `token` what clients must know. A
  /// server that listens at all addresses of the machine ("0.0.0.0", "::") is known by each of them, and by
  /// the machine's name.
  AccessRules(std::string host, int port, std::string token);

  Access check(const RequestOrigin& request) const;
  const std::string& token() const { return token_; }
  /// "http://127.0.0.1:8000/?token=…"
  std::string address() const { return addressAt(isOpen() ? "127.0.0.1" : host_); }
  /// The same at the other addresses of this machine, if the server listens at all of them.
  std::vector<std::string> furtherAddresses() const;
  /// What a browser keeps, so that the token needs to stand in the first address only.
  std::string cookie() const;

 private:
  bool isOpen() const { return host_ == "0.0.0.0" || host_ == "::"; }
  std::string addressAt(const std::string& host) const;
  bool isOurs(std::string_view hostAndPort, std::string_view local) const;
  bool isToken(std::string_view text) const;

  std::string host_;
  std::string port_;
  std::string token_;
};

/// 32 hexadecimal digits from the system's source of random numbers.
std::string randomToken();

}  // namespace weir::studio
