// What the server of the studio answers to those who may ask.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <pointskin/error.hpp>

#include "studio/server/raw_client.hpp"
#include "studio/server/running_server.hpp"

namespace pointskin::test {
namespace {

using namespace std::chrono_literals;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::shared_ptr<studio::Bytes> blob_of(std::size_t size) {
  auto blob = std::make_shared<studio::Bytes>();
  blob->data.resize(size);
  for (std::size_t i = 0; i < size; ++i) blob->data[i] = static_cast<std::byte>(i * 2654435761U >> 24);
  return blob;
}

std::string text_of(const studio::Bytes& blob) {
  return {reinterpret_cast<const char*>(blob.data.data()), blob.data.size()};
}

TEST(StudioServer, ServesThePageAndItsFiles) {
  RunningServer server;
  RawClient client(server.port());
  const Reply page = client.ask(server.request("GET /"));
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<!doctype html><title>Pointskin</title>");
  EXPECT_EQ(page.header("content-type"), "text/html; charset=utf-8");
  EXPECT_EQ(page.header("cache-control"), "no-cache");
  const Reply known = client.ask(server.request("GET /", "If-None-Match: \"page\"\r\n"));
  EXPECT_EQ(known.status, 304);
  EXPECT_EQ(known.body, "");
  client.send(server.request("HEAD /assets/app.js"));
  const Reply head = client.receive(false);
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.header("content-length"), "10");
  EXPECT_EQ(client.ask(server.request("GET /assets/app.js")).body, "export {};");
  EXPECT_EQ(client.ask(server.request("GET /assets/other.js")).status, 404);
  EXPECT_EQ(client.ask(server.request("GET /assets/../index.html")).status, 404);
}

TEST(StudioServer, AnswersRequestsThatComeAtOnceInTheirOrder) {
  RunningServer server;
  for (std::uint64_t i = 1; i <= 5; ++i) server.application.blobs[i] = blob_of(i);
  RawClient client(server.port());
  std::string all;
  for (int i = 1; i <= 5; ++i) all += server.request("GET /blob/" + std::to_string(i));
  client.send(all);
  for (std::size_t i = 1; i <= 5; ++i) EXPECT_EQ(client.receive().body.size(), i);
}

TEST(StudioServer, ABlobHasTheBytesOfTheApplication) {
  RunningServer server;
  server.application.blobs[7] = blob_of((36 << 20) + 5);
  server.application.blobs[1007] = blob_of(3);
  RawClient client(server.port());
  const Reply raw = client.ask(server.request("GET /blob/7"));
  EXPECT_EQ(raw.header("content-type"), "application/octet-stream");
  EXPECT_EQ(raw.header("cache-control"), "no-store");
  EXPECT_TRUE(raw.body == text_of(*server.application.blobs[7]));
  EXPECT_TRUE(client.ask(server.request("GET /blob/7?coding=raw")).body == raw.body);
  EXPECT_EQ(client.ask(server.request("GET /blob/7?coding=compressed")).body.size(), 3U);
  EXPECT_EQ(client.ask(server.request("GET /blob/7?coding=other")).status, 400);
  for (const std::string wrong : {"8", "", "-7", "7x", "99999999999999999999999", "7/", "%37"})
    EXPECT_EQ(client.ask(server.request("GET /blob/" + wrong)).status, 404) << wrong;
}

TEST(StudioServer, AnUploadBecomesAFileOfTheApplication) {
  RunningServer server;
  const std::string bytes = text_of(*blob_of(3 << 20));
  RawClient client(server.port());
  const Reply reply = client.ask(server.request("POST /upload?name=..%2Fa%20scan.ply", "", bytes));
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("content-type"), "application/json");
  EXPECT_EQ(reply.body, R"({"upload":1,"bytes":3145728})");
  const std::filesystem::path file = server.application.uploads.at("a scan.ply");
  EXPECT_EQ(file.parent_path(), server.application.folder);
  EXPECT_EQ(file.extension(), ".ply");
  EXPECT_TRUE(text_of(file) == bytes);
  struct stat about = {};
  ASSERT_EQ(stat(file.c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777, 0600U) << "others must not read it";
}

TEST(StudioServer, NamesOfUploadsAreNoPaths) {
  RunningServer server;
  for (const std::string wrong : {"", "?name=", "?name=..", "?name=%2e%2e", "?name=a%00.ply", "?name=a%", "?name=a%zz",
                                  "?name=..%2f", "?other=a"}) {
    RawClient client(server.port());
    EXPECT_EQ(client.ask(server.request("POST /upload" + wrong, "", "ply")).status, 400) << wrong;
  }
  EXPECT_TRUE(server.application.uploads.empty());
  EXPECT_TRUE(server.application.files().empty());
}

TEST(StudioServer, WhoAsksBeforeSendingIsTold) {
  RunningServer server;
  RawClient client(server.port());
  client.send(server.request("POST /upload?name=a.ply", "Expect: 100-continue\r\nContent-Length: 3\r\n"));
  EXPECT_EQ(client.receive().status, 100);
  EXPECT_EQ(client.ask("ply").status, 200);
}

TEST(StudioServer, ADownloadIsAnAttachment) {
  RunningServer server;
  const std::filesystem::path file = server.application.folder / "mesh.ply";
  std::ofstream(file) << "ply";
  server.application.downloads[1] = {file, "a \"mesh\"\r\nSet-Cookie: a=b/\xc3\xa4.ply", false};
  RawClient client(server.port());
  const Reply reply = client.ask(server.request("GET /download/1"));
  EXPECT_EQ(reply.body, "ply");
  EXPECT_EQ(reply.header("content-type"), "application/octet-stream");
  EXPECT_EQ(reply.header("content-disposition"), "attachment; filename=\"__.ply\"; filename*=UTF-8''%C3%A4.ply");
  EXPECT_EQ(reply.header("set-cookie"), "");
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_EQ(client.ask(server.request("GET /download/2")).status, 404);
}

TEST(StudioServer, ATemporaryDownloadIsRemoved) {
  RunningServer server;
  const std::filesystem::path file = server.application.folder / "mesh.ply";
  std::ofstream(file) << text_of(*blob_of(3 << 20));
  server.application.downloads[1] = {file, "mesh.ply", true};
  RawClient client(server.port());
  EXPECT_EQ(client.ask(server.request("GET /download/1")).body.size(), std::size_t{3} << 20);
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(client.ask(server.request("GET /download/1")).status, 404);
}

TEST(StudioServer, ADownloadFollowsNoLinkAndWaitsForNoPipe) {
  RunningServer server;
  const std::filesystem::path folder = server.application.folder;
  std::filesystem::create_symlink("/etc/passwd", folder / "link");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  server.application.downloads[1] = {folder / "link", "a", false};
  server.application.downloads[2] = {folder / "pipe", "a", false};
  server.application.downloads[3] = {folder, "a", false};
  RawClient client(server.port());
  for (const std::string id : {"1", "2", "3"})
    EXPECT_EQ(client.ask(server.request("GET /download/" + id)).status, 404) << id;
}

TEST(StudioServer, MessagesGoBothWaysInTheirOrder) {
  RunningServer server;
  const auto client = server.socket();
  ASSERT_TRUE(server.application.wait_for_pages(1));
  EXPECT_TRUE(server.application.pages().front()->loopback());
  for (int i = 0; i < 1000; ++i) client->send_frame(1, "{\"id\": " + std::to_string(i) + "}");
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(client->receive_frame()->payload, "{\"id\": " + std::to_string(i) + "}");
}

TEST(StudioServer, ManyThreadsMaySendToOnePage) {
  RunningServer server;
  const auto client = server.socket();
  ASSERT_TRUE(server.application.wait_for_pages(1));
  const auto page = server.application.pages().front();
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&page] {
      for (int i = 0; i < 250; ++i) page->send("{}");
    });
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(client->receive_frame()->payload, "{}");
}

TEST(StudioServer, ClosesInOrder) {
  RunningServer server;
  const auto page = server.socket();
  RawClient idle(server.port());
  EXPECT_EQ(idle.ask(server.request("GET /")).status, 200);
  const int port = server.port();
  const auto start = std::chrono::steady_clock::now();
  server.stop();
  const auto farewell = page->receive_frame();
  ASSERT_TRUE(farewell.has_value());
  EXPECT_EQ(farewell->close_code(), 1001);
  page->send_frame(8, farewell->payload);
  EXPECT_TRUE(page->closed_after(2s).has_value());
  page->reset();
  EXPECT_TRUE(idle.closed_after(2s).has_value());
  server.wait();
  EXPECT_LT(std::chrono::steady_clock::now() - start, 1s) << "nobody was late";
  EXPECT_EQ(server.application.open_pages(), 0U);
  EXPECT_THROW(RawClient(port).send("x"), std::runtime_error);
}

TEST(StudioServer, ClosesAlthoughAPageDoesNotAnswer) {
  studio::server::ServerOptions options;
  options.limits.closing_time = 1s;
  RunningServer server(options);
  const auto page = server.socket();
  ASSERT_TRUE(server.application.wait_for_pages(1));
  const auto held = server.application.pages().front();
  const auto start = std::chrono::steady_clock::now();
  server.stop();
  server.wait();
  EXPECT_LT(std::chrono::steady_clock::now() - start, 1800ms) << "it waited twice";
  EXPECT_EQ(server.application.open_pages(), 0U);
  held->send("to nobody");
}

TEST(StudioServer, CutsWhatIsHalfDoneWhenItCloses) {
  RunningServer server;
  RawClient half(server.port()), uploading(server.port());
  half.send("GET / HTTP/1.1\r\n");
  uploading.send(server.request("POST /upload?name=a.ply", "Content-Length: 300000\r\n") + std::string(280000, 'x'));
  for (int i = 0; i < 500 && server.application.files().empty(); ++i) std::this_thread::sleep_for(10ms);
  const auto start = std::chrono::steady_clock::now();
  server.stop();
  server.wait();
  EXPECT_LT(std::chrono::steady_clock::now() - start, 1500ms) << "it waited for them, until it had waited enough";
  EXPECT_TRUE(server.application.files().empty());
}

TEST(StudioServer, ClosesWhilePagesAreConnecting) {
  for (int i = 0; i < 30; ++i) {
    RunningServer server;
    const std::string request = server.request("GET /socket", RunningServer::upgrade());
    std::vector<std::unique_ptr<RawClient>> pages;
    for (int k = 0; k < 8; ++k) {
      pages.push_back(std::make_unique<RawClient>(server.port()));
      pages.back()->send(request);
    }
    if (i % 2 == 1) pages.back()->receive();
    pages.clear();
    server.stop();
    server.wait();
    EXPECT_EQ(server.application.open_pages(), 0U);
  }
}

TEST(StudioServer, ListensAtTheSamePortOfBothAddresses) {
  const RunningServer server;
  EXPECT_EQ(server.url(), "http://" + server.host() + "/#" + server.token());
  try {
    RawClient client(server.port(), "::1");
    const std::string host = "[::1]:" + std::to_string(server.port());
    EXPECT_EQ(client.ask("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n").status, 200);
  } catch (const std::runtime_error&) {
    GTEST_SKIP() << "this machine has no ::1";
  }
}

TEST(StudioServer, APortThatIsTakenIsAnError) {
  const RunningServer server;
  EchoApplication application;
  try {
    studio::server::Server another({.port = server.port()}, application);
    FAIL() << "two servers listen at one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::output_not_written);
    EXPECT_NE(std::string(error.what()).find("port " + std::to_string(server.port())), std::string::npos);
  }
}

TEST(StudioServer, AHostOfAnotherMachineIsAnError) {
  EchoApplication application;
  for (const std::string host : {"192.0.2.1", "no such host"}) {
    try {
      studio::server::Server server({.hosts = {"127.0.0.1", host}}, application);
      ADD_FAILURE() << host;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage) << host;
    }
  }
}

}  // namespace
}  // namespace pointskin::test
