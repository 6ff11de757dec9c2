#include "studio/session/page.hpp"

#include <atomic>
#include <chrono>
#include <utility>

namespace pointskin::test {
namespace {

std::uint64_t next_page() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

}  // namespace

/// What the studio holds of the page.
class Page::Recorder : public studio::Client {
 public:
  void send(std::string json) override {
    const std::lock_guard lock(mutex);
    messages.push_back(Json::parse(json));
    changed.notify_all();
  }
  [[nodiscard]] bool loopback() const override { return true; }
  [[nodiscard]] std::uint64_t id() const override { return id_; }

  mutable std::mutex mutex;
  std::condition_variable changed;
  std::vector<Json> messages;

 private:
  std::uint64_t id_ = next_page();
};

Page::Page(studio::Application& application) : application_(application), recorder_(std::make_shared<Recorder>()) {
  application_.opened(recorder_);
}

Page::~Page() {
  if (count("closing") == 0) application_.closed(recorder_->id());  // else the studio is no more
}

std::uint64_t Page::id() const { return recorder_->id(); }

std::int64_t Page::send(const std::string& what, Json body) {
  body["id"] = ++last_id_;
  body["do"] = what;
  send_text(body.dump());
  return last_id_;
}

void Page::send_text(const std::string& text) { application_.message(recorder_, text); }

std::vector<Json> Page::messages() const {
  const std::lock_guard lock(recorder_->mutex);
  return recorder_->messages;
}

std::vector<Json> Page::events(const std::string& name) const {
  std::vector<Json> found;
  for (const Json& message : messages())
    if (message.value("event", "") == name) found.push_back(message);
  return found;
}

void Page::draw() {
  std::vector<std::uint64_t> versions;
  {
    const std::lock_guard lock(recorder_->mutex);
    for (; drawn_ < recorder_->messages.size(); ++drawn_)
      if (recorder_->messages[drawn_].contains("version") && recorder_->messages[drawn_].contains("event"))
        versions.push_back(recorder_->messages[drawn_]["version"]);
  }
  for (const std::uint64_t version : versions) send("ack", {{"version", version}});
}

Json Page::wait_for(const std::function<Json(const std::vector<Json>&)>& found, const std::string& what) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (std::chrono::steady_clock::now() < end) {
    if (draws_) draw();
    std::unique_lock lock(recorder_->mutex);
    Json result = found(recorder_->messages);
    if (!result.is_null()) return result;
    recorder_->changed.wait_for(lock, std::chrono::milliseconds(20));
  }
  throw std::runtime_error("waited in vain for " + what);
}

Json Page::reply(std::int64_t id) {
  Json found = wait_for(
      [id](const std::vector<Json>& messages) -> Json {
        for (auto message = messages.rbegin(); message != messages.rend(); ++message)
          if (message->contains("id") && (*message)["id"] == id) return *message;
        return nullptr;
      },
      "the reply " + std::to_string(id));
  if (found.contains("error")) throw Refused(found["error"]["code"], found["error"]["text"]);
  if (found.value("ok", false) != true)
    throw std::runtime_error("a reply that is neither ok nor an error: " + found.dump());
  return found;
}

std::string Page::refusal(const std::string& what, Json body) {
  try {
    (void)ask(what, std::move(body));
  } catch (const Refused& refused) {
    return refused.code();
  }
  return "";
}

Json Page::wait(const std::string& name, std::size_t from, const std::function<bool(const Json&)>& fits) {
  return wait_for(
      [&](const std::vector<Json>& messages) -> Json {
        std::size_t number = 0;
        for (const Json& message : messages)
          if (message.value("event", "") == name && number++ >= from && fits(message)) return message;
        return nullptr;
      },
      "the event " + name);
}

Json Page::last(const std::string& name) {
  (void)wait(name);
  return events(name).back();
}

}  // namespace pointskin::test
