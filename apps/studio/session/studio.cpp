#include "studio.hpp"

#include <chrono>
#include <cstdlib>
#include <exception>
#include <future>
#include <string>
#include <thread>
#include <utility>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>

#include "engine.hpp"
#include "shapes.hpp"

namespace pointskin::studio {

namespace fs = std::filesystem;

fs::path default_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return fs::path(state) / "pointskin";
  const char* home = std::getenv("HOME");
  return fs::path(home != nullptr && *home != 0 ? home : "/tmp") / ".local/state/pointskin";
}

namespace {

Json formats_json() {
  Json list = Json::array();
  for (const FormatInfo& format : file_formats())
    list.push_back({{"name", format.name},
                    {"extensions", format.extensions},
                    {"cloud", format.writes_clouds},
                    {"mesh", format.writes_meshes},
                    {"reads", format.reads_clouds || format.reads_meshes}});
  return list;
}

}  // namespace

class Studio::Impl {
 private:
  StudioOptions options_;
  Roots roots_;

 public:
  Audience audience_;
  BlobStore blobs_;
  Exchange exchange_;

  explicit Impl(StudioOptions options)
      : options_(settled(std::move(options))), roots_(options_.roots), exchange_(options_.folder, roots_) {
    std::promise<void> ready;
    std::future<void> is_ready = ready.get_future();
    thread_ = std::thread([this, &ready] { work(ready); });
    try {
      is_ready.get();
    } catch (...) {
      thread_.join();
      throw;
    }
  }

  ~Impl() {
    audience_.tell({{"event", "closing"}});
    queue_.close();
    thread_.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void message(const std::shared_ptr<Client>& client, std::string_view text) {
    std::optional<Request> request = parse_request(client, text);
    if (!request) return;
    if (request->what == "ack" || request->what == "cancel" || request->what == "hello")
      now(*request);
    else if (Engine::find(request->what) == nullptr)
      refuse(*request, "usage", "there is no request '" + request->what + "'");
    else
      later(std::move(*request));
  }

 private:
  static StudioOptions settled(StudioOptions options) {
    if (options.folder.empty()) options.folder = default_folder();
    return options;
  }

  /// What a page needs to begin, even while the engine is at work.
  Json hello(const Request& request) const {
    (void)request.reader({});
    Json roots = Json::array();
    for (const fs::path& root : roots_.folders()) roots.push_back(root.string());
    Json shapes = Json::array();
    for (const char* name : bench::kShapeNames) shapes.push_back(name);
    Json answer = {{"program", "pointskin"},           {"version", options_.version},
                   {"device", options_.device.name()}, {"loopback", request.client->loopback()},
                   {"roots", std::move(roots)},        {"shapes", std::move(shapes)},
                   {"formats", formats_json()},        {"max_upload", options_.max_upload}};
    answer["root"] = answer["roots"][0];
    const Json state = audience_.remembered("state");
    answer["scene"] = state.is_object() ? state["scene"] : Json(nullptr);
    return answer;
  }

  /// What must not wait for the engine.
  void now(const Request& request) {
    try {
      if (request.what == "cancel") {
        (void)request.reader({});
        queue_.cancel();
      } else if (request.what == "hello") {
        reply(request, hello(request));
        audience_.brief(*request.client);
        return;
      } else {
        constexpr std::int64_t kLast = std::int64_t{1} << 53;
        const std::int64_t version = request.reader({"version"}).at("version").whole_number(0, kLast);
        audience_.drew(request.client->id(), static_cast<std::uint64_t>(version));
      }
      reply(request, Json::object());
    } catch (const Error& error) {
      refuse(request, name_of(error.code()), error.what());
    }
  }

  void later(Request request) {
    const Engine::Entry& entry = *Engine::find(request.what);
    std::string slot = entry.slot;
    const auto final = request.body.find("final");
    const bool is_live = final == request.body.end() || !final->is_boolean() || !final->get<bool>();
    if (request.what == "options" && is_live) slot = "preview";
    const Request copy = {request.client, request.id, request.what, {}};
    if (!queue_.push({std::move(request), std::move(slot), entry.background}))
      refuse(copy, "over_limit", "too many requests wait to be answered");
  }

  void work(std::promise<void>& ready) {
    try {
      Services services{options_.device, Workspace(options_.device), audience_, blobs_, queue_, roots_,
                        options_.folder, options_.most_shown};
      Engine engine(options_, std::move(services), exchange_);
      begin(engine, ready);
      loop(engine);
    } catch (...) {  // only what begin() does before it is ready: jobs answer their own errors
      ready.set_exception(std::current_exception());
    }
  }

  /// A session that cannot be resumed ends the program; a cloud that cannot be read is told to the page.
  void begin(Engine& engine, std::promise<void>& ready) {
    const bool must_begin = options_.resume || (!options_.session.empty() && fs::exists(options_.session));
    if (must_begin) engine.start();
    ready.set_value();
    if (must_begin) return;
    try {
      engine.start();
    } catch (const std::exception& error) {
      const Json event = {{"event", "notice"}, {"level", "error"}, {"text", error.what()}};
      audience_.remember("failure", {event});
      audience_.tell(event);
    }
  }

  void loop(Engine& engine) {
    using Clock = std::chrono::steady_clock;
    using std::chrono::milliseconds;
    constexpr milliseconds kQuiet{150};
    bool more = true;
    for (Clock::time_point last = Clock::now(); !queue_.closed();) {
      const milliseconds wait{more ? 0 : engine.is_busy() ? 1 : 40};
      if (auto job = queue_.next(wait)) {
        engine.run(*job);
        queue_.finished();
        last = Clock::now();
        more = false;
      } else {
        more = engine.work_ahead(Clock::now() - last >= kQuiet);
      }
    }
  }

  JobQueue queue_;
  std::thread thread_;
};

Studio::Studio(StudioOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
Studio::~Studio() = default;

void Studio::opened(std::shared_ptr<Client> client) { impl_->audience_.join(std::move(client)); }
void Studio::closed(std::uint64_t client) { impl_->audience_.leave(client); }
void Studio::message(const std::shared_ptr<Client>& client, std::string_view json) { impl_->message(client, json); }
std::shared_ptr<const Bytes> Studio::blob(std::uint64_t id, bool compressed) {
  return impl_->blobs_.get(id, compressed);
}
std::optional<Download> Studio::download(std::uint64_t id) { return impl_->exchange_.download(id); }
fs::path Studio::upload_folder() { return impl_->exchange_.upload_folder(); }
std::uint64_t Studio::uploaded(fs::path file, std::string name) { return impl_->exchange_.uploaded(file, name); }

}  // namespace pointskin::studio
