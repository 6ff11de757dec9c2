// A studio with a page, in folders of its own.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include "studio/session/page.hpp"
#include "studio/session/studio.hpp"
#include "studio/wire/blob_reader.hpp"

namespace pointskin::test {

class StudioTest : public testing::Test {
 protected:
  StudioTest();
  ~StudioTest() override;

  /// Ends what runs and starts a studio. @param options  without folders
  void start(studio::StudioOptions options = {});
  /// Ends the studio in order.
  void stop();
  /// Opens samples of a generated shape, and waits until they are there.
  void open_shape(const std::string& name = "torus", int points = 6'000, int depth = 5);

  [[nodiscard]] Page& page() { return *page_; }
  [[nodiscard]] studio::Studio& studio() { return *studio_; }
  /// Connects one more page.
  std::unique_ptr<Page> another_page() { return std::make_unique<Page>(*studio_); }

  /// SHA-256 of the present mesh as a binary PLY.
  std::string digest() { return page().ask("digest").at("sha256"); }
  /// The present scene, as the last event says.
  Json scene();
  /// The same, asked for anew.
  Json fresh_scene() { return page().ask("hello").at("scene"); }
  BlobReader blob(const Json& id, bool compressed = false);

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// A file below the root.
  [[nodiscard]] std::string file(const std::string& name) const { return (root_ / name).string(); }

 private:
  std::filesystem::path base_, root_, folder_;
  std::unique_ptr<studio::Studio> studio_;
  std::unique_ptr<Page> page_;
};

// ---- Operations, seen along -z by an orthographic camera on 200 by 200 pixels of [-1.1, 1.1]^2.

Json front_camera();
/// The pixel of a place in the plane z = 0.
Json pixel(double x, double y);
Json guide(const std::vector<Json>& stroke, double interval = 0.1);
/// @param what  "remove" or "flip"
Json in_rectangle(const std::string& what, const Json& corner, const Json& opposite);
Json lift(double height);
Json combine(const std::string& operation, const Json& with, double x);

/// The bytes of `pointskin edit --script`: what a scene gives for these operations, by SHA-256.
std::string replayed(const std::string& shape, int points, int depth, const std::vector<Json>& operations);

/// SHA-256 of a mesh as a binary PLY.
std::string digest_of(const Mesh& mesh, const std::filesystem::path& folder);

}  // namespace pointskin::test
