#include "studio/server/raw_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <stdexcept>

namespace pointskin::test {
namespace {

constexpr std::chrono::milliseconds kPatience{10'000};

template <class Address>
void connect_to(int socket, const Address& address) {
  if (connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("nobody listens");
}

int connected(int port, const std::string& address) {
  const bool v6 = address.find(':') != std::string::npos;
  const int socket = ::socket(v6 ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (v6) {
    sockaddr_in6 place = {};
    place.sin6_family = AF_INET6;
    place.sin6_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET6, address.c_str(), &place.sin6_addr);
    connect_to(socket, place);
  } else {
    sockaddr_in place = {};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, address.c_str(), &place.sin_addr);
    connect_to(socket, place);
  }
  return socket;
}

void add_header(Reply& reply, const std::string& line) {
  const std::size_t colon = line.find(':');
  std::string name = line.substr(0, colon);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  reply.headers[name] = line.substr(line.find_first_not_of(' ', colon + 1));
}

}  // namespace

std::string Reply::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

int Frame::close_code() const {
  if (opcode != 8 || payload.size() < 2) return 0;
  return static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
}

RawClient::RawClient(int port, const std::string& address) : socket_(connected(port, address)) {}

RawClient::~RawClient() {
  if (socket_ >= 0) close(socket_);
}

void RawClient::reset() {
  const linger at_once{1, 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(socket_);
  socket_ = -1;
}

bool RawClient::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool RawClient::fill(std::chrono::milliseconds limit) {
  pollfd wanted{socket_, POLLIN, 0};
  if (poll(&wanted, 1, static_cast<int>(limit.count())) <= 0) throw std::runtime_error("the server keeps silent");
  std::array<char, 65536> block{};
  const ssize_t count = recv(socket_, block.data(), block.size(), 0);
  if (count > 0) buffer_.append(block.data(), static_cast<std::size_t>(count));
  return count > 0;
}

std::optional<std::string> RawClient::take(std::size_t count) {
  while (buffer_.size() < count)
    if (!fill(kPatience)) return std::nullopt;
  std::string taken = buffer_.substr(0, count);
  buffer_.erase(0, count);
  return taken;
}

Reply RawClient::receive(bool has_body) {
  Reply reply;
  std::size_t end = 0;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos)
    if (!fill(kPatience)) return reply;
  std::string head = *take(end + 4);
  reply.status = std::stoi(head.substr(9, 3));
  for (std::size_t line = head.find("\r\n") + 2; line < end;) {
    const std::size_t stop = head.find("\r\n", line);
    add_header(reply, head.substr(line, stop - line));
    line = stop + 2;
  }
  const std::string length = reply.header("content-length");
  if (has_body && !length.empty()) reply.body = take(std::stoul(length)).value_or("(cut)");
  return reply;
}

void RawClient::send_frame(int opcode, std::string_view payload, bool masked, bool final) {
  std::string frame(1, static_cast<char>((final ? 0x80 : 0) | opcode));
  const std::uint64_t size = payload.size();
  const int mask_bit = masked ? 0x80 : 0;
  const int bytes = size < 126 ? 0 : size < 65536 ? 2 : 8;
  frame += static_cast<char>(mask_bit | (bytes == 0 ? static_cast<int>(size) : bytes == 2 ? 126 : 127));
  for (int i = bytes - 1; i >= 0; --i) frame += static_cast<char>(size >> (8 * i));
  if (masked) frame.append(4, '\0');  // the mask: it leaves the bytes as they are
  send(frame.append(payload));
}

std::optional<Frame> RawClient::receive_frame() {
  const auto head = take(2);
  if (!head) return std::nullopt;
  std::uint64_t size = static_cast<unsigned char>((*head)[1]) & 127;
  const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
  const auto length = take(more);
  if (!length) return std::nullopt;
  if (more > 0) size = 0;
  for (const char byte : *length) size = size << 8 | static_cast<unsigned char>(byte);
  const auto payload = take(size);
  if (!payload) return std::nullopt;
  return Frame{(*head)[0] & 15, *payload};
}

std::optional<std::chrono::milliseconds> RawClient::closed_after(std::chrono::milliseconds limit) {
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    const auto now = std::chrono::steady_clock::now() - start;
    const auto left = limit - std::chrono::duration_cast<std::chrono::milliseconds>(now);
    pollfd wanted{socket_, POLLIN, 0};
    if (left.count() <= 0 || poll(&wanted, 1, static_cast<int>(left.count())) <= 0) return std::nullopt;
    std::array<char, 65536> block{};
    if (recv(socket_, block.data(), block.size(), 0) > 0) continue;
    return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start);
  }
}

}  // namespace pointskin::test
