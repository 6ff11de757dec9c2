// Editing on the GPU against editing on the CPU: the same points and the same surfaces, step by step.
#include <gtest/gtest.h>

#include <pointskin/device.hpp>
#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>

#include <memory>
#include <vector>

#include "parity/gpu_test.hpp"
#include "property/reconstruction.hpp"
#include "support/shapes.hpp"
#include "support/two_fingers.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;
using test::front_camera;
using test::pixel_at;

class GpuEdits : public test::GpuTest {
 protected:
  void expect_parity(const Cloud& cloud, const EditOptions& options, const std::vector<Operation>& operations) {
    EditSession on_cpu(cloud, options, Device::cpu());
    EditSession on_gpu(cloud, options, gpu_);
    expect_same_bytes(on_gpu.mesh(), on_cpu.mesh());
    for (const Operation& operation : operations) {
      const StepReport expected = on_cpu.apply(operation);
      const StepReport step = on_gpu.apply(operation);
      EXPECT_EQ(step.added, expected.added);
      EXPECT_EQ(step.removed, expected.removed);
      EXPECT_EQ(step.flipped, expected.flipped);
      EXPECT_EQ(step.snapped, expected.snapped);
      EXPECT_EQ(step.warm, expected.warm);
      EXPECT_EQ(step.after.genus, expected.after.genus);
      const Cloud a = on_gpu.cloud();
      const Cloud b = on_cpu.cloud();
      EXPECT_TRUE(test::same_bytes(a.positions, b.positions));
      EXPECT_TRUE(test::same_bytes(a.normals, b.normals));
      expect_same_bytes(on_gpu.mesh(), on_cpu.mesh());
    }
    while (on_cpu.undo()) {
      EXPECT_TRUE(on_gpu.undo());
      expect_same_bytes(on_gpu.mesh(), on_cpu.mesh());
    }
  }
};

EditOptions options_at(int depth) {
  EditOptions options;
  options.reconstruction.depth = depth;
  return options;
}

/// A slanted perspective view.
Camera slanted_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  const double c = 0.8;
  const double s = 0.6;
  camera.view = {c, 0, -s, 0.1, 0, 1, 0, -0.05, s, 0, c, -4, 0, 0, 0, 1};
  camera.projection = {2, 0, 0.1, 0, 0, 2.5, -0.05, 0, 0, 0, -1, -0.1, 0, 0, -1, 0};
  return camera;
}

TEST_F(GpuEdits, GuideAlikeByStrokes) {
  expect_parity(test::two_fingers_cloud(40'000, 1), options_at(7), test::parting_strokes());
  Guide guide;
  guide.camera = slanted_camera();
  guide.stroke = {{200, 240}, {330, 250}, {420, 200}};
  expect_parity(test::sphere_cloud(30'000, 2), options_at(6), {guide});
}

TEST_F(GpuEdits, FillAndRemoveAlike) {
  Guide guide;
  guide.camera = slanted_camera();
  guide.area = {{{250, 180}, {400, 170}, {420, 300}, {240, 310}}, {{300, 220}, {350, 220}, {325, 270}}};
  Remove remove;
  remove.camera = slanted_camera();
  remove.area = {{{200, 100}, {330, 100}, {330, 400}, {200, 400}}};
  Remove originals = remove;
  originals.originals = true;
  expect_parity(test::torus_cloud(30'000, 3), options_at(6), {guide, remove, originals});
}

TEST_F(GpuEdits, InsertAndSnapAlike) {
  Cloud base = test::torus_cloud(40'000, 4);
  base.attributes = {{"red", std::vector<std::uint8_t>(40'000, 100)}, {"label", std::vector<std::int32_t>(40'000, 7)}};
  Insert insert;
  insert.part = std::make_shared<const Cloud>(test::torus_cloud(20'000, 5, 1, 0.35, {0.02, 0.01, -0.02}));
  insert.lower = {0, -2, -2};
  insert.snap = true;
  Insert far = insert;
  far.placement.translation = {3, 0, 0};
  EditOptions options = options_at(6);
  options.reconstruction.attributes = true;
  expect_parity(base, options, {insert, far});
}

TEST_F(GpuEdits, ChooseTheFrontAlike) {
  Flip flip;
  flip.camera = slanted_camera();
  flip.area = {{{250, 180}, {400, 170}, {420, 300}, {240, 310}}};
  flip.front_layer = true;
  const Remove remove{slanted_camera(), {{{200, 100}, {330, 100}, {330, 400}, {200, 400}}}, true, true};
  Insert lasso;
  lasso.part = std::make_shared<const Cloud>(test::torus_cloud(20'000, 8));
  lasso.camera = slanted_camera();
  lasso.area = flip.area;
  expect_parity(test::torus_cloud(30'000, 9), options_at(6), {flip, flip, remove, lasso});
}

TEST_F(GpuEdits, ContinueAlike) {
  EditOptions options = options_at(6);
  EditSession first(test::two_fingers_cloud(20'000, 10), options, Device::cpu());
  first.apply(test::parting_strokes()[0]);
  options.continued = true;
  options.reconstruction.keep_strays = true;
  expect_parity(first.cloud(), options, {test::parting_strokes()[1]});
}

TEST_F(GpuEdits, WarmAndColdAlikeUnderEveryOption) {
  EditOptions cold = options_at(6);
  cold.warm_start = false;
  expect_parity(test::two_fingers_cloud(20'000, 6), cold, test::parting_strokes());
  EditOptions dirichlet = options_at(6);
  dirichlet.reconstruction.boundary = Boundary::dirichlet;
  dirichlet.reconstruction.confidence = true;
  dirichlet.states_kept = 1;
  dirichlet.undo_bytes = 0;
  expect_parity(test::two_fingers_cloud(20'000, 7), dirichlet, test::parting_strokes());
}

}  // namespace
}  // namespace pointskin
