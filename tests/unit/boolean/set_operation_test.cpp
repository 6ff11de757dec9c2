// Which points a set operation keeps, against what membership on both sides of them says; parts of the crease.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "boolean/crease_kernels.hpp"
#include "boolean/keep_apart.hpp"
#include "boolean/set_operation.hpp"
#include "support/shapes.hpp"
#include "support/spaces.hpp"

namespace pointskin::boolean {
namespace {

constexpr BooleanOp kOps[] = {BooleanOp::unite, BooleanOp::intersect, BooleanOp::subtract,
                              BooleanOp::symmetric_difference};

/// The definition of the operation.
bool belongs(BooleanOp op, bool in_a, bool in_b) {
  switch (op) {
    case BooleanOp::unite:
      return in_a || in_b;
    case BooleanOp::intersect:
      return in_a && in_b;
    case BooleanOp::subtract:
      return in_a && !in_b;
    case BooleanOp::symmetric_difference:
      break;
  }
  return in_a != in_b;
}

/// What a piece of surface becomes, from what lies on either side of it.
Fate expected_fate(BooleanOp op, bool is_first, Place place) {
  const bool other_inward = place == Place::inside || place == Place::agrees;
  const bool other_outward = place == Place::inside || place == Place::opposes;
  const bool inward = is_first ? belongs(op, true, other_inward) : belongs(op, other_inward, true);
  const bool outward = is_first ? belongs(op, false, other_outward) : belongs(op, other_outward, false);
  if (inward == outward) return Fate::dropped;
  return inward ? Fate::kept : Fate::flipped;
}

TEST(FateOf, IsWhatMembershipOnBothSidesSays) {
  for (const BooleanOp op : kOps)
    for (const Place place : {Place::outside, Place::inside})
      for (const bool is_first : {true, false})
        EXPECT_EQ(fate_of(op, is_first, place), expected_fate(op, is_first, place))
            << static_cast<int>(op) << ' ' << static_cast<int>(place) << ' ' << is_first;
}

TEST(FateOf, KeepsCoincidentSurfacesOnceAndFromTheFirst) {
  for (const BooleanOp op : kOps)
    for (const Place place : {Place::agrees, Place::opposes}) {
      EXPECT_EQ(fate_of(op, true, place), expected_fate(op, true, place))
          << static_cast<int>(op) << ' ' << static_cast<int>(place);
      EXPECT_EQ(fate_of(op, false, place), Fate::dropped) << static_cast<int>(op) << ' ' << static_cast<int>(place);
    }
}

field::SurfaceDistance at(float cells, Vec3f normal) { return {cells, normal, 0.25F}; }

TEST(PlaceOf, IsTheSideUnlessSurfacesRunAlikeWithinTheTolerance) {
  const Vec3f up{0, 0, 1};
  const Vec3f down{0, 0, -1};
  const Vec3f aside{1, 0, 0};
  EXPECT_EQ(place_of(at(0, up), at(0.4F, up), 0.5F), Place::agrees);
  EXPECT_EQ(place_of(at(0, up), at(-0.4F, up), 0.5F), Place::agrees);
  EXPECT_EQ(place_of(at(0, up), at(0.4F, down), 0.5F), Place::opposes);
  EXPECT_EQ(place_of(at(0, up), at(0.6F, up), 0.5F), Place::outside);
  EXPECT_EQ(place_of(at(0, up), at(-0.6F, up), 0.5F), Place::inside);
  EXPECT_EQ(place_of(at(0, up), at(0.1F, aside), 0.5F), Place::outside);
  EXPECT_EQ(place_of(at(0, up), at(-0.1F, aside), 0.5F), Place::inside);
  // A point that scatters two cells off its own surface may be as far off the other one.
  EXPECT_EQ(place_of(at(2, up), at(2.4F, up), 0.5F), Place::agrees);
  EXPECT_EQ(place_of(at(-2, up), at(2.6F, up), 0.5F), Place::outside);
  // Where the field is flat there is no surface to coincide with.
  EXPECT_EQ(place_of(at(0, up), at(field::kFarCells, {}), 0.5F), Place::outside);
}

TEST(LoweredBy, IsMostAtTheCurveAndNothingFarFromItOrAlongEachOther) {
  const Vec3f up{0, 0, 1};
  const Vec3f aside{1, 0, 0};
  EXPECT_EQ(lowered_by(at(0, up), at(0, aside)), kApart);
  EXPECT_FLOAT_EQ(lowered_by(at(-kApartEnd / 2, up), at(0.1F, aside)), kApart / 2);
  EXPECT_FLOAT_EQ(lowered_by(at(0.1F, up), at(kApartEnd / 2, aside)), kApart / 2);
  EXPECT_EQ(lowered_by(at(kApartEnd, up), at(0, aside)), 0);
  EXPECT_EQ(lowered_by(at(0, up), at(-100, aside)), 0);
  EXPECT_EQ(lowered_by(at(0, up), at(0, up)), 0);
  EXPECT_EQ(lowered_by(at(0, up), at(0, {0, 0, -1})), 0);
}

TEST(KeptSheets, AreTwoOfFourButForTheSymmetricDifferenceAll) {
  for (const BooleanOp op : kOps) {
    const std::vector<Sheet> sheets = kept_sheets(op);
    EXPECT_EQ(sheets.size(), op == BooleanOp::symmetric_difference ? 4 : 2);
    for (const Sheet& sheet : sheets)
      EXPECT_EQ(sheet.flipped,
                expected_fate(op, sheet.of_first, sheet.outside ? Place::outside : Place::inside) == Fate::flipped);
  }
}

TEST(TangentLength, IsThatOfALineInACube) {
  exec::Cpu ex(1);
  const std::vector<Vec3f> middle{{0.5F, 0.5F, 0.5F}};
  const std::vector<float> width{1};
  const float cell = 0x1p-6F;
  const auto length = [&](const Vec3f& through, const Vec3f& a, const Vec3f& b) {
    const std::vector<Vec3f> point{through};
    const std::vector<field::SurfaceDistance> to_a{at(0, a)};
    const std::vector<field::SurfaceDistance> to_b{at(0, b)};
    const Found found{{point.data(), 1}, {middle.data(), 1}, {width.data(), 1},
                      {to_a.data(), 1},  {to_b.data(), 1},   cell};
    return TangentLength{found}(0);
  };
  const float root = std::sqrt(0.5F);
  EXPECT_FLOAT_EQ(length({0.5F, 0.5F, 0.5F}, {1, 0, 0}, {0, 1, 0}), 1);
  EXPECT_FLOAT_EQ(length({0.5F + 0.25F * cell, 0.5F, 0.5F}, {1, 0, 0}, {0, 1, 0}), 1);
  EXPECT_EQ(length({0.5F + 0.75F * cell, 0.5F, 0.5F}, {1, 0, 0}, {0, 1, 0}), 0);
  EXPECT_NEAR(length({0.5F, 0.5F, 0.5F}, {root, -root, 0}, {0, 0, 1}), std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(length({0.5F + 0.25F * cell, 0.5F - 0.25F * cell, 0.5F}, {root, root, 0}, {0, 0, 1}), std::sqrt(2.0),
              1e-6);
  EXPECT_NEAR(length({0.5F + 0.25F * cell, 0.5F, 0.5F}, {root, -root, 0}, {0, 0, 1}), 0.75 * std::sqrt(2.0), 1e-6);
}

}  // namespace
}  // namespace pointskin::boolean
