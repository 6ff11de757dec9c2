// A page of the studio without a browser: it asks, waits for answers, and remembers what it was told.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "studio/session/application.hpp"

namespace pointskin::test {

using Json = nlohmann::json;

/// What a request was refused with.
class Refused : public std::runtime_error {
 public:
  Refused(std::string code, const std::string& text) : std::runtime_error(code + ": " + text), code_(std::move(code)) {}
  [[nodiscard]] const std::string& code() const { return code_; }

 private:
  std::string code_;
};

/// Waiting ends after two minutes, with std::runtime_error.
class Page {
 public:
  /// Connects. Pages on this machine fetch blobs as they are.
  explicit Page(studio::Application& application);
  /// Disconnects.
  ~Page();
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  /// Sends a request. @returns its id
  std::int64_t send(const std::string& what, Json body = Json::object());
  /// Sends a text as it is.
  void send_text(const std::string& text);
  /// Waits for the reply. @throws Refused
  Json reply(std::int64_t id);
  /// Both.
  Json ask(const std::string& what, Json body = Json::object()) { return reply(send(what, std::move(body))); }
  /// The code that a request is refused with; "" if it is not.
  std::string refusal(const std::string& what, Json body = Json::object());

  /// All that came so far, and the events among it.
  std::vector<Json> messages() const;
  std::vector<Json> events(const std::string& name) const;
  /// The last event of this name; waits for the first one.
  Json last(const std::string& name);
  /// The first event of this name from number `from` on (of those of this name) that `fits`; waits for it.
  Json wait(
      const std::string& name, std::size_t from = 0,
      const std::function<bool(const Json&)>& fits = [](const Json&) { return true; });
  std::size_t count(const std::string& name) const { return events(name).size(); }

  /// Whether meshes are drawn, and said to be, as they come. They are, unless this is called.
  void draws(bool at_once) { draws_ = at_once; }

  [[nodiscard]] std::uint64_t id() const;

 private:
  class Recorder;

  /// Waits until `found` does not return null any more.
  Json wait_for(const std::function<Json(const std::vector<Json>&)>& found, const std::string& what);
  void draw();

  studio::Application& application_;
  std::shared_ptr<Recorder> recorder_;
  std::int64_t last_id_ = 0;
  std::size_t drawn_ = 0;  ///< messages that were looked at for meshes
  bool draws_ = true;
};

}  // namespace pointskin::test
