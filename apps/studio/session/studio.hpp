// The studio behind its page: scenes, previews, water, files. Answers messages; one thread computes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <pointskin/device.hpp>
#include <pointskin/reconstruct.hpp>

#include "studio/session/application.hpp"

namespace pointskin::studio {

struct StudioOptions {
  Device device = Device::automatic();
  std::vector<std::filesystem::path> clouds{};  ///< that are open when the first page comes, merged
  bool demo = false;                            ///< without clouds: a generated shape is open
  std::vector<std::filesystem::path> roots{};   ///< below which pages may read and write; at least one
  std::filesystem::path folder{};               ///< of journals and uploads; is made if it is not there
  std::filesystem::path session{};              ///< journal of this session; empty: a new one in `folder`
  bool resume = false;                          ///< go on with that journal, or with the newest one in `folder`
  Options reconstruction{};
  std::string version{};        ///< of the program, for pages
  std::int64_t max_upload = 0;  ///< bytes, for pages
  /// Triangles and points that pages are shown: larger surfaces are shown at a lower depth, larger clouds in part.
  std::int64_t most_shown = 5'000'000;
};

/// The journals' folder of this user: $XDG_STATE_HOME/pointskin, or ~/.local/state/pointskin.
std::filesystem::path default_folder();

class Studio : public Application {
 public:
  /// Starts the thread that computes. What is to be open is opened by it, later; errors of that go to pages.
  /// @throws Error device_unavailable; usage for a root that is none, or a journal that is not there
  explicit Studio(StudioOptions options);
  /// Ends what runs, and the thread.
  ~Studio() override;

  void opened(std::shared_ptr<Client> client) override;
  void closed(std::uint64_t client) override;
  void message(const std::shared_ptr<Client>& client, std::string_view json) override;
  std::shared_ptr<const Bytes> blob(std::uint64_t id, bool compressed) override;
  std::optional<Download> download(std::uint64_t id) override;
  [[nodiscard]] std::filesystem::path upload_folder() override;
  std::uint64_t uploaded(std::filesystem::path file, std::string name) override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointskin::studio
