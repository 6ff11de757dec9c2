// The requests, and the thread that does them one after the other.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "exchange.hpp"
#include "live.hpp"
#include "measures.hpp"
#include "mesh_teller.hpp"
#include "previews.hpp"
#include "scene_desk.hpp"
#include "services.hpp"
#include "studio.hpp"

namespace pointskin::studio {

/// Everything of the engine's thread: made by it, used by it.
class Engine {
 public:
  Engine(const StudioOptions& options, Services services, Exchange& exchange);

  /// Opens what is to be open.
  void start();
  /// Does a job and answers it, or puts it back where something more urgent came.
  void run(const JobQueue::Job& job);
  /// Something that nobody waits for. @param quiet  no request came lately: longer work may begin
  /// @returns whether there was something
  bool work_ahead(bool quiet);
  /// Something moves by itself.
  [[nodiscard]] bool is_busy() const { return live_.is_running(); }

  /// What a request does: the slot in which the newest wins, empty for those that are never dropped; and its handler.
  struct Entry {
    std::string slot;
    std::function<Json(Engine&, const Request&)> handle;
    bool background = false;  ///< pages ask for it by themselves: it makes way for what a person asks for
  };
  /// By names. Entry::slot may depend on the request: see slot_of.
  static const std::map<std::string, Entry>& table();
  /// @returns null for a request that there is not
  static const Entry* find(const std::string& what);

 private:
  friend struct Handlers;

  Json open(const Request& request);
  Json save(const Request& request);
  Json resume(const Request& request);
  Json digest();
  [[nodiscard]] nlohmann::json with_files(nlohmann::json operation) const;
  [[nodiscard]] std::filesystem::path new_journal() const;
  void notice(const char* level, const std::string& text) const;

  const StudioOptions& options_;
  Services services_;
  Exchange& exchange_;
  MeshTeller teller_{services_};
  SceneDesk desk_{services_, teller_};
  Previews previews_{services_, desk_, teller_};
  Measures measures_{services_, desk_, teller_};
  Live live_{services_, teller_};
};

}  // namespace pointskin::studio
