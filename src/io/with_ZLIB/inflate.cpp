#include "io/inflate.hpp"

#include <algorithm>
#include <array>
#include <limits>

#define ZLIB_CONST  // what is unpacked is not changed
#include <zlib.h>

namespace pointskin::io {
namespace {

/// The state of zlib while a file is unpacked.
class Stream {
 public:
  Stream() : ready_(inflateInit2(&state_, kGzip) == Z_OK) {}
  ~Stream() {
    if (ready_) inflateEnd(&state_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// @returns false at the end, and where the file is broken
  bool unpack(std::string_view& packed, std::string& out) {
    std::array<char, std::size_t{1} << 16> room;
    const auto given = static_cast<uInt>(std::min<std::size_t>(packed.size(), std::numeric_limits<uInt>::max()));
    state_.next_in = reinterpret_cast<const Bytef*>(packed.data());
    state_.avail_in = given;
    state_.next_out = reinterpret_cast<Bytef*>(room.data());
    state_.avail_out = room.size();
    const int result = ready_ ? inflate(&state_, Z_NO_FLUSH) : Z_MEM_ERROR;
    packed.remove_prefix(given - state_.avail_in);
    out.append(room.data(), room.size() - state_.avail_out);
    ended_ = result == Z_STREAM_END;
    return result == Z_OK;
  }
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  static constexpr int kGzip = 16 + MAX_WBITS;
  z_stream state_{};
  bool ready_ = false, ended_ = false;
};

}  // namespace

bool inflate_to(std::string_view packed, std::size_t bytes, std::string& out) {
  const std::size_t before = out.size();
  out.resize(before + bytes);
  uLongf length = bytes;
  const int state = uncompress(reinterpret_cast<Bytef*>(out.data() + before), &length,
                               reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  return state == Z_OK && length == bytes;
}

std::optional<std::string> gunzip(std::string_view packed) {
  std::string out;
  Stream stream;
  while (stream.unpack(packed, out)) {
  }
  if (!stream.ended()) return std::nullopt;
  return out;
}

}  // namespace pointskin::io
