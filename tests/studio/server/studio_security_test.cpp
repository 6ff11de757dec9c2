// Who may do what at the server of the studio: every refusal by the status that says why.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "studio/server/raw_client.hpp"
#include "studio/server/running_server.hpp"
#include "studio/server/secrets.hpp"

namespace pointskin::test {
namespace {

using Lines = std::vector<std::string>;

/// All that can be asked for, as the start of a request.
const Lines kEverything = {"GET /",       "HEAD /",       "GET /assets/app.js",      "POST /session",
                           "GET /blob/1", "GET /nothing", "POST /upload?name=a.ply", "GET /download/1",
                           "GET /socket"};

class StudioSecurity : public testing::Test {
 protected:
  StudioSecurity() {
    server.application.blobs[1] = std::make_shared<studio::Bytes>();
    std::ofstream(server.application.folder / "kept.ply") << "ply";
    server.application.downloads[1] = {server.application.folder / "kept.ply", "kept.ply", false};
  }

  /// The status of an answer to a request of these lines, on a connection of its own.
  int status(const std::string& what, const std::string& lines) {
    RawClient client(server.port());
    client.send(what + " HTTP/1.1\r\n" + lines + "\r\n");
    return client.receive(!what.starts_with("HEAD")).status;
  }

  std::string host() { return "Host: " + server.host() + "\r\n"; }
  std::string cookie() { return "Cookie: " + server.cookie() + "\r\n"; }
  std::string own_origin() { return "Origin: http://" + server.host() + "\r\n"; }

  RunningServer server;
};

TEST_F(StudioSecurity, EveryRequestUnderAForeignNameIsMisdirected) {
  const std::string port = std::to_string(server.port());
  const Lines hosts = {"",
                       "Host: \r\n",
                       "Host: evil.example\r\n",
                       "Host: evil.example:" + port + "\r\n",
                       "Host: 127.0.0.1\r\n",
                       "Host: 127.0.0.1:1\r\n",
                       "Host: 127.0.0.1." + port + "\r\n",
                       "Host: 127.0.0.1.evil.example:" + port + "\r\n",
                       "Host: localhost.:" + port + "\r\n",
                       "Host: 127.0.0.2:" + port + "\r\n",
                       host() + host(),
                       host() + "Host: evil.example\r\n"};
  for (const std::string& wrong : hosts)
    for (const std::string& what : kEverything) EXPECT_EQ(status(what, wrong + cookie()), 421) << what << "\n" << wrong;
}

TEST_F(StudioSecurity, ItIsKnownUnderItsAddressesAndAsLocalhost) {
  const std::string port = std::to_string(server.port());
  for (const std::string name : {"127.0.0.1", "localhost", "LocalHost", "[::1]"})
    EXPECT_EQ(status("GET /", "Host: " + name + ":" + port + "\r\n"), 200) << name;
}

TEST_F(StudioSecurity, PagesOfOthersChangeNothing) {
  const std::string port = std::to_string(server.port());
  const Lines origins = {"http://evil.example",
                         "http://evil.example:" + port,
                         "null",
                         "",
                         "https://" + server.host(),
                         "http://127.0.0.1:1",
                         "http://127.0.0.1",
                         "file://",
                         server.host(),
                         "http://" + server.host() + ".evil.example"};
  for (const std::string& origin : origins) {
    const std::string lines = host() + cookie() + "Origin: " + origin + "\r\n";
    const std::string body = "Content-Length: 32\r\n\r\n" + server.token();
    EXPECT_EQ(status("POST /session", lines + body), 403) << origin;
    EXPECT_EQ(status("POST /upload?name=a.ply", lines + body), 403) << origin;
    EXPECT_EQ(status("DELETE /blob/1", lines), 403) << origin;
    EXPECT_EQ(status("GET /socket", lines + RunningServer::upgrade()), 403) << origin;
    EXPECT_EQ(status("GET /socket", lines + own_origin() + RunningServer::upgrade()), 403) << origin;
  }
  EXPECT_TRUE(server.application.uploads.empty());
}

TEST_F(StudioSecurity, ItsOwnPageMay) {
  const std::string lines = host() + cookie() + own_origin();
  EXPECT_EQ(status("POST /session", lines + "Content-Length: 32\r\n\r\n" + server.token()), 204);
  EXPECT_EQ(status("POST /upload?name=a.ply", lines + "Content-Length: 3\r\n\r\nply"), 200);
  EXPECT_EQ(status("GET /socket", lines + RunningServer::upgrade()), 101);
}

TEST_F(StudioSecurity, PagesOfOthersReadNothingEither) {
  for (const std::string site : {"cross-site", "same-site", "nonsense"}) {
    const std::string lines = host() + cookie() + "Sec-Fetch-Site: " + site + "\r\n";
    EXPECT_EQ(status("GET /blob/1", lines), 403) << site;
    EXPECT_EQ(status("GET /download/1", lines), 403) << site;
    EXPECT_EQ(status("GET /", lines), 200) << "a link to the page, from anywhere";
  }
  for (const std::string site : {"same-origin", "none"})
    EXPECT_EQ(status("GET /blob/1", host() + cookie() + "Sec-Fetch-Site: " + site + "\r\n"), 200) << site;
}

TEST_F(StudioSecurity, WithoutTheCookieThereIsThePageAlone) {
  const std::string port = std::to_string(server.port());
  std::string other = server.cookie();
  other.back() = other.back() == '0' ? '1' : '0';
  const Lines cookies = {"",
                         "Cookie: a=b\r\n",
                         "Cookie: pointskin_" + port + "=\r\n",
                         "Cookie: pointskin_" + port + "=" + server.token() + "\r\n",
                         "Cookie: pointskin_1" + server.cookie().substr(server.cookie().find('=')) + "\r\n",
                         "Cookie: " + server.cookie() + "0\r\n",
                         "Cookie: " + server.cookie().substr(0, server.cookie().size() - 1) + "\r\n",
                         "Cookie: " + other + "\r\n"};
  for (const std::string& lines : cookies) {
    for (const std::string what : {"GET /blob/1", "GET /blob/99", "GET /download/1", "GET /nothing", "OPTIONS /nothing",
                                   "GET /socket", "POST /upload?name=a.ply", "GET /blob/x?coding=no"})
      EXPECT_EQ(status(what, host() + lines), 401) << what << "\n" << lines;
    EXPECT_EQ(status("GET /socket", host() + lines + RunningServer::upgrade()), 401) << lines;
    EXPECT_EQ(status("GET /", host() + lines), 200);
    EXPECT_EQ(status("GET /assets/app.js", host() + lines), 200);
  }
  EXPECT_EQ(status("GET /blob/1", host() + "Cookie: a=b; " + server.cookie() + "; c=d\r\n"), 200);
}

/// What POST /session answers to `token`.
Reply give(const RunningServer& server, const std::string& token) {
  RawClient client(server.port());
  return client.ask("POST /session HTTP/1.1\r\nHost: " + server.host() +
                    "\r\nContent-Length: " + std::to_string(token.size()) + "\r\n\r\n" + token);
}

TEST_F(StudioSecurity, OnlyTheTokenGivesTheCookie) {
  const std::string token = server.token();
  std::string other = token;
  other[0] = other[0] == '0' ? '1' : '0';
  for (const std::string& wrong : Lines{"", other, token.substr(1), token + "0", token + "\n", token + token,
                                        std::string(32, '\0'), "\"" + token + "\""}) {
    const Reply reply = give(server, wrong);
    EXPECT_EQ(reply.status, 401) << wrong;
    EXPECT_EQ(reply.header("set-cookie"), "");
  }
  const Reply reply = give(server, token);
  EXPECT_EQ(reply.status, 204);
  const std::string cookie = reply.header("set-cookie");
  EXPECT_TRUE(cookie.starts_with("pointskin_" + std::to_string(server.port()) + "=")) << cookie;
  EXPECT_TRUE(cookie.ends_with("; HttpOnly; SameSite=Strict; Path=/")) << cookie;
  EXPECT_EQ(cookie.find(token), std::string::npos) << "the cookie tells the token";
  EXPECT_EQ(give(server, token).status, 204) << "another tab of the same person";
}

TEST_F(StudioSecurity, TheSecretInTheBrowsersCommandLineIsGoodForOnce) {
  const std::string url = server.url_for_browser();
  const std::string once = url.substr(url.find('#') + 1);
  EXPECT_NE(once, server.token());
  EXPECT_EQ(give(server, once).status, 204);
  EXPECT_EQ(give(server, once).status, 401);
  EXPECT_EQ(give(server, server.token()).status, 204);
}

TEST_F(StudioSecurity, TokensAreLongAndNeverTheSame) {
  const RunningServer other;
  EXPECT_EQ(server.token().size(), 32U);
  EXPECT_EQ(server.token().find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(server.token(), other.token());
}

TEST_F(StudioSecurity, SecretsAreComparedWhole) {
  using studio::server::same_secret;
  EXPECT_TRUE(same_secret("abcd", "abcd"));
  for (const std::string wrong : {"", "a", "abc", "abcde", "abcx", "xbcd", "abcdabcd"})
    EXPECT_FALSE(same_secret(wrong, "abcd")) << wrong;
  EXPECT_FALSE(same_secret("", ""));
}

/// Every kind of answer that there is, by how it is asked for.
std::vector<std::pair<int, std::string>> every_answer(RunningServer& server) {
  const std::string host = "Host: " + server.host() + "\r\n";
  return {{200, "GET / HTTP/1.1\r\n" + host + "\r\n"},
          {200, "GET /assets/app.js HTTP/1.1\r\n" + host + "\r\n"},
          {304, "GET / HTTP/1.1\r\n" + host + "If-None-Match: \"page\"\r\n\r\n"},
          {204, "POST /session HTTP/1.1\r\n" + host + "Content-Length: 32\r\n\r\n" + server.token()},
          {401, "POST /session HTTP/1.1\r\n" + host + "Content-Length: 1\r\n\r\nx"},
          {200, server.request("GET /blob/1")},
          {200, server.request("GET /download/1")},
          {200, server.request("POST /upload?name=a.ply", "", "ply")},
          {101, server.request("GET /socket", RunningServer::upgrade())},
          {400, "nonsense\r\n\r\n"},
          {400, server.request("GET /blob/1?coding=no")},
          {401, "GET /blob/1 HTTP/1.1\r\n" + host + "\r\n"},
          {403, server.request("POST /session", "Origin: null\r\n")},
          {404, server.request("GET /blob/99")},
          {405, server.request("OPTIONS /blob/1")},
          {413, server.request("POST /upload?name=a.ply", "Content-Length: 99999999999999\r\n")},
          {421, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"},
          {426, server.request("GET /socket")},
          {431, "GET / HTTP/1.1\r\nX: " + std::string(9000, 'x') + "\r\n\r\n"}};
}

TEST_F(StudioSecurity, EveryAnswerTellsBrowsersToBeStrict) {
  for (const auto& [status, request] : every_answer(server)) {
    RawClient client(server.port());
    const Reply reply = client.ask(request);
    EXPECT_EQ(reply.status, status) << request;
    const std::string policy = reply.header("content-security-policy");
    EXPECT_TRUE(policy.starts_with("default-src 'self';")) << status << policy;
    EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos) << status;
    EXPECT_EQ(policy.find("unsafe-inline"), std::string::npos);
    EXPECT_EQ(policy.find("'unsafe-eval'"), std::string::npos);
    EXPECT_EQ(reply.header("x-content-type-options"), "nosniff") << status;
    EXPECT_EQ(reply.header("referrer-policy"), "no-referrer") << status;
    for (const std::string name : {"opener-policy", "resource-policy"})
      EXPECT_EQ(reply.header("cross-origin-" + name), "same-origin") << status;
    EXPECT_EQ(reply.header("cross-origin-embedder-policy"), "require-corp") << status;
    EXPECT_FALSE(reply.header("cache-control").empty()) << status;
    for (const auto& [name, value] : reply.headers) EXPECT_FALSE(name.starts_with("access-control")) << name;
  }
}

/// Addresses, in hexadecimal as the kernel lists them, at which `port` is listened on.
Lines listening_at(int port) {
  Lines addresses;
  for (const std::string table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream file(table);
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string number, local, remote, state;
      words >> number >> local >> remote >> state;
      const std::size_t colon = local.find(':');
      if (state == "0A" && std::stoi(local.substr(colon + 1), nullptr, 16) == port)
        addresses.push_back(local.substr(0, colon));
    }
  }
  return addresses;
}

TEST_F(StudioSecurity, NothingListensButOnThisMachine) {
  const Lines addresses = listening_at(server.port());
  ASSERT_FALSE(addresses.empty());
  for (const std::string& address : addresses)
    EXPECT_TRUE(address == "0100007F" || address == "00000000000000000000000001000000") << address;
}

}  // namespace
}  // namespace pointskin::test
