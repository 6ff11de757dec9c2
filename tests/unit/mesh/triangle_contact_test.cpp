// Contacts of two triangles: by hand, and against whole numbers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "core/triangle_distance.hpp"
#include "mesh/triangle_contact.hpp"
#include "support/shapes.hpp"
#include "unit/mesh/exact_contact.hpp"

namespace pointskin {
namespace {

using mesh_detail::Contact;
using mesh_detail::contact_of;
using mesh_detail::MeshTriangle;
using test::ExactContact;
using test::Random;
using test::WholeTriangle;

/// Corners named by where they are in the list, unless ids are given.
MeshTriangle triangle(Vec3f a, Vec3f b, Vec3f c, Triangle ids) { return {{a, b, c}, ids}; }

const MeshTriangle kBase = triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 1, 2});

Contact with_base(Vec3f a, Vec3f b, Vec3f c, Triangle ids = {10, 11, 12}) {
  return contact_of(kBase, triangle(a, b, c, ids));
}

TEST(TriangleContact, IsCrossingWhereOnePassesThroughTheOther) {
  EXPECT_EQ(with_base({1, 1, -1}, {1, 1, 1}, {9, 9, 1}), Contact::crossing);
  EXPECT_EQ(with_base({1, 1, -1}, {1, 1, 1}, {1, 2, 0}), Contact::crossing);
}

TEST(TriangleContact, IsNoneApart) {
  EXPECT_EQ(with_base({1, 1, 1}, {2, 1, 1}, {1, 2, 1}), Contact::none);
  EXPECT_EQ(with_base({3, 3, -1}, {3, 3, 1}, {9, 9, 0}), Contact::none);  // beside the slanted edge
  EXPECT_EQ(with_base({3, 2, 0}, {4, 1, 0}, {9, 9, 0}), Contact::none);   // in its plane
  EXPECT_EQ(with_base({2.5F, 1.5F + 1e-6F, 0}, {9, 9, 1}, {9, 9, -1}), Contact::none);
}

TEST(TriangleContact, IsTouchingWhereOnlyBordersMeet) {
  EXPECT_EQ(with_base({1, 1, 0}, {1, 1, 1}, {2, 1, 1}), Contact::touching);    // a corner on the face
  EXPECT_EQ(with_base({1, 1, 0}, {2, 1, 0}, {1, 1, 1}), Contact::touching);    // an edge on the face
  EXPECT_EQ(with_base({0, 0, 0}, {-1, 0, 1}, {-1, 1, 1}), Contact::touching);  // corner on corner, other ids
  EXPECT_EQ(with_base({2, 2, -1}, {2, 2, 1}, {9, 9, 0}), Contact::touching);   // edge on edge
  EXPECT_EQ(with_base({4, 0, 0}, {0, 4, 0}, {9, 9, 0}), Contact::touching);    // edges along each other
  EXPECT_EQ(with_base({1, -1, 0}, {2, -1, 0}, {1, 0, 0}), Contact::touching);  // in its plane, corner on edge
}

TEST(TriangleContact, IsCrossingWhereInsidesOverlapInAPlane) {
  EXPECT_EQ(with_base({1, 1, 0}, {2, 1, 0}, {1, 2, 0}), Contact::crossing);
  EXPECT_EQ(with_base({-1, 1, 0}, {9, 1, 0}, {9, 2, 0}), Contact::crossing);  // no corner of one in the other
  EXPECT_EQ(with_base({0, 0, 0}, {4, 0, 0}, {0, 4, 0}), Contact::crossing);
}

TEST(TriangleContact, LeavesOutWhatIsShared) {
  EXPECT_EQ(with_base({0, 0, 0}, {-1, 0, 1}, {-1, 1, 1}, {0, 11, 12}), Contact::none);
  EXPECT_EQ(with_base({4, 0, 0}, {0, 4, 0}, {9, 9, 0}, {1, 2, 12}), Contact::none);
  EXPECT_EQ(with_base({4, 0, 0}, {0, 4, 0}, {0, 0, 9}, {1, 2, 12}), Contact::none);
}

TEST(TriangleContact, SeesMoreThanWhatIsShared) {
  EXPECT_EQ(with_base({0, 0, 0}, {1, 1, 1}, {1, 1, -1}, {0, 11, 12}), Contact::crossing);
  EXPECT_EQ(with_base({0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {0, 11, 12}), Contact::touching);
  EXPECT_EQ(with_base({4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 2, 12}), Contact::crossing);  // folded flat
  EXPECT_EQ(with_base({4, 0, 0}, {0, 4, 0}, {-1, -1, 0}, {1, 2, 12}), Contact::crossing);
  EXPECT_EQ(with_base({0, 4, 0}, {4, 0, 0}, {0, 0, 0}, {2, 1, 0}), Contact::crossing);  // the same, turned over
}

TEST(TriangleContact, TakesTrianglesWithoutAreaForSegmentsAndPoints) {
  EXPECT_EQ(with_base({1, 1, -1}, {1, 1, 0.5F}, {1, 1, 2}), Contact::touching);
  EXPECT_EQ(with_base({1, 1, 1}, {1, 1, 2}, {1, 1, 3}), Contact::none);
  EXPECT_EQ(with_base({1, 1, 0}, {1, 1, 0}, {1, 1, 0}), Contact::touching);
  EXPECT_EQ(with_base({0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {0, 1, 12}), Contact::none);       // within the shared edge
  EXPECT_EQ(with_base({0, 0, 0}, {4, 0, 0}, {9, 0, 0}, {0, 1, 12}), Contact::none);       // goes on beyond it
  EXPECT_EQ(with_base({0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 11, 12}), Contact::touching);  // along the face
  const MeshTriangle segment = triangle({0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {0, 1, 2});
  EXPECT_EQ(contact_of(segment, triangle({0, 0, 0}, {1, 0, 0}, {4, 0, 0}, {0, 1, 3})), Contact::touching);
  EXPECT_EQ(contact_of(segment, triangle({0, 0, 0}, {1, 0, 0}, {-4, 0, 0}, {0, 1, 3})), Contact::none);
  EXPECT_EQ(contact_of(segment, triangle({5, 0, 0}, {6, 0, 0}, {7, 0, 0}, {3, 4, 5})), Contact::touching);
}

/// Two triangles with corners out of a few places of a small grid: every kind of contact and of degeneracy is common.
std::pair<WholeTriangle, WholeTriangle> random_pair(Random& random) {
  const std::int64_t width = 1 + random.below(6), places = 3 + random.below(4);
  std::array<test::WholePoint, 7> place{};
  for (auto& p : place)
    for (int& x : p) x = static_cast<int>(random.below(width + 1));
  const auto pick = [&] {
    WholeTriangle t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const bool may_repeat = random.below(8) == 0;
      do t.ids[k] = static_cast<std::int32_t>(random.below(places));
      while (!may_repeat && ((k > 0 && t.ids[k] == t.ids[0]) || (k > 1 && t.ids[k] == t.ids[1])));
      t.corners[k] = place[static_cast<std::size_t>(t.ids[k])];
    }
    return t;
  };
  WholeTriangle first = pick();
  return {first, pick()};
}

/// Moved and scaled so that every coordinate is a float still, and determinants no longer fit into a double.
class Placement {
 public:
  explicit Placement(Random& random) : scale_(std::ldexp(1.0F, static_cast<int>(random.below(3)) * -70)) {
    const std::int64_t range = scale_ == 1 ? std::int64_t{1} << 23 : 1;
    for (float& x : offset_) x = scale_ * static_cast<float>(random.below(2 * range) - range);
  }
  [[nodiscard]] MeshTriangle operator()(const WholeTriangle& t) const {
    MeshTriangle placed{{}, t.ids};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = [&](std::size_t i) { return offset_[i] + scale_ * static_cast<float>(t.corners[k][i]); };
      placed.corners[k] = {at(0), at(1), at(2)};
    }
    return placed;
  }

 private:
  float scale_;
  std::array<float, 3> offset_{};
};

MeshTriangle turned(const MeshTriangle& t, std::size_t by, bool over) {
  const auto k = [&](std::size_t i) { return (over ? 2 - i + by : i + by) % 3; };
  return {{t.corners[k(0)], t.corners[k(1)], t.corners[k(2)]}, {t.ids[k(0)], t.ids[k(1)], t.ids[k(2)]}};
}

TEST(TriangleContact, IsThatOfWholeNumbersForEveryKindOfPair) {
  std::array<std::array<int, 3>, 4> seen{};  // by number of shared corners and contact
  for (std::uint64_t seed = 1; seed <= 30'000; ++seed) {
    Random random(seed);
    const auto [s, t] = random_pair(random);
    const ExactContact exact(s, t);
    const Contact expected = exact.contact();
    const Placement place(random);
    const MeshTriangle a = turned(place(s), static_cast<std::size_t>(random.below(3)), random.below(2) == 0);
    const MeshTriangle b = turned(place(t), static_cast<std::size_t>(random.below(3)), random.below(2) == 0);
    ASSERT_EQ(contact_of(a, b), expected) << "seed " << seed;
    ASSERT_EQ(contact_of(b, a), expected) << "seed " << seed;
    ++seen[exact.shared_places().size()][static_cast<std::size_t>(expected)];
  }
  for (const std::size_t shared : {0U, 1U, 2U})
    for (const int count : seen[shared]) EXPECT_GT(count, 20) << shared;
  EXPECT_GT(seen[3][1], 20);  // the same three corners, on a line
  EXPECT_GT(seen[3][2], 20);
}

TEST(TriangleContact, HasItsPlaceInBothTriangles) {
  int checked = 0;
  for (std::uint64_t seed = 1; seed <= 3'000; ++seed) {
    Random random(seed);
    const auto [s, t] = random_pair(random);
    const ExactContact exact(s, t);
    if (exact.contact() == Contact::none) continue;
    const auto as_floats = [](const WholeTriangle& w) {
      MeshTriangle m{{}, w.ids};
      for (std::size_t k = 0; k < 3; ++k)
        m.corners[k] = {static_cast<float>(w.corners[k][0]), static_cast<float>(w.corners[k][1]),
                        static_cast<float>(w.corners[k][2])};
      return m;
    };
    const MeshTriangle a = as_floats(s), b = as_floats(t);
    const Vec3d place = place_of_contact(a, b);
    for (const MeshTriangle& m : {a, b}) {
      using namespace mesh_detail;
      const EdgedTriangle edged{to_double(m.corners[0]), to_double(m.corners[1]) - to_double(m.corners[0]),
                                to_double(m.corners[2]) - to_double(m.corners[0])};
      ASSERT_LT(squared_distance(place, edged), 1e-24) << "seed " << seed;
    }
    ++checked;
  }
  EXPECT_GT(checked, 500);
}

}  // namespace
}  // namespace pointskin
