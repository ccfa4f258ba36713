#include "apps/studio/server/access.h"

#include <array>
#include <random>
#include <utility>

namespace weir::studio {

namespace {

/// The value of one cookie in a Cookie header.
std::string_view cookieValue(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find(';'), header.size());
    std::string_view pair = header.substr(0, end);
    header.remove_prefix(std::min(end + 1, header.size()));
    while (pair.starts_with(' ')) pair.remove_prefix(1);
    if (pair.starts_with(name) && pair.substr(name.size()).starts_with('='))
      return pair.substr(name.size() + 1);
  }
  return {};
}

}  // namespace

AccessRules::AccessRules(std::string host, int port, std::string token)
    : host_(std::move(host)), port_(std::to_string(port)), token_(std::move(token)) {}

bool AccessRules::isOurs(std::string_view hostAndPort) const {
  for (const std::string_view name : {std::string_view(host_), std::string_view("localhost")}) {
    const std::string whole = std::string(name) + ":" + port_;
    if (hostAndPort == whole || (port_ == "80" && hostAndPort == name)) return true;
  }
  return false;
}

bool AccessRules::isToken(std::string_view text) const {
  // As long for a nearly right one as for any other.
  unsigned different = text.size() == token_.size() ? 0 : 1;
  for (std::size_t i = 0; i < token_.size(); ++i)
    different |= static_cast<unsigned>(i < text.size() ? text[i] ^ token_[i] : 1);
  return different == 0;
}

Access AccessRules::check(const RequestOrigin& request) const {
  constexpr std::string_view kScheme = "http://", kBearer = "Bearer ";
  if (!isOurs(request.host)) return Access::kForeignHost;
  if (!request.origin.empty() &&
      (!request.origin.starts_with(kScheme) || !isOurs(request.origin.substr(kScheme.size()))))
    return Access::kForeignOrigin;
  const bool bearer =
      request.authorization.starts_with(kBearer) && isToken(request.authorization.substr(kBearer.size()));
  if (bearer || isToken(request.token) || isToken(cookieValue(request.cookie, kCookie)))
    return Access::kGranted;
  return Access::kNoToken;
}

std::string AccessRules::address() const {
  return "http://" + host_ + ":" + port_ + "/?token=" + token_;
}

std::string AccessRules::cookie() const {
  return std::string(kCookie) + "=" + token_ + "; Path=/; HttpOnly; SameSite=Strict";
}

std::string randomToken() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  constexpr int kLength = 32;
  std::random_device random;
  std::string token;
  for (int i = 0; i < kLength; ++i) token += kDigits[random() % kDigits.size()];
  return token;
}

}  // namespace weir::studio
