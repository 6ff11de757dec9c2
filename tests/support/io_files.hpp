// Files and bytes for the tests of the readers and writers.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <type_traits>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "io/formats.hpp"

namespace pointskin::test {

/// A folder that is removed with all it holds.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pointskin_io_XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::size_t file_count() const {
    const std::filesystem::directory_iterator begin(path_);
    return static_cast<std::size_t>(std::distance(begin, std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void make_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The bytes of `value`, reversed for big endian.
template <class T>
std::string raw(std::type_identity_t<T> value, bool big_endian = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline Cloud cloud_of(const std::string& name, const std::string& bytes, const ReadOptions& options = {}) {
  return io::parse_cloud({name, bytes}, options);
}

inline Mesh mesh_of(const std::string& name, const std::string& bytes, const ReadOptions& options = {}) {
  return io::parse_mesh({name, bytes}, options);
}

/// The story of the Error that `f` throws; "" if it throws none, and the code must be `code`.
template <class F>
std::string story_of(ErrorCode code, const F& f) {
  try {
    f();
  } catch (const Error& error) {
    if (error.code() != code) return "wrong code: " + std::string(error.what());
    return error.what();
  }
  return "";
}

/// Calls parse(damaged) for every prefix of `bytes` and for every byte replaced by each of a few others. Each call must
/// return or throw Error; anything else fails the test that runs it.
template <class Parse>
void damage(const std::string& bytes, const Parse& parse) {
  const auto attempt = [&](const std::string& damaged) {
    try {
      parse(damaged);
    } catch (const Error& error) {
      const std::string story = error.what();
      if (story.find('\n') != std::string::npos) throw std::logic_error("a story of two lines: " + story);
    }
  };
  for (std::size_t length = 0; length < bytes.size(); ++length) attempt(bytes.substr(0, length));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const char wrong : {'\0', '\n', ' ', '-', '9', '/', '\x7f', '\xff'}) {
      std::string damaged = bytes;
      damaged[i] = wrong;
      attempt(damaged);
    }
  }
}

}  // namespace pointskin::test
