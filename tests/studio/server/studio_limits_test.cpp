// What one page, or who pretends to be one, may take of the server of the studio.
#include <gtest/gtest.h>

#include <sys/socket.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "studio/server/raw_client.hpp"
#include "studio/server/running_server.hpp"

namespace pointskin::test {
namespace {

using namespace std::chrono_literals;
using studio::server::ServerOptions;

/// Times that a test can wait for, each unlike the others.
ServerOptions impatient() {
  ServerOptions options;
  options.max_upload = 1 << 20;
  options.limits.header_time = 400ms;
  options.limits.block_time = 800ms;
  options.limits.idle_time = 1200ms;
  options.limits.silence_time = 1000ms;
  options.limits.closing_time = 500ms;
  return options;
}

std::string head(const RunningServer& server, const std::string& what) {
  return what + " HTTP/1.1\r\nHost: " + server.host() + "\r\n";
}

/// Others are served as before.
void expect_alive(RunningServer& server) {
  RawClient client(server.port());
  EXPECT_EQ(client.ask(head(server, "GET /") + "\r\n").status, 200);
}

TEST(StudioLimits, AHeaderHas8KiBAtMost) {
  RunningServer server;
  const std::string start = head(server, "GET /") + "X: ";
  const auto status = [&](std::size_t bytes) {
    RawClient client(server.port());
    return client.ask(start + std::string(bytes - start.size() - 4, 'x') + "\r\n\r\n").status;
  };
  EXPECT_EQ(status(8 * 1024 - 1), 200);
  EXPECT_EQ(status(8 * 1024 + 1), 431);
  EXPECT_EQ(status(100 * 1024), 431);
  RawClient line(server.port());
  EXPECT_EQ(line.ask("GET /" + std::string(9000, 'x')).status, 431) << "a line that does not end";
}

TEST(StudioLimits, ABodyThatIsTooLargeIsRefusedBeforeItComes) {
  RunningServer server(impatient());
  RawClient client(server.port());
  const auto start = std::chrono::steady_clock::now();
  const std::string length = "Content-Length: " + std::to_string((1 << 20) + 1) + "\r\n";
  EXPECT_EQ(client.ask(server.request("POST /upload?name=a.ply", length)).status, 413);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 400ms);
  EXPECT_TRUE(server.application.files().empty());
}

TEST(StudioLimits, ABodyThatTurnsOutTooLargeIsRefusedAndRemoved) {
  RunningServer server(impatient());
  RawClient client(server.port());
  client.send(server.request("POST /upload?name=a.ply", "Transfer-Encoding: chunked\r\n"));
  const std::string block = "40000\r\n" + std::string(0x40000, 'x') + "\r\n";
  for (int i = 0; i < 5; ++i) client.send(block);
  EXPECT_EQ(client.receive().status, 413);
  EXPECT_TRUE(server.application.files().empty());
  EXPECT_TRUE(server.application.uploads.empty());
}

TEST(StudioLimits, ABodyOfTheLargestSizeIsTaken) {
  RunningServer server(impatient());
  RawClient client(server.port());
  EXPECT_EQ(client.ask(server.request("POST /upload?name=a.ply", "", std::string(1 << 20, 'x'))).status, 200);
  RawClient chunked(server.port());
  chunked.send(server.request("POST /upload?name=b.ply", "Transfer-Encoding: chunked\r\n"));
  for (int i = 0; i < 4; ++i) chunked.send("40000\r\n" + std::string(0x40000, 'x') + "\r\n");
  EXPECT_EQ(chunked.ask("0\r\n\r\n").status, 200);
}

TEST(StudioLimits, ATokenHasNoMegabyte) {
  RunningServer server;
  RawClient client(server.port());
  const std::string body(1 << 20, 'x');
  client.send(head(server, "POST /session") + "Content-Length: 1048576\r\n\r\n" + body);
  EXPECT_EQ(client.receive().status, 413);
}

TEST(StudioLimits, AnUploadThatBreaksOffLeavesNothing) {
  RunningServer server;
  {
    RawClient client(server.port());
    client.send(server.request("POST /upload?name=a.ply", "Content-Length: 300000\r\n") + std::string(290000, 'x'));
    for (int i = 0; i < 500 && server.application.files().empty(); ++i) std::this_thread::sleep_for(10ms);
    EXPECT_EQ(server.application.files().size(), 1U);
  }
  for (int i = 0; i < 500 && !server.application.files().empty(); ++i) std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(server.application.files().empty());
  EXPECT_TRUE(server.application.uploads.empty());
}

TEST(StudioLimits, TheSeventeenthConnectionIsToldToComeLater) {
  RunningServer server;
  server.cookie();
  std::this_thread::sleep_for(100ms);  // that of the cookie is gone
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 16; ++i) {
    clients.push_back(std::make_unique<RawClient>(server.port()));
    ASSERT_EQ(clients.back()->ask(head(server, "GET /") + "\r\n").status, 200) << i;
  }
  RawClient one_more(server.port());
  const Reply refusal = one_more.receive();
  EXPECT_EQ(refusal.status, 503);
  EXPECT_EQ(refusal.header("connection"), "close");
  EXPECT_EQ(refusal.header("x-content-type-options"), "nosniff");
  EXPECT_TRUE(one_more.closed_after(3s).has_value());
  EXPECT_EQ(clients.front()->ask(head(server, "GET /") + "\r\n").status, 200) << "those before are not troubled";
  clients.pop_back();
  std::this_thread::sleep_for(200ms);
  expect_alive(server);
}

TEST(StudioLimits, AHeaderThatTricklesIsCutOff) {
  RunningServer server(impatient());
  RawClient client(server.port());
  const auto start = std::chrono::steady_clock::now();
  const std::string text = head(server, "GET /") + "X: " + std::string(1000, 'x');
  for (std::size_t i = 0; i < 60 && client.send(text.substr(i, 1)); ++i) {
    std::this_thread::sleep_for(50ms);
    if (client.closed_after(1ms)) break;
  }
  const auto taken = std::chrono::steady_clock::now() - start;
  EXPECT_GE(taken, 350ms);
  EXPECT_LT(taken, 1500ms) << "each byte seems to have given it more time";
  expect_alive(server);
}

TEST(StudioLimits, AConnectionThatSaysNothingIsClosed) {
  RunningServer server(impatient());
  RawClient client(server.port());
  const auto taken = client.closed_after(3s);
  ASSERT_TRUE(taken.has_value());
  EXPECT_GE(*taken, 350ms);
}

TEST(StudioLimits, ABodyThatTricklesIsCutOff) {
  RunningServer server(impatient());
  RawClient client(server.port());
  client.send(server.request("POST /upload?name=a.ply", "Content-Length: 1000\r\n"));
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 60 && client.send("x"); ++i)
    if (client.closed_after(50ms)) break;
  const auto taken = std::chrono::steady_clock::now() - start;
  EXPECT_GE(taken, 700ms);
  EXPECT_LT(taken, 2500ms);
  for (int i = 0; i < 500 && !server.application.files().empty(); ++i) std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(server.application.files().empty());
  expect_alive(server);
}

TEST(StudioLimits, BetweenTwoRequestsThereIsMoreTimeButNotForEver) {
  RunningServer server(impatient());
  RawClient client(server.port());
  EXPECT_EQ(client.ask(head(server, "GET /") + "\r\n").status, 200);
  std::this_thread::sleep_for(700ms);  // longer than a header may take
  EXPECT_EQ(client.ask(head(server, "GET /") + "\r\n").status, 200);
  const auto taken = client.closed_after(4s);
  ASSERT_TRUE(taken.has_value());
  EXPECT_GE(*taken, 1100ms);
}

TEST(StudioLimits, AReaderWhoDoesNotReadIsCutOff) {
  RunningServer server(impatient());
  server.application.blobs[1] = std::make_shared<studio::Bytes>();
  server.application.blobs[1]->data.resize(64 << 20);
  RawClient client(server.port());
  client.send(server.request("GET /blob/1"));
  std::this_thread::sleep_for(2s);
  EXPECT_NE(client.receive().body.size(), std::size_t{64} << 20) << "it waited all the time";
  expect_alive(server);
}

TEST(StudioLimits, AMessageHasOneMebibyteAtMost) {
  RunningServer server;
  const auto client = server.socket();
  client->send_frame(1, std::string(1 << 20, 'x'));
  const auto echo = client->receive_frame();
  ASSERT_TRUE(echo.has_value());
  EXPECT_EQ(echo->payload.size(), std::size_t{1} << 20);
  client->send_frame(1, std::string((1 << 20) + 1, 'x'));
  const auto answer = client->receive_frame();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->close_code(), 1009);
  EXPECT_EQ(server.application.messages().size(), 1U);
  EXPECT_TRUE(server.application.wait_for_pages(0));
}

TEST(StudioLimits, AMessageInPiecesIsNotLarger) {
  RunningServer server;
  const auto client = server.socket();
  for (int i = 0; i < 5; ++i) client->send_frame(i == 0 ? 1 : 0, std::string(256 * 1024, 'x'), true, false);
  const auto answer = client->receive_frame();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->close_code(), 1009);
  EXPECT_TRUE(server.application.messages().empty());
}

/// Frames that no page sends, and with which code the connection is closed.
struct Garbage {
  const char* name;
  std::string bytes;
  int code;
};

TEST(StudioLimits, GarbageEndsItsOwnConnectionAlone) {
  ServerOptions options;
  options.limits.closing_time = 300ms;
  RunningServer server(options);
  const auto neighbour = server.socket();
  const std::vector<Garbage> kinds = {{"unmasked", "\x81\x02hi", 1002},
                                      {"reserved bits", std::string("\xf1\x80\0\0\0\0", 6), 1002},
                                      {"reserved opcode", std::string("\x83\x80\0\0\0\0", 6), 1002},
                                      {"ping in pieces", std::string("\x09\x80\0\0\0\0", 6), 1002},
                                      {"continuation of nothing", std::string("\x80\x80\0\0\0\0", 6), 1002},
                                      {"no UTF-8", std::string("\x81\x82\0\0\0\0\xff\xff", 8), 1007},
                                      {"binary", std::string("\x82\x82\0\0\0\0hi", 8), 1003},
                                      {"HTTP", "GET / HTTP/1.1\r\n\r\n", 1002}};
  for (const auto& [name, bytes, code] : kinds) {
    const auto client = server.socket();
    client->send(bytes);
    const auto answer = client->receive_frame();
    ASSERT_TRUE(answer.has_value()) << name;
    EXPECT_EQ(answer->close_code(), code) << name;
    EXPECT_TRUE(client->closed_after(5s).has_value()) << name;
    EXPECT_TRUE(server.application.wait_for_pages(1)) << name;
  }
  EXPECT_TRUE(server.application.messages().empty());
  neighbour->send_frame(1, "still here");
  EXPECT_EQ(neighbour->receive_frame()->payload, "still here");
}

TEST(StudioLimits, ASocketIsAskedWhetherItLivesAndThenGivenUp) {
  RunningServer server(impatient());
  const auto client = server.socket();
  const auto frame = client->receive_frame();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->opcode, 9);
  client->send_frame(10, frame->payload);
  std::this_thread::sleep_for(700ms);
  EXPECT_EQ(server.application.open_pages(), 1U) << "it had answered";
  EXPECT_TRUE(server.application.wait_for_pages(0)) << "it did not answer any more";
}

TEST(StudioLimits, APageThatDoesNotReadItsMessagesIsDropped) {
  RunningServer server;
  const auto client = server.socket();
  ASSERT_TRUE(server.application.wait_for_pages(1));
  const auto page = server.application.pages().front();
  const auto reader = server.socket();
  ASSERT_TRUE(server.application.wait_for_pages(2));
  for (int i = 0; i < 64; ++i) page->send(std::string(1 << 20, 'x'));
  EXPECT_TRUE(server.application.wait_for_pages(1));
  page->send("to nobody");  // does no harm
  reader->send_frame(1, "still here");
  EXPECT_EQ(reader->receive_frame()->payload, "still here");
}

TEST(StudioLimits, ConnectionsThatBreakOffDoNoHarm) {
  RunningServer server;
  for (int i = 0; i < 40; ++i) {
    RawClient client(server.port());
    if (i % 4 == 1) client.send("GET / HT");
    if (i % 4 == 2) client.send(head(server, "GET /") + "\r\n");
    if (i % 4 == 3) client.send(server.request("GET /socket", RunningServer::upgrade()));
    client.reset();
  }
  EXPECT_TRUE(server.application.wait_for_pages(0));
  expect_alive(server);
}

}  // namespace
}  // namespace pointskin::test
