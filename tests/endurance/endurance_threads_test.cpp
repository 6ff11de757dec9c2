// Several threads at once, each with objects of its own: the same bytes as alone.
#include <gtest/gtest.h>

#include <pointskin/edit.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "endurance/jobs.hpp"
#include "support/two_fingers.hpp"

namespace pointskin {
namespace {

using test::hash_of;
using test::Job;

constexpr int kRounds = 2;

void run_at_once(const std::vector<std::function<void()>>& works) {
  std::vector<std::thread> threads;
  threads.reserve(works.size());
  for (const auto& work : works) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
}

/// All jobs, round after round, from another one on for each thread.
std::vector<std::uint64_t> hashes_of(const std::vector<Job>& jobs, std::size_t first, int threads) {
  std::vector<std::uint64_t> hashes(jobs.size());
  Reconstructor reconstructor(Device::cpu(threads));
  for (std::size_t i = 0; i < kRounds * jobs.size(); ++i) {
    const std::size_t number = (first + i) % jobs.size();
    hashes[number] = hash_of(reconstructor.reconstruct(jobs[number].cloud, jobs[number].options));
  }
  return hashes;
}

/// A stroke done, undone and done again.
std::uint64_t hash_of_session(const Cloud& cloud, int threads) {
  EditOptions options;
  options.reconstruction.depth = 5;
  EditSession session(cloud, options, Device::cpu(threads));
  test::Hash hash;
  for (const Operation& stroke : test::parting_strokes()) {
    session.apply(stroke);
    hash.add(session.mesh().vertices).add(session.mesh().triangles);
  }
  EXPECT_TRUE(session.undo());
  hash.add(session.mesh().vertices);
  EXPECT_TRUE(session.redo());
  return hash.add(session.mesh().vertices).value();
}

/// Values and two surfaces of a field.
std::uint64_t hash_of_field(const Field& field) {
  test::Random random(3);
  std::vector<Vec3d> places(500);
  for (Vec3d& place : places) place = {random.in(-2, 2), random.in(-2, 2), random.in(-2, 2)};
  test::Hash hash;
  hash.add(field.values(places)).add(field.extract().vertices);
  return hash.add(field.extract({.isovalue = field.isovalue() * 0.9}).vertices).value();
}

Field field_of(std::uint64_t seed, int threads) {
  Reconstructor reconstructor(Device::cpu(threads));
  return reconstructor.solve(test::torus_cloud(4000, seed), {.depth = 6});
}

TEST(AtOnce, ReconstructorsGiveTheBytesThatTheyGiveAlone) {
  const std::vector<Job> jobs = test::endurance_jobs(11);
  const std::vector<std::uint64_t> alone = hashes_of(jobs, 0, 1);
  std::vector<std::vector<std::uint64_t>> together(4);
  std::vector<std::function<void()>> works;
  for (std::size_t t = 0; t < together.size(); ++t)
    works.emplace_back([&, t] { together[t] = hashes_of(jobs, 3 * t, 1 + static_cast<int>(t)); });
  run_at_once(works);
  for (const auto& hashes : together) EXPECT_EQ(hashes, alone);
}

TEST(AtOnce, SessionsFieldsAndReconstructorsGiveTheBytesThatTheyGiveAlone) {
  const std::vector<Job> jobs = test::endurance_jobs(11);
  const Cloud fingers = test::two_fingers_cloud(6000, 1);
  const std::vector<std::uint64_t> jobs_alone = hashes_of(jobs, 0, 2);
  const std::uint64_t session_alone = hash_of_session(fingers, 2);
  const std::uint64_t field_alone = hash_of_field(field_of(5, 2));
  std::vector<std::uint64_t> sessions(2), fields(2), of_jobs;
  run_at_once({[&] { sessions[0] = hash_of_session(fingers, 2); }, [&] { sessions[1] = hash_of_session(fingers, 3); },
               [&] { fields[0] = hash_of_field(field_of(5, 2)); }, [&] { fields[1] = hash_of_field(field_of(5, 1)); },
               [&] { of_jobs = hashes_of(jobs, 4, 2); }});
  EXPECT_EQ(sessions, std::vector<std::uint64_t>(2, session_alone));
  EXPECT_EQ(fields, std::vector<std::uint64_t>(2, field_alone));
  EXPECT_EQ(of_jobs, jobs_alone);
}

TEST(AtOnce, ObjectsMayMoveFromThreadToThread) {
  const std::uint64_t alone = hash_of_field(field_of(6, 2));
  std::vector<Field> fields;
  for (int i = 0; i < 3; ++i) fields.push_back(field_of(6, 2));
  std::vector<std::uint64_t> hashes(fields.size());
  std::vector<std::function<void()>> works;
  for (std::size_t i = 0; i < fields.size(); ++i)
    works.emplace_back([&, i, field = fields[i]] { hashes[i] = hash_of_field(field); });
  fields.clear();
  run_at_once(works);
  EXPECT_EQ(hashes, std::vector<std::uint64_t>(hashes.size(), alone));
}

TEST(Outliving, AFieldAnswersWhenItsReconstructorIsGone) {
  const Cloud cloud = test::torus_cloud(4000, 7);
  Reconstructor reconstructor(Device::cpu(2));
  const std::uint64_t before = hash_of_field(reconstructor.solve(cloud, {.depth = 6}));
  const Field orphan = field_of(7, 2);
  EXPECT_EQ(hash_of_field(orphan), before);
  const Field copy = orphan;  // NOLINT(performance-unnecessary-copy-initialization): that the copy answers is the test
  EXPECT_EQ(hash_of_field(copy), before);
  EXPECT_GT(orphan.workspace().held_bytes(), 0);
}

TEST(Outliving, AMeshOnTheDeviceOutlivesFieldReconstructorAndWorkspace) {
  const Cloud cloud = test::torus_cloud(4000, 8);
  const auto mesh_of = [&] {
    Reconstructor reconstructor(Device::cpu(2));
    return reconstructor.solve(cloud, {.depth = 6}).extract_on_device({});
  };
  const DeviceMesh mesh = mesh_of();
  const Mesh expected = Reconstructor(Device::cpu(2)).reconstruct(cloud, {{.depth = 6}});
  EXPECT_EQ(hash_of(download(Device::cpu(1), mesh)), hash_of(expected));
}

}  // namespace
}  // namespace pointskin
