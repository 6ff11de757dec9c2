#include "engine.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <exception>
#include <new>
#include <utility>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "scene/options.hpp"
#include "scene/sha256.hpp"

namespace pointskin::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kDemoPoints = 60'000;

/// The newest journal of a folder; empty if there is none.
fs::path newest_journal(const fs::path& folder) {
  fs::path newest;
  std::error_code failure;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure))
    if (entry->path().extension() == ".jsonl" && (newest.empty() || entry->path().filename() > newest.filename()))
      newest = entry->path();
  return newest;
}

}  // namespace

Engine::Engine(const StudioOptions& options, Services services, Exchange& exchange)
    : options_(options), services_(std::move(services)), exchange_(exchange) {}

void Engine::notice(const char* level, const std::string& text) const {
  services_.audience.tell({{"event", "notice"}, {"level", level}, {"text", text}});
}

/// Names sort by time.
fs::path Engine::new_journal() const {
  // A scene that is opened later must not take the place of the one before.
  if (!options_.session.empty() && !fs::exists(options_.session)) return options_.session;
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &parts);
  const std::string thousandths = std::to_string(1000 + ms).substr(1);
  return services_.folder / (std::string(stamp) + "-" + thousandths + "-" + std::to_string(getpid()) + ".jsonl");
}

void Engine::start() {
  if (options_.resume) {
    const fs::path journal = options_.session.empty() ? newest_journal(services_.folder) : options_.session;
    if (journal.empty())
      throw Error(ErrorCode::invalid_input, services_.folder.string() + ": there is no session to resume");
    desk_.resume(journal);
    return;
  }
  if (!options_.session.empty() && fs::exists(options_.session))
    throw Error(ErrorCode::usage, options_.session.string() + ": there is a session; go on with it by --resume");
  scene::Document document;
  document.options = options_.reconstruction;
  for (const fs::path& cloud : options_.clouds)
    document.base.clouds.push_back({fs::absolute(cloud).string(), {}, {}, 0});
  if (document.base.clouds.empty() && options_.demo) document.base.clouds.push_back({{}, {}, "hand", kDemoPoints});
  if (!document.base.clouds.empty()) desk_.begin(document, new_journal());
}

void Engine::run(const JobQueue::Job& job) {
  constexpr std::chrono::milliseconds kDrawing{600};
  const Entry& entry = *find(job.request.what);
  if (job.background)
    services_.audience.wait_until_drawn(teller_.version(), kDrawing, [this] { return services_.queue.waiting(); });
  try {
    reply(job.request, entry.handle(*this, job.request));
  } catch (const Error& error) {
    const bool is_old = error.code() == ErrorCode::interrupted && !job.slot.empty();
    if (is_old && job.background && services_.queue.put_back(job)) return;
    refuse(job.request, is_old ? "superseded" : name_of(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    refuse(job.request, name_of(ErrorCode::over_limit), "there is not enough memory for this");
  } catch (const std::exception& error) {
    refuse(job.request, name_of(ErrorCode::internal), error.what());
  }
}

bool Engine::work_ahead(bool quiet) {
  try {
    return (quiet && (desk_.work_ahead() || (!live_.is_running() && previews_.prepare()))) || live_.work_ahead();
  } catch (const std::exception& error) {
    notice("error", error.what());
    live_.stop();
    return false;
  }
}

Json Engine::open(const Request& request) {
  const scene::JsonReader reader = request.reader({"files", "add", "options"});
  scene::Document document;
  document.options = options_.reconstruction;
  if (reader.has("add") && reader.at("add").boolean() && desk_.has_scene()) document = desk_.document();
  document.operations.clear();  // they were made for other points
  document.done = 0;
  if (reader.has("options")) document.options = scene::read_options(reader.at("options"), document.options);
  const scene::JsonReader files = reader.at("files");
  files.array();
  if (files.size() == 0) files.refuse("must name a file or a shape");
  for (std::size_t i = 0; i < files.size(); ++i) {
    scene::SolidSource source = exchange_.source(files.at(i));
    document.base.clouds.push_back({std::move(source.file), {}, std::move(source.shape), source.points});
  }
  previews_.forget();
  desk_.begin(document, new_journal());
  return {{"scene", desk_.state()["scene"]}};
}

Json Engine::resume(const Request& request) {
  const scene::JsonReader reader = request.reader({"path", "upload"});
  const fs::path file = reader.has("upload") ? exchange_.upload(reader.at("upload").whole_number(1, INT32_MAX))
                                             : exchange_.readable(reader.at("path").text());
  const bool is_journal = file.extension() == ".jsonl";
  const scene::Document document =
      is_journal ? scene::read_journal(file.string()) : scene::read_document(file.string());
  for (const std::string& changed : check_clouds(document.base)) notice("warning", changed);
  previews_.forget();
  desk_.begin(document, new_journal());
  return {{"scene", desk_.state()["scene"]}};
}

/// The files that an operation names, as absolute paths: pages name them as for `open`.
nlohmann::json Engine::with_files(nlohmann::json operation) const {
  const auto settle = [this](nlohmann::json& place) {
    if (!place.is_object()) return;
    if (place.contains("upload")) {
      const scene::JsonReader id(place["upload"], "upload");
      place["file"] = exchange_.upload(id.whole_number(1, INT32_MAX)).string();
      place.erase("upload");
    } else if (place.contains("file")) {
      place["file"] = exchange_.readable(scene::JsonReader(place["file"], "file").text()).string();
    }
  };
  settle(operation);
  if (operation.is_object() && operation.contains("with")) settle(operation["with"]);
  return operation;
}

Json Engine::digest() {
  const fs::path file = services_.folder / ("digest-" + std::to_string(getpid()) + ".ply");
  write_mesh(file.string(), desk_.present().mesh(), services_.device.threads);
  const std::string sha256 = scene::sha256_of_file(file.string());
  fs::remove(file);
  return {{"sha256", sha256}, {"triangles", desk_.present().mesh().triangles.size()}};
}

Json Engine::save(const Request& request) {
  const scene::JsonReader reader = request.reader({"what", "name", "folder", "download", "overwrite", "upload"});
  const std::string what = reader.at("what").one_of({"mesh", "cloud", "session", "script", "picture"});
  const int threads = services_.device.threads;
  return exchange_.save(reader, [&](const std::string& path, const fs::path& folder) {
    if (what == "mesh") write_mesh(path, desk_.present().mesh(), threads);
    if (what == "cloud") write_cloud(path, desk_.present().cloud(), threads);
    if (what == "session" || what == "script") {
      scene::Document document = desk_.document();
      if (what == "script") document.base.clouds.clear();
      write_file_atomically(path, to_json(document, folder).dump(2) + "\n");
    }
    if (what == "picture") {
      const fs::path picture = exchange_.upload(reader.at("upload").whole_number(1, INT32_MAX));
      fs::copy_file(picture, path, fs::copy_options::overwrite_existing);
    }
  });
}

}  // namespace pointskin::studio
