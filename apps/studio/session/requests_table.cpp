// Every request that there is, with what answers it.
#include <algorithm>
#include <limits>
#include <utility>

#include "engine.hpp"

namespace pointskin::studio {

/// Handlers are functions of the engine and the request.
struct Handlers {
  static Json apply(Engine& engine, const Request& request) {
    const scene::JsonReader reader = request.reader({"operation"});
    engine.previews_.forget();
    return engine.desk_.apply(engine.with_files(reader.at("operation").value()));
  }

  static Json move(Engine& engine, std::int64_t steps) {
    const auto done = static_cast<std::int64_t>(engine.desk_.present().done());
    const auto size = static_cast<std::int64_t>(engine.desk_.present().size());
    engine.previews_.forget();
    return engine.desk_.go(static_cast<std::size_t>(std::clamp(done + steps, std::int64_t{0}, size)));
  }

  static Json go(Engine& engine, const Request& request) {
    const scene::JsonReader reader = request.reader({"done"});
    const auto size = static_cast<std::int64_t>(engine.desk_.present().size());
    engine.previews_.forget();
    return engine.desk_.go(static_cast<std::size_t>(reader.at("done").whole_number(0, size)));
  }

  static Json options(Engine& engine, const Request& request) {
    const scene::JsonReader reader = request.reader({"patch", "final"});
    nlohmann::json patch = reader.at("patch").value();
    if (!reader.has("final") || !reader.at("final").boolean()) return engine.previews_.options(patch);
    if (!patch.is_object()) reader.at("patch").refuse("must be an object");
    patch["op"] = "options";
    engine.previews_.forget();
    return engine.desk_.apply(patch);
  }

  static Json preview(Engine& engine, const Request& request) {
    return engine.previews_.operation(engine.with_files(request.reader({"operation"}).at("operation").value()));
  }

  static Json operation(Engine& engine, const Request& request) {
    const auto size = static_cast<std::int64_t>(engine.desk_.present().size());
    const scene::JsonReader reader = request.reader({"index"});
    const std::int64_t index = reader.at("index").whole_number(0, std::max(size - 1, std::int64_t{0}));
    if (size == 0) reader.at("index").refuse("there is no operation");
    return {{"operation", scene::to_json(engine.desk_.present().operation(static_cast<std::size_t>(index)), {})}};
  }

  static Json compare(Engine& engine, const Request& request) {
    const scene::JsonReader reader = request.reader({"reference"});
    const scene::SolidSource source = engine.exchange_.source(reader.at("reference"));
    const std::string name =
        source.shape.empty() ? std::filesystem::path(source.file).filename().string() : source.shape;
    return engine.measures_.compare(source, name);
  }

  static Json estimate(Engine& engine, const Request& request) {
    const scene::JsonReader reader = request.reader({"options"});
    return engine.measures_.estimate(reader.has("options") ? reader.at("options").value() : nlohmann::json::object());
  }

  static Json pick(Engine& engine, const Request& request) {
    const scene::JsonReader reader = request.reader({"origin", "direction"});
    return engine.measures_.pick(reader.at("origin").vector(), reader.at("direction").vector());
  }

  static Json sequence(Engine& engine, const Request& request) {
    const scene::JsonReader reader = request.reader({"path", "particle_radius", "stop"});
    if (reader.has("stop")) return engine.live_.close_sequence();
    const std::filesystem::path pattern = reader.at("path").text();
    const double radius = reader.has("particle_radius") ? reader.at("particle_radius").number() : 0;
    const Json folder = engine.exchange_.list(pattern.parent_path().string());
    return engine.live_.open_sequence(std::filesystem::path(folder["folder"].get<std::string>()) / pattern.filename(),
                                      radius);
  }

  static Json frame(Engine& engine, const Request& request) {
    return engine.live_.frame(request.reader({"index"}).at("index").whole_number(0, INT32_MAX));
  }

  static Json show_present(Engine& engine, const Request& request) {
    (void)request.reader({});
    engine.desk_.show_mesh();
    return Json::object();
  }
};

const std::map<std::string, Engine::Entry>& Engine::table() {
  static const std::map<std::string, Entry> entries = {
      {"open", {"", [](Engine& e, const Request& r) { return e.open(r); }}},
      {"resume", {"", [](Engine& e, const Request& r) { return e.resume(r); }}},
      {"apply", {"", Handlers::apply}},
      {"undo", {"", [](Engine& e, const Request& r) { return (void)r.reader({}), Handlers::move(e, -1); }}},
      {"redo", {"", [](Engine& e, const Request& r) { return (void)r.reader({}), Handlers::move(e, 1); }}},
      {"go", {"", Handlers::go}},
      {"options", {"", Handlers::options}},
      {"preview", {"preview", Handlers::preview}},
      {"preview_end", {"", [](Engine& e, const Request& r) { return (void)r.reader({}), e.previews_.end(); }}},
      {"operation", {"", Handlers::operation}},
      {"files",
       {"", [](Engine& e, const Request& r) { return e.exchange_.list(r.reader({"folder"}).at("folder").text()); }}},
      {"save", {"", [](Engine& e, const Request& r) { return e.save(r); }}},
      {"digest", {"", [](Engine& e, const Request& r) { return (void)r.reader({}), e.digest(); }}},
      {"problems", {"", [](Engine& e, const Request& r) { return (void)r.reader({}), e.measures_.problems(); }}},
      {"compare", {"", Handlers::compare}},
      {"reference_end", {"", Handlers::show_present}},
      {"values",
       {"", [](Engine& e, const Request& r) { return e.measures_.values(r.reader({"name"}).at("name").text()); }}},
      {"values_end", {"", Handlers::show_present}},
      {"histogram",
       {"measure", [](Engine& e, const Request& r) { return (void)r.reader({}), e.measures_.histogram(); }, true}},
      {"estimate", {"estimate", Handlers::estimate, true}},
      {"pick", {"", Handlers::pick}},
      {"fluid", {"", [](Engine& e, const Request& r) { return e.live_.fluid(r); }}},
      {"sequence", {"", Handlers::sequence}},
      {"frame", {"frame", Handlers::frame}},
  };
  return entries;
}

const Engine::Entry* Engine::find(const std::string& what) {
  const auto found = table().find(what);
  return found == table().end() ? nullptr : &found->second;
}

}  // namespace pointskin::studio
