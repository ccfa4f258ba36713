#include "apps/studio/server/access.h"

#include <gtest/gtest.h>

namespace weir::studio {
namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";

class AccessTest : public testing::Test {
 protected:
  Access check(RequestOrigin request) const { return rules.check(request); }
  RequestOrigin own() const { return {.host = "127.0.0.1:8000", .authorization = bearer}; }

  const AccessRules rules{"127.0.0.1", 8000, kToken};
  const std::string bearer = "Bearer " + kToken;
};

TEST_F(AccessTest, IsGrantedToThoseWhoKnowTheToken) {
  EXPECT_EQ(check(own()), Access::kGranted);
  EXPECT_EQ(check({.host = "localhost:8000", .token = kToken}), Access::kGranted);
  const std::string cookies = "a=b; " + std::string(AccessRules::kCookie) + "=" + kToken + "; c=d";
  EXPECT_EQ(check({.host = "127.0.0.1:8000", .cookie = cookies}), Access::kGranted);
  RequestOrigin page = own();
  page.origin = "http://127.0.0.1:8000";
  EXPECT_EQ(check(page), Access::kGranted);
}

TEST_F(AccessTest, IsRefusedWithoutTheWholeToken) {
  EXPECT_EQ(check({.host = "127.0.0.1:8000"}), Access::kNoToken);
  for (std::size_t length = 0; length < kToken.size(); ++length)
    EXPECT_EQ(check({.host = "127.0.0.1:8000", .token = std::string_view(kToken).substr(0, length)}),
              Access::kNoToken);
  const std::string longer = kToken + "0", other = "X" + kToken.substr(1);
  EXPECT_EQ(check({.host = "127.0.0.1:8000", .token = longer}), Access::kNoToken);
  EXPECT_EQ(check({.host = "127.0.0.1:8000", .token = other}), Access::kNoToken);
  const std::string cookie = "not_" + std::string(AccessRules::kCookie) + "=" + kToken;
  EXPECT_EQ(check({.host = "127.0.0.1:8000", .cookie = cookie}), Access::kNoToken);
}

TEST_F(AccessTest, IsRefusedToOtherSites) {
  for (const char* origin :
       {"http://evil.example", "https://127.0.0.1:8000", "http://127.0.0.1:8001", "null"}) {
    RequestOrigin request = own();
    request.origin = origin;
    EXPECT_EQ(check(request), Access::kForeignOrigin) << origin;
  }
  for (const char* host : {"evil.example:8000", "127.0.0.1", "127.0.0.1:80", ""}) {
    RequestOrigin request = own();
    request.host = host;
    EXPECT_EQ(check(request), Access::kForeignHost) << host;
  }
}

TEST_F(AccessTest, AServerAtAllAddressesIsKnownByEachOfThemAndByNoOtherName) {
  for (const char* any : {"0.0.0.0", "::"}) {
    const AccessRules open(any, 8000, kToken);
    RequestOrigin request = own();
    request.local = "192.0.2.7";
    for (const char* host : {"192.0.2.7:8000", "localhost:8000"}) {
      request.host = host;
      EXPECT_EQ(open.check(request), Access::kGranted) << host;
    }
    for (const char* host : {"evil.example:8000", "192.0.2.8:8000", "192.0.2.7", "192.0.2.7:80"}) {
      request.host = host;
      EXPECT_EQ(open.check(request), Access::kForeignHost) << host;
    }
    EXPECT_EQ(open.address(), "http://127.0.0.1:8000/?token=" + kToken);
    for (const std::string& address : open.furtherAddresses())
      EXPECT_TRUE(address.ends_with(":8000/?token=" + kToken)) << address;
  }
  RequestOrigin request = own();
  request.host = request.local = "192.0.2.7:8000";
  EXPECT_EQ(rules.check(request), Access::kForeignHost);
  EXPECT_EQ(AccessRules("::1", 8000, kToken).address(), "http://[::1]:8000/?token=" + kToken);
  EXPECT_TRUE(rules.furtherAddresses().empty());
}

TEST_F(AccessTest, TokensAreLongAndNeverTheSame) {
  EXPECT_EQ(randomToken().size(), 32u);
  EXPECT_NE(randomToken(), randomToken());
}

}  // namespace
}  // namespace weir::studio
