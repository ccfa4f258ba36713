#include "apps/studio/server/access.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
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

/// As it stands in an address: "[::1]" for the IPv6 address ::1.
std::string inAddress(std::string_view host) {
  const bool isV6 = host.find(':') != std::string_view::npos;
  return isV6 ? "[" + std::string(host) + "]" : std::string(host);
}

std::string machineName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : std::string();
}

/// The IPv4 addresses by which others reach this machine.
std::vector<std::string> machineAddresses() {
  std::vector<std::string> found;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return found;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(all, &freeifaddrs);
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    const bool usable = one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET &&
                        (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_LOOPBACK) == 0;
    std::array<char, INET_ADDRSTRLEN> text{};
    if (usable && inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr,
                            text.data(), text.size()) != nullptr)
      found.emplace_back(text.data());
  }
  return found;
}

}  // namespace

AccessRules::AccessRules(std::string host, int port, std::string token)
    : host_(std::move(host)), port_(std::to_string(port)), token_(std::move(token)) {}

bool AccessRules::isOurs(std::string_view hostAndPort, std::string_view local) const {
  std::vector<std::string> names{inAddress(host_), "localhost"};
  if (isOpen()) {
    names.push_back(inAddress(local));
    names.push_back(machineName());
  }
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return !name.empty() && (hostAndPort == name + ":" + port_ || (port_ == "80" && hostAndPort == name));
  });
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
  if (!isOurs(request.host, request.local)) return Access::kForeignHost;
  if (!request.origin.empty() &&
      (!request.origin.starts_with(kScheme) || !isOurs(request.origin.substr(kScheme.size()), request.local)))
    return Access::kForeignOrigin;
  const bool bearer =
      request.authorization.starts_with(kBearer) && isToken(request.authorization.substr(kBearer.size()));
  if (bearer || isToken(request.token) || isToken(cookieValue(request.cookie, kCookie)))
    return Access::kGranted;
  return Access::kNoToken;
}

std::string AccessRules::addressAt(const std::string& host) const {
  return "http://" + inAddress(host) + ":" + port_ + "/?token=" + token_;
}

std::vector<std::string> AccessRules::furtherAddresses() const {
  std::vector<std::string> addresses;
  if (!isOpen()) return addresses;
  for (const std::string& host : machineAddresses()) addresses.push_back(addressAt(host));
  return addresses;
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
